/* Selection of near points: a portable version and one with the AVX-512 compress instruction. Both
 * give the same result. */
#include "compress.h"

#ifdef __x86_64__
#include <immintrin.h>
#endif

/* Writes every id and advances only past the selected ones: no branch, so no misprediction. */
static int compress_plain(const double *squared, const int *id, int count, double limit,
                          int without, int *list) {
    int found = 0;
    for (int k = 0; k < count; k++) {
        list[found] = id[k];
        found += (squared[k] < limit) & (id[k] != without);
    }
    return found;
}

#ifdef __x86_64__
__attribute__((target("avx512f"))) static int compress_wider(const double *squared, const int *id,
                                                             int count, double limit, int without,
                                                             int *list) {
    __m512d bound = _mm512_set1_pd(limit);
    __m512i left_out = _mm512_set1_epi32(without);
    int found = 0;
    for (int k = 0; k < count; k += 16) {
        unsigned there = count - k < 16 ? (1u << (count - k)) - 1u : 0xffffu;
        __m512d low = _mm512_maskz_loadu_pd((__mmask8)there, squared + k),
                high = _mm512_maskz_loadu_pd((__mmask8)(there >> 8), squared + k + 8);
        __m512i ids = _mm512_maskz_loadu_epi32((__mmask16)there, id + k);
        unsigned near = _mm512_cmp_pd_mask(low, bound, _CMP_LT_OQ) |
                        (unsigned)_mm512_cmp_pd_mask(high, bound, _CMP_LT_OQ) << 8;
        near &= there & _mm512_cmpneq_epi32_mask(ids, left_out);
        int more = __builtin_popcount(near);
        _mm512_mask_storeu_epi32(list + found, (__mmask16)((1u << more) - 1u),
                                 _mm512_maskz_compress_epi32((__mmask16)near, ids));
        found += more;
    }
    return found;
}
#endif

int compress_ids(const double *squared, const int *id, int count, double limit, int without,
                 int *list) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512f"))
        return compress_wider(squared, id, count, limit, without, list);
#endif
    return compress_plain(squared, id, count, limit, without, list);
}
