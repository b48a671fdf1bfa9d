#include "sort_by_key.h"

#include <stdbool.h>

/* Moves entry k of a heap, the largest key on top, down to its place among the first `count`. */
static void sift(struct keyed *heap, int k, int count) {
    for (int child; (child = 2 * k + 1) < count; k = child) {
        struct keyed moved = heap[k];
        if (child + 1 < count && heap[child + 1].key > heap[child].key) child++;
        if (heap[child].key <= moved.key) return;
        heap[k] = heap[child], heap[child] = moved;
    }
}

static bool is_sorted(const struct keyed *entry, int count) {
    int k = 1;
    while (k < count && entry[k - 1].key <= entry[k].key) k++;
    return k >= count;
}

void sort_by_key(struct keyed *entry, int count) {
    if (is_sorted(entry, count)) return;
    for (int k = count / 2 - 1; k >= 0; k--) sift(entry, k, count);
    for (int k = count - 1; k > 0; k--) {
        struct keyed largest = entry[0];
        entry[0] = entry[k], entry[k] = largest;
        sift(entry, 0, k);
    }
}
