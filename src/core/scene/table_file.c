/* Reading tables from text files, in two passes: rows are counted, then read. */
#include "table_file.h"

#include "base/file_in.h"
#include "base/text.h"
#include "geometry/mesh_file.h"
#include "table.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WHAT = 128, WORD = 40 };

/* ---- lines ----------------------------------------------------------------------------------- */

/* Skips blanks and commas. Returns whether a number should follow in this line. */
static bool find_word(struct mesh_file *file) {
    file->at += strspn(file->at, " \t\r,");
    return !mesh_file_at_end(file) && *file->at != '\n' && *file->at != '#';
}

/* Goes to the next line that has a word; false: there is none. */
static bool find_row(struct mesh_file *file) {
    while (!find_word(file) && !mesh_file_at_end(file)) mesh_file_next_line(file);
    return !mesh_file_at_end(file);
}

static size_t count_rows(struct mesh_file *file) {
    size_t rows = 0;
    for (file->at = file->data; find_row(file); mesh_file_next_line(file)) rows++;
    file->at = file->data, file->line = 1;
    return rows;
}

/* ---- numbers --------------------------------------------------------------------------------- */

static pdyn_status fail_row(const struct mesh_file *file, int width, int found) {
    return mesh_file_fail(file, "expected %d number%s, found %s%d", width, width == 1 ? "" : "s",
                          found > width ? "more than " : "", found > width ? width : found);
}

static pdyn_status fail_number(const struct mesh_file *file, const pdyn_param *p, int column,
                               int vertices) {
    char expected[WHAT] = "", word[WORD], found[WORD];
    table_describe_number(p, column, vertices, expected, sizeof expected);
    snprintf(word, sizeof word, "%.*s", (int)strcspn(file->at, " \t\r\n,#"), file->at);
    text_clip(found, sizeof found, word);
    return context_fail(file->context, PDYN_BAD_INPUT, "%.1024s:%ld: expected %s, found \"%s\"",
                        file->path, file->line, expected, found);
}

static pdyn_status read_row(struct mesh_file *file, const pdyn_param *param, int vertices,
                            double *row) {
    int width = param_width(param), count = 0;
    for (; find_word(file); count++) {
        char *end;
        double value = strtod(file->at, &end);
        if (count == width) return fail_row(file, width, width + 1);
        if (end == file->at || !strchr(" \t\r\n,#", *end) ||
            !table_allows(param, row, count, value, vertices))
            return fail_number(file, param, count, vertices);
        row[count] = value, file->at = end;
    }
    return count == width ? PDYN_OK : fail_row(file, width, count);
}

/* ---- files ----------------------------------------------------------------------------------- */

static pdyn_status check_count(const struct mesh_file *file, const pdyn_param *param, size_t found,
                               int rows) {
    char expected[WHAT] = "";
    if (found && (!rows || found == (size_t)rows)) {
        if (found <= (size_t)(INT_MAX / param_width(param))) return PDYN_OK;
        return context_fail(file->context, PDYN_BAD_INPUT, "%.1024s: more than %d numbers",
                            file->path, INT_MAX);
    }
    table_describe(param, rows, "lines", expected, sizeof expected);
    return context_fail(file->context, PDYN_BAD_INPUT, "%.1024s: expected %s, found %zu",
                        file->path, expected, found);
}

static pdyn_status read_rows(struct mesh_file *file, const pdyn_param *param, int rows,
                             int vertices, pdyn_table *out) {
    size_t found = count_rows(file), width = (size_t)param_width(param);
    pdyn_status status = check_count(file, param, found, rows);
    if (status != PDYN_OK) return status;
    double *value = table_allocate(file->context, param, (int)found, out);
    if (!value) return PDYN_NO_MEMORY;
    for (; status == PDYN_OK && find_row(file); value += width)
        status = read_row(file, param, vertices, value);
    return status;
}

pdyn_status table_file_read(pdyn_context *context, const char *path, const pdyn_param *param,
                            int rows, int vertices, pdyn_table *out) {
    struct mesh_file file = {.context = context, .path = path, .line = 1};
    pdyn_status status = file_load(context, path, &file.data, &file.size);
    if (status == PDYN_OK) status = read_rows(&file, param, rows, vertices, out);
    mesh_file_release(&file);
    return status;
}
