#include "frame.h"

#include "projdyn/vec3.h"

struct frame frame_of(const pdyn_body *body, int t) {
    struct frame f;
    double at[3][2] = {{0}}, other[3]; /* corners in the plane; second side */
    const double *p[3];
    for (int k = 0; k < 3; k++) p[k] = body->rest + 3 * (size_t)body->triangle[3 * t + k];
    vec3_subtract(f.axis[0], p[1], p[0]), vec3_subtract(other, p[2], p[0]);
    vec3_cross(f.axis[2], f.axis[0], other);
    f.area = 0.5 * vec3_normalise(f.axis[2]);
    double length = vec3_normalise(f.axis[0]);
    vec3_cross(f.axis[1], f.axis[2], f.axis[0]);
    at[1][0] = length;
    for (int a = 0; a < 2; a++) at[2][a] = vec3_dot(f.axis[a], other);
    for (int k = 0; k < 3; k++) {
        const double *a = at[(k + 1) % 3], *b = at[(k + 2) % 3];
        f.outward[k][0] = b[1] - a[1], f.outward[k][1] = a[0] - b[0];
        for (int c = 0; c < 2; c++) f.gradient[k][c] = -f.outward[k][c] / (2.0 * f.area);
    }
    return f;
}
