/* SIMD with four lanes, by the vector types of GCC and Clang. A 3-vector padded to four doubles is
 * loaded, scaled and added at once. A static function marked WIDE is compiled for the plain target,
 * AVX2 and AVX-512; the loader chooses when the program starts. All versions give the same bits,
 * except the kernels of linear solves on machines without fused multiply-add. Names of WIDE
 * functions must be unique in the library, because clang makes the choice global. */
#ifndef PROJDYN_SIMD_H
#define PROJDYN_SIMD_H

#include <string.h>

typedef double v4 __attribute__((vector_size(32)));

/* Sanitizers do not support the loader's choice between versions of a function. A build for one
 * processor (-march=native) cannot inline its functions into versions for others. For valgrind,
 * which does not know all instructions of the wide versions, build with -Dc_args=-DSIMD_PLAIN. */
#if !defined(__x86_64__) || defined(__AVX2__) || defined(__SANITIZE_ADDRESS__) ||                  \
    defined(__SANITIZE_THREAD__)
#define SIMD_PLAIN
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SIMD_PLAIN
#endif
#endif

/* Clang: by feature names, because before version 18 a version for an architecture level is never
 * chosen. */
#if defined(SIMD_PLAIN)
#define WIDE
#elif defined(__clang__)
#define WIDE __attribute__((target_clones("avx512f", "fma", "default")))
#else
#define WIDE __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif

/* For functions called by WIDE functions: they must become part of the caller to be compiled for
 * its target. */
#define INLINE static inline __attribute__((always_inline))

/* Vectors are passed by address: by value, the plain and the wide targets use different registers.
 */

/* out = (a[0], a[1], a[2], last) */
INLINE void v4_set(v4 *out, const double *a, double last) {
    v4 value = {a[0], a[1], a[2], last};
    *out = value;
}

/* Loads or stores element `index` of an array of 4-vectors. */
INLINE void v4_load(v4 *to, const double *from, int index) {
    memcpy(to, from + 4 * (size_t)index, sizeof *to);
}
INLINE void v4_store(double *to, int index, const v4 *from) {
    memcpy(to + 4 * (size_t)index, from, sizeof *from);
}

/* out = (from[0], ..., from[3]); as a loop, four lanes are converted by one instruction */
INLINE void v4_widen(v4 *out, const float *from) {
    double wide[4];
    for (int a = 0; a < 4; a++) wide[a] = (double)from[a];
    memcpy(out, wide, sizeof wide);
}

/* y += a, first three lanes */
INLINE void v4_add_to(double *y, const v4 *a) { y[0] += (*a)[0], y[1] += (*a)[1], y[2] += (*a)[2]; }

/* a . b of the first three lanes */
INLINE double v4_dot(const v4 *a, const v4 *b) {
    return (*a)[0] * (*b)[0] + (*a)[1] * (*b)[1] + (*a)[2] * (*b)[2];
}

/* The sum of all four lanes */
INLINE double v4_sum(const v4 *a) { return ((*a)[0] + (*a)[2]) + ((*a)[1] + (*a)[3]); }

/* Dot product of a and b, `count` each, summed in sixteen lanes: no addition waits for another. */
INLINE double simd_dot(const double *a, const double *b, int count) {
    v4 sum[4] = {{0}}, x, y;
    double rest = 0.0;
    int k = 0;
    for (; k + 16 <= count; k += 16)
        for (int l = 0; l < 4; l++) {
            memcpy(&x, a + k + 4 * l, sizeof x);
            memcpy(&y, b + k + 4 * l, sizeof y);
            sum[l] += x * y;
        }
    for (; k < count; k++) rest += a[k] * b[k];
    v4 all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    return v4_sum(&all) + rest;
}

#endif
