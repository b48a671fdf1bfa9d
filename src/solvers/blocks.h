/* Symmetric 3 x 3 blocks, packed xx xy xz yy yz zz. */
#ifndef PDYN_BLOCKS_H
#define PDYN_BLOCKS_H

#include "base/simd.h"

/* Inverts a positive definite one in place by its cofactors. */
INLINE void block_invert(double *D) {
    double a = D[0], b = D[1], d = D[2], e = D[3], f = D[4], g = D[5];
    double A = e * g - f * f, B = d * f - b * g, C = b * f - d * e;
    double s = 1.0 / (a * A + b * B + d * C);
    D[0] = s * A, D[1] = s * B, D[2] = s * C;
    D[3] = s * (a * g - d * d), D[4] = s * (b * d - a * f), D[5] = s * (a * e - b * b);
}

/* z = D r */
INLINE void block_multiply(double *z, const double *D, const double *r) {
    z[0] = D[0] * r[0] + D[1] * r[1] + D[2] * r[2];
    z[1] = D[1] * r[0] + D[3] * r[1] + D[4] * r[2];
    z[2] = D[2] * r[0] + D[4] * r[1] + D[5] * r[2];
}

#endif
