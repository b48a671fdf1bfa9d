/* A file in memory that is read word by word, or byte by byte, from front to back: meshes,
 * particles, tables. Errors name the file and the line, or the byte. */
#ifndef PDYN_SCAN_H
#define PDYN_SCAN_H

#include "context.h"

struct scan {
    pdyn_context *context;
    const char *path;
    char *data; /* size bytes and a closing NUL */
    size_t size;
    const char *at;   /* current position */
    const char *last; /* start of the last word or value, for error messages */
    long line;
    bool binary; /* error messages give the byte, not the line */
};

/* Reads the file at `path` into memory, and begins at its first line. PDYN_BAD_INPUT: it is empty.
 */
pdyn_status scan_load(struct scan *scan);
void scan_free(struct scan *scan);

/* A word of a line; length 0: the line has no further word. */
struct word {
    const char *text;
    size_t length;
};
struct word scan_word(struct scan *scan);
void scan_next_line(struct scan *scan);
/* Skips blanks and line ends up to the next word, or to the end of the file. */
void scan_skip_blank(struct scan *scan);
bool scan_at_end(const struct scan *scan);
bool word_is(struct word word, const char *text);
bool word_number(struct word word, double *value);

/* The number, of at most 8 bytes, at a place of the file; big: the most significant byte is first.
 */
uint64_t scan_bits(const char *at, size_t size, bool big);
/* Converts a bit pattern to the number it represents. */
double scan_float(uint64_t bits);
double scan_double(uint64_t bits);

/* Sets the error text with file and position; returns PDYN_BAD_INPUT. */
pdyn_status scan_fail(const struct scan *scan, const char *format, ...) PDYN_PRINTF(2, 3);
pdyn_status scan_expected(const struct scan *scan, const char *what, struct word found);

#endif
