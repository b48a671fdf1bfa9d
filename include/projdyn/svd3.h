/* Singular value decomposition of 3 x 3 matrices, for constraints on deformation gradients. */
#ifndef PROJDYN_SVD3_H
#define PROJDYN_SVD3_H

#include "vec3.h"

/* F = sum_i s_i left_i right_i' with s[0] >= s[1] >= |s[2]|. Both triples of unit vectors are
 * right-handed, so s[2] has the sign of det F. The left vector of s_i = 0 is any unit vector normal
 * to the others. */
typedef struct svd3 {
    double s[3], left[3][3], right[3][3];
} svd3;

/* A Jacobi rotation of axes i and j: makes A_ij of the symmetric A zero and rotates the rows i and
 * j of `right`. Of the two angles the smaller, tan = t (Golub and Van Loan, Matrix
 * Computations, 8.5). */
static inline void svd3_rotate(double A[3][3], int i, int j, double right[3][3]) {
    if (A[i][j] == 0.0) return;
    double ratio = (A[j][j] - A[i][i]) / (2.0 * A[i][j]);
    double t = copysign(1.0, ratio) / (fabs(ratio) + sqrt(1.0 + ratio * ratio));
    double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    int k = 3 - i - j; /* the third axis */
    double a = A[k][i], b = A[k][j];
    A[i][i] -= t * A[i][j], A[j][j] += t * A[i][j], A[i][j] = A[j][i] = 0.0;
    A[k][i] = A[i][k] = c * a - s * b, A[k][j] = A[j][k] = s * a + c * b;
    for (k = 0; k < 3; k++) {
        a = right[i][k], b = right[j][k];
        right[i][k] = c * a - s * b, right[j][k] = s * a + c * b;
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

/* Decomposes F, column by column: F[3 * c + k] is entry (k, c). The right vectors are the
 * eigenvectors of F' F, by Jacobi rotations: at most eight sweeps, to rounding errors. Needs finite
 * entries. */
static inline svd3 svd3_of(const double *F) {
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    svd3 d;
    double A[3][3], right[3][3], along[3][3];
    int order[3] = {0, 1, 2};
    for (int k = 0; k < 9; k++) {
        A[k / 3][k % 3] = vec3_dot(F + 3 * (k / 3), F + 3 * (k % 3));
        right[k / 3][k % 3] = unit[k / 3][k % 3];
    }
    double rounding = 1e-16 * (A[0][0] + A[1][1] + A[2][2]);
    for (int sweep = 0; sweep < 8; sweep++) {
        if (fabs(A[0][1]) + fabs(A[0][2]) + fabs(A[1][2]) <= rounding) break;
        svd3_rotate(A, 0, 1, right), svd3_rotate(A, 0, 2, right), svd3_rotate(A, 1, 2, right);
    }
    for (int k = 0; k < 3; k++) { /* descending: 3 exchanges sort 3 numbers */
        int i = k == 1 ? 1 : 0, high = order[i + 1];
        if (A[order[i]][order[i]] < A[high][high]) order[i + 1] = order[i], order[i] = high;
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
        d.left[0][k] = d.s[0] > 0.0 ? along[0][k] / d.s[0] : unit[0][k], d.left[1][k] = along[1][k];
    svd3_make_normal(d.left[1], d.left[0], 1e-12 * d.s[0]);
    vec3_cross(d.left[2], d.left[0], d.left[1]);
    d.s[1] = vec3_dot(d.left[1], along[1]), d.s[2] = vec3_dot(d.left[2], along[2]);
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
