/* Legacy VTK, text or big-endian bytes: reads the points of POLYDATA or UNSTRUCTURED_GRID and their
 * vectors named "velocity"; skips cells, other data and METADATA. */
#include "mesh_file.h"

#include <math.h>

/* ---- numbers --------------------------------------------------------------------------------- */

struct type {
    const char *name;
    size_t size;
    double (*decode)(uint64_t bits); /* NULL: not accepted for coordinates */
};
static const struct type types[] = {
    {"float", 4, scan_float},   {"double", 8, scan_double}, {"char", 1, NULL},
    {"unsigned_char", 1, NULL}, {"short", 2, NULL},         {"unsigned_short", 2, NULL},
    {"int", 4, NULL},           {"unsigned_int", 4, NULL},  {"vtkIdType", 4, NULL},
    {"long", 8, NULL},          {"unsigned_long", 8, NULL}, {"vtktypeint64", 8, NULL},
};
static const struct type *const vtk_int = &types[6];

static pdyn_status read_text(struct mesh_file *file, double *value) {
    scan_skip_blank(&file->in);
    struct word word = scan_word(&file->in);
    return word_number(word, value) ? PDYN_OK : scan_expected(&file->in, "a number", word);
}

static pdyn_status read_bytes(struct mesh_file *file, const struct type *type, double *value) {
    file->in.last = file->in.at;
    if ((size_t)(file->in.data + file->in.size - file->in.at) < type->size)
        return scan_expected(&file->in, type->name, (struct word){0});
    *value = type->decode ? type->decode(scan_bits(file->in.at, type->size, true)) : 0.0;
    file->in.at += type->size;
    return PDYN_OK;
}

static pdyn_status read_number(struct mesh_file *file, const struct type *type, double *value) {
    return file->in.binary ? read_bytes(file, type, value) : read_text(file, value);
}

/* Names and ranges of the numbers before, up to an empty line. */
static void skip_metadata(struct mesh_file *file) {
    scan_skip_blank(&file->in);
    struct word word = scan_word(&file->in);
    bool found = word_is(word, "METADATA");
    if (!found) file->in.at = word.text;
    while (found && word.length) {
        scan_next_line(&file->in);
        word = scan_word(&file->in);
    }
}

/* Reads `count` numbers from the next line on and calls `add` for every three; NULL: skips them. */
typedef pdyn_status add_fn(struct mesh_file *file, const double x[3]);
static pdyn_status read_values(struct mesh_file *file, const struct type *type, int64_t count,
                               add_fn *add) {
    double value[3];
    pdyn_status status = PDYN_OK;
    scan_next_line(&file->in);
    for (int64_t k = 0; k < count && status == PDYN_OK; k++) {
        status = read_number(file, type, &value[k % 3]);
        if (status == PDYN_OK && add && k % 3 == 2) status = add(file, value);
    }
    if (status == PDYN_OK) skip_metadata(file);
    return status;
}

/* ---- words of a section's first line --------------------------------------------------------- */

struct vtk {
    struct mesh_file *file;
    double version;
    int64_t tuples; /* number of tuples of the current data section */
    bool on_points; /* the current data section belongs to the points */
};

static pdyn_status read_count(struct mesh_file *file, const char *what, int64_t *out) {
    double value;
    struct word word = scan_word(&file->in);
    if (!word_number(word, &value) || !(value >= 0.0 && value <= 1e9) || value != floor(value))
        return scan_expected(&file->in, what, word);
    *out = (int64_t)value;
    return PDYN_OK;
}

static pdyn_status read_type(struct mesh_file *file, const struct type **out) {
    struct word word = scan_word(&file->in);
    for (size_t k = 0; k < sizeof types / sizeof *types; k++)
        if (word_is(word, types[k].name)) return *out = &types[k], PDYN_OK;
    return scan_expected(&file->in, "a type such as float or int", word);
}

static pdyn_status read_real_type(struct mesh_file *file, const struct type **out) {
    pdyn_status status = read_type(file, out);
    if (status != PDYN_OK || (*out)->decode) return status;
    return scan_fail(&file->in, "expected float or double, found %s", (*out)->name);
}

/* ---- sections -------------------------------------------------------------------------------- */

static pdyn_status read_dataset(struct vtk *vtk) {
    struct word word = scan_word(&vtk->file->in);
    if (word_is(word, "POLYDATA") || word_is(word, "UNSTRUCTURED_GRID")) return PDYN_OK;
    return scan_expected(&vtk->file->in, "POLYDATA or UNSTRUCTURED_GRID", word);
}

static pdyn_status read_points(struct vtk *vtk) {
    int64_t count = 0;
    const struct type *type = NULL;
    if (vtk->file->vertices) return scan_fail(&vtk->file->in, "POINTS are given twice");
    pdyn_status status = read_count(vtk->file, "a number of points", &count);
    if (status == PDYN_OK) status = read_real_type(vtk->file, &type);
    return status == PDYN_OK ? read_values(vtk->file, type, 3 * count, mesh_file_vertex) : status;
}

static pdyn_status skip_part_of_cells(struct vtk *vtk, const char *name, int64_t count) {
    const struct type *type = NULL;
    scan_skip_blank(&vtk->file->in);
    struct word word = scan_word(&vtk->file->in);
    if (!word_is(word, name)) return scan_expected(&vtk->file->in, name, word);
    pdyn_status status = read_type(vtk->file, &type);
    return status == PDYN_OK ? read_values(vtk->file, type, count, NULL) : status;
}

/* Up to version 4: corners, each cell with their number. From 5 on: where each cell begins, and
 * corners. */
static pdyn_status skip_cells(struct vtk *vtk) {
    int64_t cells = 0, count = 0;
    pdyn_status status = read_count(vtk->file, "a number of cells", &cells);
    if (status == PDYN_OK) status = read_count(vtk->file, "a number of integers", &count);
    if (status != PDYN_OK) return status;
    if (vtk->version < 5.0) return read_values(vtk->file, vtk_int, count, NULL);
    status = skip_part_of_cells(vtk, "OFFSETS", cells);
    return status == PDYN_OK ? skip_part_of_cells(vtk, "CONNECTIVITY", count) : status;
}

static pdyn_status skip_cell_types(struct vtk *vtk) {
    int64_t count = 0;
    pdyn_status status = read_count(vtk->file, "a number of cells", &count);
    return status == PDYN_OK ? read_values(vtk->file, vtk_int, count, NULL) : status;
}

static pdyn_status begin_point_data(struct vtk *vtk) {
    vtk->on_points = true;
    pdyn_status status = read_count(vtk->file, "a number of points", &vtk->tuples);
    if (status != PDYN_OK || vtk->tuples == vtk->file->vertices) return status;
    return scan_fail(&vtk->file->in, "expected data of the %d points above", vtk->file->vertices);
}

static pdyn_status begin_cell_data(struct vtk *vtk) {
    vtk->on_points = false;
    return read_count(vtk->file, "a number of cells", &vtk->tuples);
}

static pdyn_status skip_scalars(struct vtk *vtk) {
    int64_t parts = 1;
    const struct type *type = NULL;
    scan_word(&vtk->file->in); /* the name of the scalars */
    pdyn_status status = read_type(vtk->file, &type);
    const char *after = vtk->file->in.at;
    bool last = !scan_word(&vtk->file->in).length;
    vtk->file->in.at = after;
    if (status == PDYN_OK && !last)
        status = read_count(vtk->file, "a number of components", &parts);
    if (status != PDYN_OK) return status;
    scan_next_line(&vtk->file->in);
    struct word word = scan_word(&vtk->file->in);
    if (!word_is(word, "LOOKUP_TABLE")) return scan_expected(&vtk->file->in, "LOOKUP_TABLE", word);
    return read_values(vtk->file, type, parts * vtk->tuples, NULL);
}

/* Reads an array if it holds the velocities, otherwise skips it. */
static pdyn_status read_array(struct vtk *vtk, struct word name, const struct type *type,
                              int64_t numbers) {
    bool wanted = vtk->on_points && word_is(name, "velocity") && numbers == 3 * vtk->tuples;
    if (!wanted) return read_values(vtk->file, type, numbers, NULL);
    if (!type->decode)
        return scan_fail(&vtk->file->in, "expected velocities of float or double, found %s",
                         type->name);
    if (vtk->file->velocities) return scan_fail(&vtk->file->in, "velocities are given twice");
    return read_values(vtk->file, type, numbers, mesh_file_velocity);
}

static pdyn_status read_vectors(struct vtk *vtk) {
    const struct type *type = NULL;
    struct word name = scan_word(&vtk->file->in);
    pdyn_status status = read_type(vtk->file, &type);
    return status == PDYN_OK ? read_array(vtk, name, type, 3 * vtk->tuples) : status;
}

static pdyn_status read_field(struct vtk *vtk) {
    int64_t arrays = 0, parts = 0, tuples = 0;
    scan_word(&vtk->file->in); /* the name of the field */
    pdyn_status status = read_count(vtk->file, "a number of arrays", &arrays);
    for (int64_t k = 0; k < arrays && status == PDYN_OK; k++) {
        const struct type *type = NULL;
        scan_skip_blank(&vtk->file->in);
        struct word name = scan_word(&vtk->file->in);
        status = read_count(vtk->file, "a number of components", &parts);
        if (status == PDYN_OK) status = read_count(vtk->file, "a number of tuples", &tuples);
        if (status == PDYN_OK) status = read_type(vtk->file, &type);
        if (status == PDYN_OK) status = read_array(vtk, name, type, parts * tuples);
    }
    return status;
}

static pdyn_status read_section(struct vtk *vtk) {
    static const struct {
        const char *name;
        pdyn_status (*read)(struct vtk *vtk);
    } sections[] = {
        {"DATASET", read_dataset},
        {"POINTS", read_points},
        {"VERTICES", skip_cells},
        {"LINES", skip_cells},
        {"POLYGONS", skip_cells},
        {"TRIANGLE_STRIPS", skip_cells},
        {"CELLS", skip_cells},
        {"CELL_TYPES", skip_cell_types},
        {"POINT_DATA", begin_point_data},
        {"CELL_DATA", begin_cell_data},
        {"SCALARS", skip_scalars},
        {"VECTORS", read_vectors},
        {"NORMALS", read_vectors},
        {"FIELD", read_field},
    };
    struct word word = scan_word(&vtk->file->in);
    for (size_t k = 0; k < sizeof sections / sizeof *sections; k++)
        if (word_is(word, sections[k].name)) return sections[k].read(vtk);
    return scan_expected(&vtk->file->in, "POINTS, CELLS, POINT_DATA, VECTORS or another section",
                         word);
}

/* Reads the header: version, title, ASCII or BINARY. */
static pdyn_status read_header(struct vtk *vtk) {
    static const char *const magic[] = {"#", "vtk", "DataFile", "Version"};
    struct mesh_file *file = vtk->file;
    struct word word;
    for (int k = 0; k < 4; k++) {
        word = scan_word(&file->in);
        if (!word_is(word, magic[k]))
            return scan_expected(&file->in, "'# vtk DataFile Version'", word);
    }
    word = scan_word(&file->in);
    if (!word_number(word, &vtk->version) || !(vtk->version < 6.0))
        return scan_expected(&file->in, "a version before 6", word);
    scan_next_line(&file->in);
    scan_next_line(&file->in);
    word = scan_word(&file->in);
    file->in.binary = word_is(word, "BINARY");
    if (!file->in.binary && !word_is(word, "ASCII"))
        return scan_expected(&file->in, "ASCII or BINARY", word);
    return PDYN_OK;
}

pdyn_status mesh_vtk_parse(struct mesh_file *file) {
    struct vtk vtk = {.file = file};
    pdyn_status status = read_header(&vtk);
    scan_skip_blank(&file->in);
    while (status == PDYN_OK && !scan_at_end(&file->in)) {
        status = read_section(&vtk);
        scan_skip_blank(&file->in);
    }
    return status;
}
