/* The point of a triangle closest to a given point, in barycentric coordinates. x and the corners
 * have 3 coordinates each, m. */
#ifndef PROJDYN_CLOSEST3_H
#define PROJDYN_CLOSEST3_H

#include "vec3.h"

/* |x - sum_k w_k corner_k|^2 */
static inline double closest3_squared(const double *x, const double *const corner[3],
                                      const double w[3]) {
    double u[3] = {x[0], x[1], x[2]};
    for (int k = 0; k < 3; k++) vec3_add(u, -w[k], corner[k]);
    return vec3_dot(u, u);
}

/* a / b clamped to [0, 1]; 0 for b <= 0 */
static inline double closest3_clamped(double a, double b) {
    return a <= 0.0 || b <= 0.0 ? 0.0 : a < b ? a / b : 1.0;
}

/* Finds the point closest to x on the side from corner i to corner j. If its squared distance is
 * below *best, sets *best to that and w to the barycentric coordinates of the point. */
static inline void closest3_try_side(const double *x, const double *const corner[3], int i, int j,
                                     double *best, double w[3]) {
    double ab[3], ap[3], on[3] = {0};
    vec3_subtract(ab, corner[j], corner[i]), vec3_subtract(ap, x, corner[i]);
    on[j] = closest3_clamped(vec3_dot(ap, ab), vec3_dot(ab, ab));
    on[i] = 1.0 - on[j];
    double d = closest3_squared(x, corner, on);
    if (d >= *best) return;
    *best = d;
    for (int k = 0; k < 3; k++) w[k] = on[k];
}

/* Sets w to the barycentric coordinates of the point of the triangle closest to x and returns the
 * squared distance. The signs of three areas tell whether the closest point is inside; otherwise,
 * and for a triangle without area, it is the closest point of the three sides. */
static inline double closest3_triangle(const double *x, const double *const corner[3],
                                       double w[3]) {
    double ab[3], ac[3], ap[3], best = INFINITY;
    vec3_subtract(ab, corner[1], corner[0]), vec3_subtract(ac, corner[2], corner[0]);
    vec3_subtract(ap, x, corner[0]);
    double bb = vec3_dot(ab, ab), bc = vec3_dot(ab, ac), cc = vec3_dot(ac, ac);
    double pb = vec3_dot(ap, ab), pc = vec3_dot(ap, ac);
    double area = bb * cc - bc * bc, b = cc * pb - bc * pc, c = bb * pc - bc * pb;
    if (b > 0.0 && c > 0.0 && b + c < area && area > 1e-14 * bb * cc) {
        w[1] = b / area, w[2] = c / area, w[0] = 1.0 - w[1] - w[2];
        return closest3_squared(x, corner, w);
    }
    w[0] = 1.0, w[1] = w[2] = 0.0;
    for (int k = 0; k < 3; k++) closest3_try_side(x, corner, k, (k + 1) % 3, &best, w);
    return best;
}

#endif
