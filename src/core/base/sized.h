/* Structs of public functions, whose size in the program may differ from that in the library. */
#ifndef PDYN_SIZED_H
#define PDYN_SIZED_H

#include <string.h>

/* Copies what both sides know; the rest of `out` becomes 0. out NULL: does nothing. */
static inline void sized_copy(void *out, size_t out_size, const void *from, size_t from_size) {
    if (!out) return;
    size_t common = out_size < from_size ? out_size : from_size;
    memset(out, 0, out_size);
    memcpy(out, from, common);
}

#endif
