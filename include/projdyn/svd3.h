/* Singular value decomposition of 3 x 3 matrices, for constraints on deformation gradients. */
#ifndef PROJDYN_SVD3_H
#define PROJDYN_SVD3_H

#include "simd.h"
#include "vec3.h"

/* F = sum_i s_i left_i right_i' with s[0] >= s[1] >= |s[2]|. Both triples of unit vectors are
 * right-handed, so s[2] has the sign of det F. The left vector of s_i = 0 is any unit vector normal
 * to the others. */
typedef struct svd3 {
    double s[3], left[3][3], right[3][3];
} svd3;

enum { SVD3_LANES = 8 };
typedef double svd3_lanes[3][3][SVD3_LANES]; /* matrices side by side: [row][column][matrix] */

/* Jacobi rotations of axes i and j of the first `lanes` matrices where `active` is 1: each makes
 * A_ij of the symmetric A zero and rotates the rows i and j of `right`. Of the two angles the
 * smaller, tan = t (Golub and Van Loan, Matrix Computations, 8.5). Without branches, so that it
 * becomes SIMD code. */
INLINE void svd3_rotate(svd3_lanes A, svd3_lanes right, const double *active, int lanes, int i,
                        int j) {
    int k = 3 - i - j; /* the third axis */
    for (int l = 0; l < lanes; l++) {
        double off = A[i][j][l], ratio = (A[j][j][l] - A[i][i][l]) / (2.0 * off);
        double t = copysign(1.0, ratio) / (fabs(ratio) + sqrt(1.0 + ratio * ratio));
        t = active[l] * fabs(off) > 0.0 ? t : 0.0;
        double c = 1.0 / sqrt(1.0 + t * t), s = t * c, a = A[k][i][l], b = A[k][j][l];
        A[i][i][l] -= t * off, A[j][j][l] += t * off;
        A[i][j][l] = A[j][i][l] = active[l] > 0.0 ? 0.0 : off;
        A[k][i][l] = A[i][k][l] = c * a - s * b, A[k][j][l] = A[j][k][l] = s * a + c * b;
        for (int m = 0; m < 3; m++) {
            a = right[i][m][l], b = right[j][m][l];
            right[i][m][l] = c * a - s * b, right[j][m][l] = s * a + c * b;
        }
    }
}

/* Makes the rows of `right` eigenvectors of the symmetric A, and A diagonal: at most eight sweeps,
 * each matrix to its rounding errors. */
INLINE void svd3_diagonalise(svd3_lanes A, svd3_lanes right, int lanes) {
    double rounding[SVD3_LANES], active[SVD3_LANES], any = 1.0;
    for (int l = 0; l < lanes; l++) rounding[l] = 1e-16 * (A[0][0][l] + A[1][1][l] + A[2][2][l]);
    for (int sweep = 0; sweep < 8 && any > 0.0; sweep++) {
        any = 0.0;
        for (int l = 0; l < lanes; l++) {
            double off = fabs(A[0][1][l]) + fabs(A[0][2][l]) + fabs(A[1][2][l]);
            active[l] = off > rounding[l] ? 1.0 : 0.0, any += active[l];
        }
        svd3_rotate(A, right, active, lanes, 0, 1);
        svd3_rotate(A, right, active, lanes, 0, 2);
        svd3_rotate(A, right, active, lanes, 1, 2);
    }
}

/* Makes a the unit vector along a - (a . b) b, b a unit vector. If the length of that is at most
 * `least`, a becomes some unit vector normal to b. */
static inline void svd3_make_normal(double *a, const double *b, double least) {
    vec3_add(a, -vec3_dot(a, b), b);
    double length = vec3_length(a);
    if (!(length > least)) {
        int axis = fabs(b[0]) < fabs(b[1]) ? 0 : 1;
        if (fabs(b[2]) < fabs(b[axis])) axis = 2;
        for (int k = 0; k < 3; k++) a[k] = (k == axis) - b[axis] * b[k];
        length = vec3_length(a);
    }
    for (int k = 0; k < 3; k++) a[k] /= length;
}

/* Vectors of lane l: to = x . y, and to = x x y */
INLINE double svd3_dot(double x[3][SVD3_LANES], double y[3][SVD3_LANES], int l) {
    return x[0][l] * y[0][l] + x[1][l] * y[1][l] + x[2][l] * y[2][l];
}
INLINE void svd3_cross(double to[3][SVD3_LANES], double x[3][SVD3_LANES], double y[3][SVD3_LANES],
                       int l) {
    to[0][l] = x[1][l] * y[2][l] - x[2][l] * y[1][l];
    to[1][l] = x[2][l] * y[0][l] - x[0][l] * y[2][l];
    to[2][l] = x[0][l] * y[1][l] - x[1][l] * y[0][l];
}

/* Sorts the first 2 or 3 rows of `right` by falling eigenvalues A_ii; the last row makes them
 * right-handed. */
INLINE void svd3_sort(svd3_lanes A, svd3_lanes right, int columns, int lanes) {
    for (int k = 0; k < (columns == 3 ? 3 : 1); k++) { /* 3 exchanges sort 3 numbers */
        int i = k == 1 ? 1 : 0, j = i + 1;
        for (int l = 0; l < lanes; l++) {
            double a = A[i][i][l], b = A[j][j][l];
            A[i][i][l] = a < b ? b : a, A[j][j][l] = a < b ? a : b;
            for (int m = 0; m < 3; m++) {
                double x = right[i][m][l], y = right[j][m][l];
                right[i][m][l] = a < b ? y : x, right[j][m][l] = a < b ? x : y;
            }
        }
    }
    for (int l = 0; l < lanes; l++) svd3_cross(right[2], right[0], right[1], l);
}

/* left[1]: along[1] made normal to left[0], lane by lane where that is too short for a direction */
static inline void svd3_repair(svd3_lanes left, svd3_lanes along, int l) {
    double a[3], b[3];
    for (int k = 0; k < 3; k++) a[k] = along[1][k][l], b[k] = left[0][k][l];
    svd3_make_normal(a, b, INFINITY);
    for (int k = 0; k < 3; k++) left[1][k][l] = a[k];
}

/* Left vectors and singular values s from F and its sorted right vectors. */
INLINE void svd3_complete(svd3_lanes F, svd3_lanes right, svd3_lanes left, double s[3][SVD3_LANES],
                          int lanes) {
    svd3_lanes along;
    double length[SVD3_LANES];
    for (int l = 0; l < lanes; l++) {
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                along[i][k][l] = right[i][0][l] * F[0][k][l] + right[i][1][l] * F[1][k][l] +
                                 right[i][2][l] * F[2][k][l];
        s[0][l] = sqrt(svd3_dot(along[0], along[0], l));
        for (int k = 0; k < 3; k++)
            left[0][k][l] = s[0][l] > 0.0 ? along[0][k][l] / s[0][l] : k == 0;
        double part = svd3_dot(along[1], left[0], l);
        for (int k = 0; k < 3; k++) left[1][k][l] = along[1][k][l] - part * left[0][k][l];
        length[l] = sqrt(svd3_dot(left[1], left[1], l));
        for (int k = 0; k < 3; k++) left[1][k][l] /= length[l];
    }
    for (int l = 0; l < lanes; l++)
        if (!(length[l] > 1e-12 * s[0][l])) svd3_repair(left, along, l);
    for (int l = 0; l < lanes; l++) {
        svd3_cross(left[2], left[0], left[1], l);
        s[1][l] = svd3_dot(left[1], along[1], l), s[2][l] = svd3_dot(left[2], along[2], l);
    }
}

/* Decomposes `lanes` matrices, up to SVD3_LANES, in the time of one: the same bits as svd3_of. The
 * right vectors are the eigenvectors of F' F. With 2 columns F has 6 numbers, s[2] is 0, and
 * right[0] and right[1] end with 0. `columns` and `lanes` are constants, the caller is WIDE
 * (simd.h). */
INLINE void svd3_of_lanes(const double *const F[], svd3 *d, int columns, int lanes) {
    svd3_lanes f, A, right, left;
    double s[3][SVD3_LANES];
    for (int l = 0; l < lanes; l++)
        for (int k = 0; k < 9; k++) f[k / 3][k % 3][l] = k < 3 * columns ? F[l][k] : 0.0;
    for (int l = 0; l < lanes; l++)
        for (int k = 0; k < 9; k++) {
            A[k / 3][k % 3][l] = svd3_dot(f[k / 3], f[k % 3], l);
            right[k / 3][k % 3][l] = k % 4 ? 0.0 : 1.0;
        }
    svd3_diagonalise(A, right, lanes);
    svd3_sort(A, right, columns, lanes);
    svd3_complete(f, right, left, s, lanes);
    for (int l = 0; l < lanes; l++)
        for (int k = 0; k < 9; k++) {
            d[l].left[k / 3][k % 3] = left[k / 3][k % 3][l];
            d[l].right[k / 3][k % 3] = right[k / 3][k % 3][l];
            if (k < 3) d[l].s[k] = s[k][l];
        }
}

/* Decomposes F, column by column: F[3 * c + k] is entry (k, c). Needs finite entries. */
static inline svd3 svd3_of(const double *F) {
    svd3 d;
    svd3_of_lanes(&F, &d, 3, 1);
    return d;
}

/* F = sum_i s_i left_i right_i', column by column, with the vectors of d and the values s. */
static inline void svd3_compose(const svd3 *d, const double s[3], double *F) {
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            F[3 * c + k] = 0.0;
            for (int i = 0; i < 3; i++) F[3 * c + k] += s[i] * d->left[i][k] * d->right[i][c];
        }
}

#endif
