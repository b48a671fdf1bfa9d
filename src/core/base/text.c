/* Text for messages: appending, clipping, the C locale. */
#include "text.h"

#include <stdio.h>
#include <string.h>

void text_append(char *text, size_t size, const char *format, ...) {
    size_t length = strlen(text);
    va_list args;
    va_start(args, format);
    text_write(text + length, size - length, format, args);
    va_end(args);
}

void text_clip(char *text, size_t size, const char *from) {
    size_t length = strlen(from), keep = length < size ? length : size - 4;
    if (keep < length)
        while (keep && ((unsigned char)from[keep] & 0xC0) == 0x80) keep--;
    for (size_t i = 0; i < keep; i++) {
        unsigned char c = (unsigned char)from[i];
        text[i] = c < 0x20 || c == 0x7F ? '?' : from[i];
    }
    strcpy(text + keep, keep < length ? "..." : "");
}

void text_write(char *text, size_t size, const char *format, va_list args) {
    struct text_locale locale;
    bool plain = text_begin(&locale);
    vsnprintf(text, size, format, args);
    if (plain) text_end(&locale);
}

bool text_begin(struct text_locale *locale) {
    locale->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (locale->plain) locale->before = uselocale(locale->plain);
    return locale->plain != (locale_t)0;
}

void text_end(struct text_locale *locale) {
    uselocale(locale->before);
    freelocale(locale->plain);
}
