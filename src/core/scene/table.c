/* Reading tables from a scene. */
#include "table.h"

#include "base/snapshot_file.h"
#include "base/text.h"
#include "file_ref.h"
#include "params.h"
#include "table_file.h"

#include <limits.h>

enum { WHAT = 256 };

/* ---- memory ---------------------------------------------------------------------------------- */

double *table_allocate(pdyn_context *context, const pdyn_param *param, int rows, pdyn_table *out) {
    double *value = NEW_ARRAY(context, (size_t)rows * (size_t)param_width(param), double);
    if (value) *out = (pdyn_table){rows, value};
    return value;
}

void table_free(pdyn_context *context, const pdyn_param *param, pdyn_table *table) {
    FREE_ARRAY(context, table->value, (size_t)table->count * (size_t)param_width(param));
    table->count = 0;
}

uint64_t table_hash(uint64_t hash, const pdyn_param *params, const void *values) {
    for (const pdyn_param *p = params; p->name; p++) {
        const pdyn_table *table = (const pdyn_table *)((const char *)values + p->offset);
        if (!param_is_table(p)) continue;
        size_t numbers = (size_t)table->count * (size_t)param_width(p);
        hash = hash_bytes(hash, table->value, numbers * sizeof *table->value);
    }
    return hash;
}

/* ---- words ----------------------------------------------------------------------------------- */

const char *table_part(const pdyn_param *param) {
    static const char *const parts[] = {NULL, "vertex", "triangle", "tetrahedron"};
    return parts[param_rows(param, 1, 2, 3)];
}

void table_describe(char *text, size_t size, const pdyn_param *param, int rows, const char *lines) {
    int width = param_width(param);
    if (rows) text_append(text, size, "%d ", rows);
    if (lines || width > 1) text_append(text, size, "%s of %d ", lines ? lines : "rows", width);
    text_append(text, size, "number%s", lines && width == 1 ? "" : "s");
    if (rows) text_append(text, size, ", one per %s", table_part(param));
}

/* ---- numbers --------------------------------------------------------------------------------- */

bool table_allows(const pdyn_param *param, const double *row, int column, double value,
                  int vertices) {
    if (column >= param_vertices(param))
        return isfinite(value) && value >= param->min && value <= param->max;
    for (int k = 0; k < column; k++)
        if (row[k] == value) return false;
    return value >= 0.0 && value < vertices && value == floor(value);
}

void table_describe_number(char *text, size_t size, const pdyn_param *param, int column,
                           int vertices) {
    if (column >= param_vertices(param))
        params_describe_bounds(text, size, "a number", param->min, param->max, param->unit);
    else
        text_append(text, size, "a vertex from 0 to %d%s", vertices - 1,
                    column ? ", another one than before it in the row" : "");
}

/* ---- reading --------------------------------------------------------------------------------- */

static pdyn_status expected_table(const struct json_at *at, const pdyn_param *param, int rows) {
    char text[WHAT] = "an array of ";
    int width = param_width(param);
    table_describe(text, sizeof text, param, rows, NULL);
    if (rows && width == 1) text_append(text, sizeof text, ", or one number for all");
    else if (rows) text_append(text, sizeof text, ", or one array of %d numbers for all", width);
    return json_expected(at, text);
}

/* The numbers of a row that begins with vertices. */
static pdyn_status read_vertices(const struct json_at *at, const pdyn_param *param, int vertices,
                                 double *row) {
    int width = param_width(param);
    pdyn_status status = width == 1 ? params_real(at, -HUGE_VAL, HUGE_VAL, "", row)
                                    : params_reals(at, width, -HUGE_VAL, HUGE_VAL, "", row);
    for (int k = 0; k < width && status == PDYN_OK; k++) {
        struct json_at number = width == 1 ? *at : json_element(at, (size_t)k);
        char expected[WHAT] = "";
        if (table_allows(param, row, k, row[k], vertices)) continue;
        table_describe_number(expected, sizeof expected, param, k, vertices);
        status = json_expected(&number, expected);
    }
    return status;
}

/* A missing row has the default. */
static pdyn_status read_row(const struct json_at *at, const pdyn_param *param, int vertices,
                            double *row) {
    int width = param_width(param);
    for (int k = 0; !at->value && k < width; k++) row[k] = param->def;
    if (!at->value) return PDYN_OK;
    if (param_vertices(param)) return read_vertices(at, param, vertices, row);
    return width == 1 ? params_real(at, param->min, param->max, param->unit, row)
                      : params_reals(at, width, param->min, param->max, param->unit, row);
}

/* Whether the value is one row, which all parts of the body get, and not an array of rows. */
static bool is_row(const json_t *value, int width) {
    if (width == 1) return json_is_number(value);
    return json_array_size(value) && !json_is_array(json_array_get(value, 0));
}

/* Allocates the rows; they must be as many numbers as an int counts. */
static pdyn_status allocate(const struct json_at *at, const pdyn_param *param, size_t rows,
                            pdyn_table *out) {
    if (rows > (size_t)(INT_MAX / param_width(param)))
        return json_fail(at, "more than %d numbers", INT_MAX);
    return table_allocate(at->file->context, param, (int)rows, out) ? PDYN_OK : PDYN_NO_MEMORY;
}

/* Reads one row for all parts of the body. */
static pdyn_status read_one(const struct json_at *at, const pdyn_param *param, int rows,
                            int vertices, pdyn_table *out) {
    size_t width = (size_t)param_width(param);
    pdyn_status status = allocate(at, param, rows ? (size_t)rows : 1, out);
    if (status != PDYN_OK) return status;
    double *value = (double *)out->value;
    status = read_row(at, param, vertices, value);
    for (size_t k = width; k < (size_t)out->count * width; k++) value[k] = value[k - width];
    return status;
}

static pdyn_status read_rows(const struct json_at *at, const pdyn_param *param, int rows,
                             int vertices, pdyn_table *out) {
    size_t count = json_array_size(at->value), width = (size_t)param_width(param);
    if (!count || (rows && count != (size_t)rows)) return expected_table(at, param, rows);
    pdyn_status status = allocate(at, param, count, out);
    for (size_t k = 0; k < count && status == PDYN_OK; k++) {
        struct json_at row = json_element(at, k);
        status = read_row(&row, param, vertices, (double *)out->value + k * width);
    }
    return status;
}

static pdyn_status read_file(const struct json_at *at, const pdyn_param *param, int rows,
                             int vertices, pdyn_table *out) {
    char *path = NULL;
    pdyn_context *context = at->file->context;
    pdyn_status status = file_ref_path(at, "the name of a file", &path);
    if (status == PDYN_OK)
        status = json_wrap(at, table_file_read(context, path, param, rows, vertices, out));
    context_free_text(context, path);
    return status;
}

pdyn_status table_read(const struct json_at *at, const pdyn_param *param,
                       const struct scene_body *body, pdyn_table *out) {
    int vertices = body->mesh.vertices;
    int rows = param_rows(param, body->mesh.vertices, body->mesh.triangles, body->tets.count);
    if (!at->value && !param->required)
        return param_has_default(param) ? read_one(at, param, rows, vertices, out) : PDYN_OK;
    if (json_is_string(at->value)) return read_file(at, param, rows, vertices, out);
    return is_row(at->value, param_width(param)) ? read_one(at, param, rows, vertices, out)
                                                 : read_rows(at, param, rows, vertices, out);
}
