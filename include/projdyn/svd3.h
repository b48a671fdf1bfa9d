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

/* Completes a decomposition of F from the eigenvalues and eigenvectors of F' F. */
static inline svd3 svd3_complete(const double *F, const double value[3], double right[3][3]) {
    static const double unit[3] = {1, 0, 0};
    svd3 d;
    double along[3][3];
    int order[3] = {0, 1, 2};
    for (int k = 0; k < 3; k++) { /* descending: 3 exchanges sort 3 numbers */
        int i = k == 1 ? 1 : 0, high = order[i + 1];
        if (value[order[i]] < value[high]) order[i + 1] = order[i], order[i] = high;
    }
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) d.right[i][k] = right[order[i]][k];
    vec3_cross(d.right[2], d.right[0], d.right[1]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            along[i][k] =
                d.right[i][0] * F[k] + d.right[i][1] * F[3 + k] + d.right[i][2] * F[6 + k];
    d.s[0] = vec3_length(along[0]);
    for (int k = 0; k < 3; k++)
        d.left[0][k] = d.s[0] > 0.0 ? along[0][k] / d.s[0] : unit[k], d.left[1][k] = along[1][k];
    svd3_make_normal(d.left[1], d.left[0], 1e-12 * d.s[0]);
    vec3_cross(d.left[2], d.left[0], d.left[1]);
    d.s[1] = vec3_dot(d.left[1], along[1]), d.s[2] = vec3_dot(d.left[2], along[2]);
    return d;
}

/* Decomposes `lanes` matrices, up to SVD3_LANES, in the time of one: the same bits as svd3_of. The
 * right vectors are the eigenvectors of F' F. `lanes` is a constant, the caller WIDE (simd.h). */
INLINE void svd3_of_lanes(const double *const F[], svd3 *d, int lanes) {
    svd3_lanes A, right;
    for (int l = 0; l < lanes; l++)
        for (int k = 0; k < 9; k++) {
            A[k / 3][k % 3][l] = vec3_dot(F[l] + 3 * (k / 3), F[l] + 3 * (k % 3));
            right[k / 3][k % 3][l] = k % 4 ? 0.0 : 1.0;
        }
    svd3_diagonalise(A, right, lanes);
    for (int l = 0; l < lanes; l++) {
        double value[3] = {A[0][0][l], A[1][1][l], A[2][2][l]}, vectors[3][3];
        for (int k = 0; k < 9; k++) vectors[k / 3][k % 3] = right[k / 3][k % 3][l];
        d[l] = svd3_complete(F[l], value, vectors);
    }
}

/* Decomposes F, column by column: F[3 * c + k] is entry (k, c). Needs finite entries. */
static inline svd3 svd3_of(const double *F) {
    svd3 d;
    svd3_of_lanes(&F, &d, 1);
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
