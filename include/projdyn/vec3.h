/* The few 3-vector operations that modules and core share. */
#ifndef PROJDYN_VEC3_H
#define PROJDYN_VEC3_H

#include <math.h>

static inline double vec3_dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline double vec3_length(const double *a) { return sqrt(vec3_dot(a, a)); }
static inline double vec3_distance(const double *a, const double *b) {
    double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return vec3_length(d);
}

/* y = a x b, another vector than both */
static inline void vec3_cross(double *y, const double *a, const double *b) {
    y[0] = a[1] * b[2] - a[2] * b[1];
    y[1] = a[2] * b[0] - a[0] * b[2];
    y[2] = a[0] * b[1] - a[1] * b[0];
}

/* y += s a */
static inline void vec3_add(double *y, double s, const double *a) {
    for (int k = 0; k < 3; k++) y[k] += s * a[k];
}

/* y = A a, A 3 x 3 by rows */
static inline void vec3_multiply(double *y, const double *A, const double *a) {
    for (int k = 0; k < 3; k++) y[k] = vec3_dot(A + 3 * k, a);
}

/* Normal of a triangle, as long as twice its area. */
static inline void vec3_normal(double *n, const double *a, const double *b, const double *c) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    vec3_cross(n, u, v);
}

/* The projection of a 3-vector onto the sphere of radius `length`, and its tangent, clamped to a
 * contraction: J = min(1, length/|u|) (I - n n') = s I - a a', a = t u. A zero vector stays where
 * it is. */
static inline void vec3_project_length(double *p, const double *u, double length) {
    double l = vec3_length(u), s = l > 0.0 ? length / l : 0.0;
    for (int k = 0; k < 3; k++) p[k] = s * u[k];
}
static inline void vec3_contraction(double *s, double *t, const double *u, double length) {
    double ll = vec3_dot(u, u), r = ll > 0.0 ? 1.0 / sqrt(ll) : 0.0, ratio = length * r;
    *s = ratio < 1.0 ? ratio : 1.0, *t = sqrt(*s) * r;
}
static inline void vec3_axis_length(double *axis, const double *u, double length) {
    double t;
    vec3_contraction(axis + 3, &t, u, length);
    for (int k = 0; k < 3; k++) axis[k] = t * u[k];
}
/* J = s I - a a' from a and s */
static inline void vec3_axis_tangent(double *J, const double *axis) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) J[3 * a + b] = (a == b ? axis[3] : 0.0) - axis[a] * axis[b];
}
static inline void vec3_tangent_length(double *J, const double *u, double length) {
    double axis[4];
    vec3_axis_length(axis, u, length);
    vec3_axis_tangent(J, axis);
}

#endif
