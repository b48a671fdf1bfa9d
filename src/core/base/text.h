/* Text for people: growing it, keeping it clean, and hints for a word that was not understood. */
#ifndef PDYN_TEXT_H
#define PDYN_TEXT_H

#include "projdyn/projdyn.h"

#include <locale.h>

/* Adds formatted text to `text`, as much of it as fits into `size` bytes. */
void text_append(char *text, size_t size, const char *format, ...) PDYN_PRINTF(3, 4);

/* Copies at most size - 1 bytes: control characters become '?', and what is too long ends with
 * "..." after a whole UTF-8 character. */
void text_clip(char *text, size_t size, const char *from);

/* Adds `; did you mean "x"?` where one of the names is near, and `; known: a, b, c`. */
void text_hint(char *text, size_t size, const char *word, const char *const *names, int count);

/* Until text_end numbers have a decimal point, whatever the locale of the program. */
struct text_locale {
    locale_t plain, before;
};
bool text_begin(struct text_locale *locale); /* false: no memory */
void text_end(struct text_locale *locale);

#endif
