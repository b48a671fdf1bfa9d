/* Reading tables from text files, in two passes: rows are counted, then read. */
#include "table_file.h"

#include "base/file_in.h"
#include "base/text.h"
#include "params.h"
#include "table.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WHAT = 128, WORD = 40 };

struct source {
    pdyn_context *context;
    const char *path;
    const pdyn_param *param;
    char *data; /* size bytes and a closing NUL */
    size_t size;
    const char *at; /* current position */
    long line;
};

/* ---- lines ----------------------------------------------------------------------------------- */

/* Skips what is between two numbers of a line. Returns whether there is another word. */
static bool find_word(struct source *f) {
    f->at += strspn(f->at, " \t\r,");
    return *f->at != '\n' && *f->at != '#' && f->at < f->data + f->size;
}

/* Goes to the next line that has a word; false: there is none. */
static bool find_row(struct source *f) {
    while (!find_word(f)) {
        const char *end = f->data + f->size, *next = memchr(f->at, '\n', (size_t)(end - f->at));
        if (!next) return false;
        f->at = next + 1, f->line++;
    }
    return true;
}

static void end_row(struct source *f) {
    const char *end = f->data + f->size, *next = memchr(f->at, '\n', (size_t)(end - f->at));
    f->at = next ? next : end;
}

static size_t count_rows(struct source *f) {
    size_t rows = 0;
    for (f->at = f->data; find_row(f); end_row(f)) rows++;
    f->at = f->data, f->line = 1;
    return rows;
}

/* ---- numbers --------------------------------------------------------------------------------- */

static pdyn_status fail_row(const struct source *f, int found) {
    int width = param_width(f->param);
    return context_fail(f->context, PDYN_BAD_INPUT, "%.1024s:%ld: expected %d number%s, found %s%d",
                        f->path, f->line, width, width == 1 ? "" : "s",
                        found > width ? "more than " : "", found > width ? width : found);
}

static pdyn_status fail_number(const struct source *f) {
    char expected[WHAT] = "", word[WORD], found[WORD];
    const pdyn_param *p = f->param;
    params_describe_bounds(expected, sizeof expected, "a number", p->min, p->max, p->unit);
    snprintf(word, sizeof word, "%.*s", (int)strcspn(f->at, " \t\r\n,#"), f->at);
    text_clip(found, sizeof found, word);
    return context_fail(f->context, PDYN_BAD_INPUT, "%.1024s:%ld: expected %s, found \"%s\"",
                        f->path, f->line, expected, found);
}

static pdyn_status read_row(struct source *f, double *row) {
    int width = param_width(f->param), count = 0;
    for (; find_word(f); count++) {
        char *end;
        double value = strtod(f->at, &end);
        if (end == f->at || !strchr(" \t\r\n,#", *end) || !param_allows(f->param, value))
            return fail_number(f);
        if (count == width) return fail_row(f, width + 1);
        row[count] = value, f->at = end;
    }
    return count == width ? PDYN_OK : fail_row(f, count);
}

/* ---- files ----------------------------------------------------------------------------------- */

static pdyn_status check_count(const struct source *f, size_t found, int rows) {
    char expected[WHAT] = "";
    if (found && (!rows || found == (size_t)rows)) {
        if (found <= (size_t)(INT_MAX / param_width(f->param))) return PDYN_OK;
        return context_fail(f->context, PDYN_BAD_INPUT, "%.1024s: more than %d numbers", f->path,
                            INT_MAX);
    }
    table_describe(f->param, rows, "lines", expected, sizeof expected);
    return context_fail(f->context, PDYN_BAD_INPUT, "%.1024s: expected %s, found %zu", f->path,
                        expected, found);
}

static pdyn_status read_rows(struct source *f, int rows, pdyn_table *out) {
    size_t found = count_rows(f), width = (size_t)param_width(f->param);
    pdyn_status status = check_count(f, found, rows);
    if (status != PDYN_OK) return status;
    double *value = table_allocate(f->context, f->param, (int)found, out);
    if (!value) return PDYN_NO_MEMORY;
    for (; status == PDYN_OK && find_row(f); value += width) status = read_row(f, value);
    return status;
}

pdyn_status table_file_read(pdyn_context *context, const char *path, const pdyn_param *param,
                            int rows, pdyn_table *out) {
    struct source f = {.context = context, .path = path, .param = param, .line = 1};
    pdyn_status status = file_load(context, path, &f.data, &f.size);
    if (status == PDYN_OK) status = read_rows(&f, rows, out);
    FREE_ARRAY(context, f.data, f.size + 1);
    return status;
}
