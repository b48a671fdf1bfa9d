/* Functions marked WIDE run in their widest version on machines that have it, with any compiler:
 * fused multiply-add is recognised by its missing rounding. */
#include "support.h"

#include "projdyn/simd.h"

#ifndef SIMD_PLAIN
WIDE static void take_rest(double x, double square, double *rest) { *rest = x * x - square; }
#endif

static void test_chosen(void **state) {
    (void)state;
#ifdef SIMD_PLAIN
    skip();
#else
    volatile double x = 1.0 + 0x1p-30, square = x * x;
    double rest;
    take_rest(x, square, &rest);
    assert_int_equal(rest != 0.0, __builtin_cpu_supports("fma") != 0);
#endif
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_chosen)};
    return cmocka_run_group_tests_name("simd", tests, NULL, NULL);
}
