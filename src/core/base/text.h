/* Text for messages: write, append, clip; numbers have a decimal point in any locale. */
#ifndef PDYN_TEXT_H
#define PDYN_TEXT_H

#include "projdyn/projdyn.h"

#include <locale.h>
#include <stdarg.h>

enum { NAME_LENGTH = 64 }; /* largest length of the name of a body, a solid or a probe */

/* Appends formatted text, truncated to `size` bytes in all, the closing NUL included. */
void text_append(char *text, size_t size, const char *format, ...) PDYN_PRINTF(3, 4);

/* As vsnprintf. */
void text_write(char *text, size_t size, const char *format, va_list args);

/* Copies at most size - 1 bytes of `from`. Control characters become '?'; a longer text is cut
 * after a complete UTF-8 character and ends with "...". */
void text_clip(char *text, size_t size, const char *from);

/* Sets the C locale for the calling thread until text_end: numbers have a decimal point. */
struct text_locale {
    locale_t plain, before;
};
bool text_begin(struct text_locale *locale); /* false: no memory */
void text_end(struct text_locale *locale);

#endif
