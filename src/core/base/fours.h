/* Sixteen floats, four of them for each of four particles or rows: in two registers, which
 * compilers for narrower and for wider ones make good code of, too. Whole ones would go through
 * memory there, and so do halves that are not loaded one by one. */
#ifndef PDYN_FOURS_H
#define PDYN_FOURS_H

#include "simd.h"

typedef float v8f __attribute__((vector_size(32)));
typedef struct {
    v8f low, high;
} fours;

#define SHUFFLE __builtin_shufflevector
/* Numbers of two fours that begin with these, and of number k of two fours, four times each. */
#define TWO(a, b)   a, a + 1, a + 2, a + 3, b, b + 1, b + 2, b + 3
#define EACH_TWO(k) k, k, k, k, k + 4, k + 4, k + 4, k + 4

INLINE void fours_zero(fours *out) { out->low = out->high = (v8f){0}; }
INLINE void fours_join(fours *out, const v4f *a, const v4f *b, const v4f *c, const v4f *d) {
    out->low = SHUFFLE(*a, *b, TWO(0, 4)), out->high = SHUFFLE(*c, *d, TWO(0, 4));
}
INLINE void fours_load(fours *out, const void *from) {
    memcpy(&out->low, from, sizeof out->low);
    memcpy(&out->high, (const char *)from + sizeof out->low, sizeof out->high);
}
INLINE void fours_store(void *to, const fours *x) {
    memcpy(to, &x->low, sizeof x->low);
    memcpy((char *)to + sizeof x->low, &x->high, sizeof x->high);
}
/* out = x - y */
INLINE void fours_subtract(fours *out, const fours *x, const fours *y) {
    out->low = x->low - y->low, out->high = x->high - y->high;
}
/* sum += x */
INLINE void fours_add(fours *sum, const fours *x) { sum->low += x->low, sum->high += x->high; }
/* out = x y */
INLINE void fours_multiply(fours *out, const fours *x, const fours *y) {
    out->low = x->low * y->low, out->high = x->high * y->high;
}
/* sum += number k of each four of x times y */
INLINE void fours_add_each(fours *sum, const fours *x, int k, const fours *y) {
    v8f low, high;
    if (k == 0) low = SHUFFLE(x->low, x->low, EACH_TWO(0));
    else if (k == 1) low = SHUFFLE(x->low, x->low, EACH_TWO(1));
    else if (k == 2) low = SHUFFLE(x->low, x->low, EACH_TWO(2));
    else low = SHUFFLE(x->low, x->low, EACH_TWO(3));
    if (k == 0) high = SHUFFLE(x->high, x->high, EACH_TWO(0));
    else if (k == 1) high = SHUFFLE(x->high, x->high, EACH_TWO(1));
    else if (k == 2) high = SHUFFLE(x->high, x->high, EACH_TWO(2));
    else high = SHUFFLE(x->high, x->high, EACH_TWO(3));
    sum->low += low * y->low, sum->high += high * y->high;
}
/* The sums of the fours of x[0], x[1], x[2], x[3] */
INLINE void fours_sums(fours *out, const fours x[4]) {
    v8f a = x[0].low + x[0].high, b = x[1].low + x[1].high;
    v8f c = x[2].low + x[2].high, d = x[3].low + x[3].high;
    out->low = SHUFFLE(a, b, TWO(0, 8)) + SHUFFLE(a, b, TWO(4, 12));
    out->high = SHUFFLE(c, d, TWO(0, 8)) + SHUFFLE(c, d, TWO(4, 12));
}
/* The sum of each four, four times. */
INLINE void fours_sum_each(fours *out, const fours *x) {
    v8f low = x->low + SHUFFLE(x->low, x->low, 1, 0, 3, 2, 5, 4, 7, 6);
    v8f high = x->high + SHUFFLE(x->high, x->high, 1, 0, 3, 2, 5, 4, 7, 6);
    out->low = low + SHUFFLE(low, low, 2, 3, 0, 1, 6, 7, 4, 5);
    out->high = high + SHUFFLE(high, high, 2, 3, 0, 1, 6, 7, 4, 5);
}
/* sum += x y */
INLINE void fours_add_product(fours *sum, const fours *x, const fours *y) {
    sum->low += x->low * y->low, sum->high += x->high * y->high;
}

#undef SHUFFLE
#undef TWO
#undef EACH_TWO

#endif
