/* Operations on 3-vectors, 3 x 3 matrices and the projection to a given length. Vectors have
 * 3 numbers, matrices 9, row by row. */
#ifndef PROJDYN_VEC3_H
#define PROJDYN_VEC3_H

#include <math.h>

static inline double vec3_dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline double vec3_length(const double *a) { return sqrt(vec3_dot(a, a)); }

/* y = a - b */
static inline void vec3_subtract(double *y, const double *a, const double *b) {
    for (int k = 0; k < 3; k++) y[k] = a[k] - b[k];
}
static inline double vec3_distance(const double *a, const double *b) {
    double d[3];
    vec3_subtract(d, a, b);
    return vec3_length(d);
}

/* y += s a */
static inline void vec3_add(double *y, double s, const double *a) {
    for (int k = 0; k < 3; k++) y[k] += s * a[k];
}

/* A += s I; A: a symmetric matrix, packed xx xy xz yy yz zz */
static inline void vec3_add_identity(double *A, double s) { A[0] += s, A[3] += s, A[5] += s; }

/* Divides a by its length, which is returned; the zero vector stays zero. */
static inline double vec3_normalise(double *a) {
    double length = vec3_length(a);
    for (int k = 0; k < 3; k++) a[k] = length > 0.0 ? a[k] / length : 0.0;
    return length;
}

/* y = a x b; y must not be a or b. */
static inline void vec3_cross(double *y, const double *a, const double *b) {
    y[0] = a[1] * b[2] - a[2] * b[1];
    y[1] = a[2] * b[0] - a[0] * b[2];
    y[2] = a[0] * b[1] - a[1] * b[0];
}

/* n = (b - a) x (c - a): the normal of triangle a, b, c; its length is twice the triangle's area.
 */
static inline void vec3_normal(double *n, const double *a, const double *b, const double *c) {
    double ab[3], ac[3];
    vec3_subtract(ab, b, a), vec3_subtract(ac, c, a);
    vec3_cross(n, ab, ac);
}

/* y = A a; A: 3 x 3, row by row; y must not be a. */
static inline void vec3_multiply(double *y, const double *A, const double *a) {
    for (int k = 0; k < 3; k++) y[k] = vec3_dot(A + 3 * k, a);
}

/* C = the cofactors of a symmetric 3 x 3 matrix A, so that its inverse is C over its determinant,
 * which is returned. C must not be A. */
static inline double vec3_cofactors(double *C, const double *A) {
    for (int k = 0; k < 3; k++) vec3_cross(C + 3 * k, A + 3 * ((k + 1) % 3), A + 3 * ((k + 2) % 3));
    return vec3_dot(A, C);
}

/* y = A^-1 b of a symmetric 3 x 3 matrix A, not finite where A is singular; y must not be b. */
static inline void vec3_solve(double *y, const double *A, const double *b) {
    double C[9], determinant = vec3_cofactors(C, A);
    vec3_multiply(y, C, b);
    for (int k = 0; k < 3; k++) y[k] /= determinant;
}

/* R = R_z R_y R_x, row by row: turns a vector by three angles in degrees, first about the x axis,
 * then about y, then about z. */
static inline void vec3_rotation(double *R, const double *degrees) {
    double c[3], s[3];
    for (int a = 0; a < 3; a++) {
        double radians = degrees[a] * acos(-1.0) / 180.0;
        c[a] = cos(radians), s[a] = sin(radians);
    }
    R[0] = c[1] * c[2], R[1] = s[0] * s[1] * c[2] - c[0] * s[2];
    R[2] = c[0] * s[1] * c[2] + s[0] * s[2];
    R[3] = c[1] * s[2], R[4] = s[0] * s[1] * s[2] + c[0] * c[2];
    R[5] = c[0] * s[1] * s[2] - s[0] * c[2];
    R[6] = -s[1], R[7] = s[0] * c[1], R[8] = c[0] * c[1];
}

/* ---- projection of a vector to a length ------------------------------------------------------ */

/* p = length u / |u|: the closest point to u on the sphere of this radius; p = 0 for u = 0. */
static inline void vec3_project_length(double *p, const double *u, double length) {
    double l = vec3_length(u), s = l > 0.0 ? length / l : 0.0;
    for (int k = 0; k < 3; k++) p[k] = s * u[k];
}

/* Tangent of vec3_project_length, clamped to eigenvalues in [0, 1]:
 *
 *     J = s (I - n n') = s I - (t u)(t u)',   s = min(1, length / |u|),  t = sqrt(s) / |u|
 *
 * with n = u / |u|. s = t = 0 for u = 0. */
static inline void vec3_contraction(double *s, double *t, const double *u, double length) {
    double squared = vec3_dot(u, u), inverse = squared > 0.0 ? 1.0 / sqrt(squared) : 0.0;
    double ratio = length * inverse;
    *s = ratio < 1.0 ? ratio : 1.0, *t = sqrt(*s) * inverse;
}
/* The same J as pdyn_constraint_type.tangent_rank1 wants it: axis = t u, then s. */
static inline void vec3_axis_length(double *axis, const double *u, double length) {
    double t;
    vec3_contraction(axis + 3, &t, u, length);
    for (int k = 0; k < 3; k++) axis[k] = t * u[k];
}
/* J = s I - a a', 3 x 3, from axis = a, then s. */
static inline void vec3_axis_tangent(double *J, const double *axis) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) J[3 * a + b] = (a == b ? axis[3] : 0.0) - axis[a] * axis[b];
}
/* The same J, 3 x 3. */
static inline void vec3_tangent_length(double *J, const double *u, double length) {
    double axis[4];
    vec3_axis_length(axis, u, length);
    vec3_axis_tangent(J, axis);
}

#endif
