/* Words, numbers, lines and errors of a file in memory. */
#include "scan.h"

#include "file_in.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- words ----------------------------------------------------------------------------------- */

bool scan_at_end(const struct scan *scan) { return scan->at == scan->data + scan->size; }

struct word scan_word(struct scan *scan) {
    while (*scan->at != '\n' && isspace((unsigned char)*scan->at)) scan->at++;
    const char *start = scan->at;
    while (!scan_at_end(scan) && !isspace((unsigned char)*scan->at)) scan->at++;
    scan->last = start;
    return (struct word){start, (size_t)(scan->at - start)};
}

void scan_next_line(struct scan *scan) {
    const char *end = scan->data + scan->size;
    const char *newline = memchr(scan->at, '\n', (size_t)(end - scan->at));
    scan->at = newline ? newline + 1 : end;
    scan->line += newline != NULL;
}

void scan_skip_blank(struct scan *scan) {
    struct word word;
    while (!(word = scan_word(scan)).length && !scan_at_end(scan)) scan_next_line(scan);
    scan->at = word.text;
}

bool word_is(struct word word, const char *text) {
    return word.length == strlen(text) && !memcmp(word.text, text, word.length);
}

bool word_number(struct word word, double *value) {
    if (!word.length) return false;
    char *end;
    *value = strtod(word.text, &end);
    return end == word.text + word.length;
}

/* ---- bytes ----------------------------------------------------------------------------------- */

uint64_t scan_bits(const char *at, size_t size, bool big) {
    uint64_t bits = 0;
    for (size_t k = 0; k < size; k++) bits = bits << 8 | (unsigned char)at[big ? k : size - 1 - k];
    return bits;
}

double scan_float(uint64_t bits) {
    uint32_t low = (uint32_t)bits;
    float value;
    memcpy(&value, &low, sizeof value);
    return value;
}

double scan_double(uint64_t bits) {
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* ---- errors ---------------------------------------------------------------------------------- */

pdyn_status scan_fail(const struct scan *scan, const char *format, ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (char *c = text; *c; c++)
        if (!isprint((unsigned char)*c)) *c = '?';
    if (scan->binary)
        return set_error(PDYN_BAD_INPUT, "%.1024s: byte %td: %s", scan->path,
                         scan->last - scan->data, text);
    return set_error(PDYN_BAD_INPUT, "%.1024s:%ld: %s", scan->path, scan->line, text);
}

pdyn_status scan_expected(const struct scan *scan, const char *what, struct word found) {
    if (found.length)
        return scan_fail(scan, "expected %s, found '%.*s'", what,
                         found.length < 40 ? (int)found.length : 40, found.text);
    return scan_fail(scan, "expected %s, found the end of the %s", what,
                     scan->binary || scan_at_end(scan) ? "file" : "line");
}

/* ---- the file -------------------------------------------------------------------------------- */

pdyn_status scan_load(struct scan *scan) {
    pdyn_status status = file_load(scan->context, scan->path, &scan->data, &scan->size);
    scan->at = scan->data, scan->line = 1;
    if (status != PDYN_OK || scan->size) return status;
    return set_error(PDYN_BAD_INPUT, "%.1024s: the file is empty", scan->path);
}

void scan_free(struct scan *scan) { FREE_ARRAY(scan->context, scan->data, scan->size + 1); }
