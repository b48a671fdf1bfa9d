/* Reading tables from text files, in two passes: rows are counted, then read. */
#include "table_file.h"

#include "base/file_in.h"
#include "base/scan.h"
#include "base/text.h"
#include "table.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLANKS " \t\r\v\f,"
#define ENDS   BLANKS "\n#" /* of a word */

enum { WHAT = 128, WORD = 40 };

/* ---- lines ----------------------------------------------------------------------------------- */

/* Skips blanks and commas. Returns whether a number should follow in this line. */
static bool find_word(struct scan *scan) {
    scan->at += strspn(scan->at, BLANKS);
    return !scan_at_end(scan) && *scan->at != '\n' && *scan->at != '#';
}

/* Goes to the next line that has a word; false: there is none. */
static bool find_row(struct scan *scan) {
    while (!find_word(scan) && !scan_at_end(scan)) scan_next_line(scan);
    return !scan_at_end(scan);
}

static size_t count_rows(struct scan *scan) {
    size_t rows = 0;
    for (scan->at = scan->data; find_row(scan); scan_next_line(scan)) rows++;
    scan->at = scan->data, scan->line = 1;
    return rows;
}

/* ---- numbers --------------------------------------------------------------------------------- */

static pdyn_status fail_row(const struct scan *scan, int width, int found) {
    return scan_fail(scan, "expected %d number%s, found %s%d", width, width == 1 ? "" : "s",
                     found > width ? "more than " : "", found > width ? width : found);
}

static pdyn_status fail_number(const struct scan *scan, const pdyn_param *p, int column,
                               int vertices) {
    char expected[WHAT] = "", word[WORD], found[WORD];
    table_describe_number(expected, sizeof expected, p, column, vertices);
    snprintf(word, sizeof word, "%.*s", (int)strcspn(scan->at, ENDS), scan->at);
    text_clip(found, sizeof found, word);
    return set_error(PDYN_BAD_INPUT, "%.1024s:%ld: expected %s, found \"%s\"", scan->path,
                     scan->line, expected, found);
}

static pdyn_status read_row(struct scan *scan, const pdyn_param *param, int vertices, double *row) {
    int width = param_width(param), count = 0;
    for (; find_word(scan); count++) {
        char *end;
        double value = strtod(scan->at, &end);
        if (count == width) return fail_row(scan, width, width + 1);
        if (end == scan->at || !strchr(ENDS, *end) ||
            !table_allows(param, row, count, value, vertices))
            return fail_number(scan, param, count, vertices);
        row[count] = value, scan->at = end;
    }
    return count == width ? PDYN_OK : fail_row(scan, width, count);
}

/* ---- files ----------------------------------------------------------------------------------- */

static pdyn_status check_count(const struct scan *scan, const pdyn_param *param, size_t found,
                               int rows) {
    char expected[WHAT] = "";
    if (found && (!rows || found == (size_t)rows)) {
        if (found <= (size_t)(INT_MAX / param_width(param))) return PDYN_OK;
        return set_error(PDYN_BAD_INPUT, "%.1024s: more than %d numbers", scan->path, INT_MAX);
    }
    table_describe(expected, sizeof expected, param, rows, "lines");
    return set_error(PDYN_BAD_INPUT, "%.1024s: expected %s, found %zu", scan->path, expected,
                     found);
}

static pdyn_status read_rows(struct scan *scan, const pdyn_param *param, int rows, int vertices,
                             pdyn_table *out) {
    size_t found = count_rows(scan), width = (size_t)param_width(param);
    pdyn_status status = check_count(scan, param, found, rows);
    if (status != PDYN_OK) return status;
    double *value = table_allocate(scan->context, param, (int)found, out);
    if (!value) return PDYN_NO_MEMORY;
    for (; status == PDYN_OK && find_row(scan); value += width)
        status = read_row(scan, param, vertices, value);
    return status;
}

pdyn_status table_file_read(pdyn_context *context, const char *path, const pdyn_param *param,
                            int rows, int vertices, pdyn_table *out) {
    struct scan scan = {.context = context, .path = path, .line = 1};
    pdyn_status status = file_load(context, path, &scan.data, &scan.size);
    if (status == PDYN_OK) status = read_rows(&scan, param, rows, vertices, out);
    scan_free(&scan);
    return status;
}
