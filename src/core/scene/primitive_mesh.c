/* Triangle meshes of spheres, capsules, planes and boxes. */
#include "primitive_mesh.h"

#include "params.h"

#include "projdyn/vec3.h"

#include <string.h>

/* Computes two unit vectors u and v perpendicular to axis; (axis, u, v) is right-handed. Normalises
 * axis. */
static void across(double axis[3], double u[3], double v[3]) {
    int smallest = 0;
    double length = vec3_length(axis), other[3] = {0};
    for (int a = 0; a < 3; a++) {
        axis[a] /= length;
        if (fabs(axis[a]) < fabs(axis[smallest])) smallest = a;
    }
    other[smallest] = 1.0;
    vec3_cross(u, axis, other);
    length = vec3_length(u);
    for (int a = 0; a < 3; a++) u[a] /= length;
    vec3_cross(v, axis, u);
}

/* ---- capsules: rings around an axis, from pole to pole --------------------------------------- */

enum { LEAST_AROUND = 24, MOST_AROUND = 64 }; /* points of a ring, a multiple of 4 */

/* With n points around the axis, and as far apart along it, the vertices of a sphere of radius r
 * are up to r (pi/n)^2 outside its triangles. */
static int points_around(double radius, double bump) {
    double points = acos(-1.0) * sqrt(radius / fmax(bump, 1e-9 * radius));
    return 4 * (int)ceil(0.25 * fmin(fmax(points, LEAST_AROUND), MOST_AROUND));
}

/* Places the first `points` of `around` points of a ring around the centre, at an angle from the
 * pole. */
static void place_ring(const double center[3], double radius, const double axes[9], double angle,
                       int around, int points, double *x) {
    double step = 2.0 * acos(-1.0) / around;
    for (int k = 0; k < points; k++, x += 3) {
        memcpy(x, center, 3 * sizeof *x);
        vec3_add(x, radius * sin(angle) * cos(k * step), axes);
        vec3_add(x, radius * sin(angle) * sin(k * step), axes + 3);
        vec3_add(x, -radius * cos(angle), axes + 6);
    }
}

/* Triangles between a pole and the ring that begins at vertex `ring`. */
static int *close_pole(int pole, int ring, int around, bool first, int *triangle) {
    for (int k = 0; k < around; k++, triangle += 3) {
        int a = ring + k, b = ring + (k + 1) % around;
        triangle[0] = pole, triangle[1] = first ? b : a, triangle[2] = first ? a : b;
    }
    return triangle;
}

static int *join_rings(int below, int around, int *triangle) {
    for (int k = 0; k < around; k++, triangle += 6) {
        int a = below + k, b = below + (k + 1) % around;
        const int two[6] = {a, b, b + around, a, b + around, a + around};
        memcpy(triangle, two, sizeof two);
    }
    return triangle;
}

pdyn_status primitive_capsule(pdyn_context *context, const double from[3], const double to[3],
                              double radius, double bump, struct mesh *out) {
    double axes[9] = {[6] = to[0] - from[0], [7] = to[1] - from[1], [8] = to[2] - from[2]};
    bool sphere = !(vec3_length(axes + 6) > 1e-9 * radius);
    if (sphere) memcpy(axes + 6, (const double[3]){0.0, 1.0, 0.0}, 3 * sizeof *axes);
    across(axes + 6, axes, axes + 3);
    int around = points_around(radius, bump), quarter = around / 4;
    int rings = 2 * quarter - sphere, vertices = 2 + rings * around;
    pdyn_status status = mesh_allocate(context, vertices, 2 * rings * around, out);
    if (status != PDYN_OK) return status;
    int *triangle = close_pole(0, 1, around, true, out->triangle);
    place_ring(from, radius, axes, 0.0, around, 1, out->vertex);
    for (int r = 0; r < rings; r++) {
        bool upper = r >= quarter;
        double angle = (r + 1 - (upper && !sphere)) * 0.5 * acos(-1.0) / quarter;
        place_ring(upper ? to : from, radius, axes, angle, around, around,
                   out->vertex + 3 * (1 + (size_t)r * (size_t)around));
        if (r) triangle = join_rings(1 + (r - 1) * around, around, triangle);
    }
    place_ring(to, radius, axes, acos(-1.0), around, 1, out->vertex + 3 * ((size_t)vertices - 1));
    close_pole(vertices - 1, vertices - 1 - around, around, false, triangle);
    return PDYN_OK;
}

/* ---- planes and boxes ------------------------------------------------------------------------ */

pdyn_status primitive_plane(pdyn_context *context, const double center[3], const double normal[3],
                            double size, struct mesh *out) {
    static const int triangle[6] = {0, 1, 2, 0, 2, 3};
    double axis[3] = {normal[0], normal[1], normal[2]}, u[3], v[3];
    across(axis, u, v);
    pdyn_status status = mesh_allocate(context, 4, 2, out);
    if (status != PDYN_OK) return status;
    memcpy(out->triangle, triangle, sizeof triangle);
    for (int k = 0; k < 4; k++) {
        memcpy(out->vertex + 3 * k, center, 3 * sizeof *center);
        vec3_add(out->vertex + 3 * k, (k == 1 || k == 2 ? 0.5 : -0.5) * size, u);
        vec3_add(out->vertex + 3 * k, (k >= 2 ? 0.5 : -0.5) * size, v);
    }
    return PDYN_OK;
}

/* Corner k is at the maximum of axis a if bit a of k is set. */
pdyn_status primitive_box(pdyn_context *context, const struct box *box, unsigned open,
                          struct mesh *out) {
    int faces = 0, *triangle;
    for (int side = 0; side < 6; side++) faces += !(open >> side & 1u);
    pdyn_status status = mesh_allocate(context, 8, 2 * faces, out);
    if (status != PDYN_OK) return status;
    for (int k = 0; k < 24; k++)
        out->vertex[k] = k / 3 >> k % 3 & 1 ? box->max[k % 3] : box->min[k % 3];
    triangle = out->triangle;
    for (int side = 0; side < 6; side++) {
        int a = 1 << side / 2, b = 1 << (side / 2 + 1) % 3, c = 1 << (side / 2 + 2) % 3;
        int at = side % 2 ? a : 0, p = side % 2 ? b : c, q = side % 2 ? c : b;
        const int two[6] = {at, at + p, at + p + q, at, at + p + q, at + q};
        if (open >> side & 1u) continue;
        memcpy(triangle, two, sizeof two);
        triangle += 6;
    }
    return PDYN_OK;
}

/* ---- JSON objects ---------------------------------------------------------------------------- */

struct shape { /* keys of all primitives */
    double center[3], from[3], to[3], normal[3], radius, size;
};

#define VECTOR(name, unit)                                                                         \
    { #name, PDYN_VECTOR, offsetof(struct shape, name), true, 0, -1e6, 1e6, unit, "" }
#define LENGTH(name)                                                                               \
    { #name, PDYN_REAL, offsetof(struct shape, name), true, 0, 1e-6, 1e6, "m", "" }

pdyn_status primitive_read_sphere(const struct json_at *at, double bump, struct mesh *mesh,
                                  double middle[3]) {
    static const pdyn_param table[] = {VECTOR(center, "m"), LENGTH(radius), {0}};
    struct shape shape;
    pdyn_status status = params_read_object(at, table, &shape);
    if (status != PDYN_OK) return status;
    memcpy(middle, shape.center, sizeof shape.center);
    return primitive_capsule(at->file->context, shape.center, shape.center, shape.radius, bump,
                             mesh);
}

pdyn_status primitive_read_capsule(const struct json_at *at, double bump, struct mesh *mesh,
                                   double middle[3]) {
    static const pdyn_param table[] = {VECTOR(from, "m"), VECTOR(to, "m"), LENGTH(radius), {0}};
    struct shape shape;
    pdyn_status status = params_read_object(at, table, &shape);
    if (status != PDYN_OK) return status;
    for (int a = 0; a < 3; a++) middle[a] = 0.5 * (shape.from[a] + shape.to[a]);
    return primitive_capsule(at->file->context, shape.from, shape.to, shape.radius, bump, mesh);
}

pdyn_status primitive_read_plane(const struct json_at *at, double bump, struct mesh *mesh,
                                 double middle[3]) {
    static const pdyn_param table[] = {VECTOR(center, "m"), VECTOR(normal, "1"), LENGTH(size), {0}};
    struct json_at normal = json_member(at, "normal");
    struct shape shape;
    (void)bump;
    pdyn_status status = params_read_object(at, table, &shape);
    if (status != PDYN_OK) return status;
    if (!(vec3_length(shape.normal) > 1e-12))
        return json_expected(&normal, "a direction that is not 0");
    memcpy(middle, shape.center, sizeof shape.center);
    return primitive_plane(at->file->context, shape.center, shape.normal, shape.size, mesh);
}
