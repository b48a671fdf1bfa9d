/* Sorting by keys in place; qsort may allocate. */
#ifndef PDYN_SORT_BY_KEY_H
#define PDYN_SORT_BY_KEY_H

#include <stdint.h>

struct keyed {
    uint64_t key;
    int place; /* of what the key belongs to, in an array of the caller */
};

/* Heap sort, ascending. Keys that are sorted already take one pass. */
void sort_by_key(struct keyed *entry, int count);

#endif
