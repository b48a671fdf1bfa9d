/* Hints for an unknown word of a scene: names that resemble it, and names for what it means. */
#ifndef PDYN_HINT_H
#define PDYN_HINT_H

#include <stddef.h>

/* The name most similar to `word`: at most a third of the letters of the longer one differ, or one
 * letter, or one of the two is a part of the other, of at least 4 letters. NULL: none. */
const char *hint_closest(const char *word, const char *const *names, int count);

/* Appends `; did you mean "x"?` if one of the names resembles `word` or has its meaning, then `;
 * known: a, b, c`. */
void hint_append(char *text, size_t size, const char *word, const char *const *names, int count);

#endif
