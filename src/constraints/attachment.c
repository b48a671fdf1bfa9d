/* Springs or strings from chosen vertices of a body to the surface of another body: seams, loads.
 * A spring ends at the surface point closest to its vertex at rest, with barycentric coordinates
 * w_k in a triangle of corners y_k:
 *
 *     u = x - sum_k w_k y_k,     p = l u / |u|,     E = stiffness/2 (|u| - l)^2
 *
 * The rest length l is "length" times the distance at rest. With "tension_only" p = u where
 * |u| < l: the string is slack, without energy and force. */
#include "projdyn/closest3.h"
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

struct params {
    pdyn_other to;
    pdyn_vertices vertices;
    double stiffness, length, damping;
    bool tension_only;
};

static const pdyn_param params[] = {
    {"to", PDYN_OTHER, offsetof(struct params, to), true, 0, 0, 0, "",
     "the body at the other ends of the springs"},
    {"vertices", PDYN_VERTICES, offsetof(struct params, vertices), true, 0, 0, 0, "",
     "the points of this body where springs begin"},
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), true, 0, 0, 1e15, "N/m",
     "of each spring: force per change of its length"},
    {"length", PDYN_REAL, offsetof(struct params, length), false, 1, 0, 1e3, "1",
     "of a spring at rest, over the distance at the start; 0 pulls together, as a seam"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "force = stiffness (change of length + damping x its rate)"},
    {"tension_only", PDYN_BOOL, offsetof(struct params, tension_only), false, 0, 0, 0, "",
     "a string: no force where it is shorter than at rest; damping acts while it gets longer"},
    {0}};

/* The data of an element, m. The larger one is the length of p. */
struct length {
    double slack; /* up to here a string is slack, also that of the damper; 0 of a spring */
    double rest;  /* l; of the damper, the length at the base of the step */
};

enum { WIDTH = 4 }; /* entries of a row: the vertex, the three corners of the triangle */

static int elements(const void *par, const pdyn_body *body) {
    (void)body;
    return ((const struct params *)par)->vertices.count;
}

/* Returns the triangle of `body` closest to x at rest, the barycentric coordinates w of the closest
 * point and its distance in m. */
static int closest_triangle(const pdyn_body *body, const double *x, double w[3], double *distance) {
    double best = INFINITY, trial[3];
    int closest = 0;
    for (int t = 0; t < body->triangles; t++) {
        const int *c = body->triangle + 3 * t;
        const double *const corner[3] = {body->rest + 3 * c[0], body->rest + 3 * c[1],
                                         body->rest + 3 * c[2]};
        double d = closest3_triangle(x, corner, trial);
        if (!(d < best)) continue;
        best = d, closest = t;
        for (int k = 0; k < 3; k++) w[k] = trial[k];
    }
    *distance = sqrt(best);
    return closest;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    const pdyn_body *other = q->to.body;
    for (int e = first; e < last; e++) {
        int own = q->vertices.index[e], *column = b->column + WIDTH * e;
        double w[3] = {1.0}, distance, *coefficient = b->coefficient + WIDTH * e;
        int t = closest_triangle(other, b->body->rest + 3 * own, w, &distance);
        column[0] = b->body->first + own, coefficient[0] = 1.0;
        for (int k = 0; k < 3; k++) {
            column[1 + k] = other->first + other->triangle[3 * t + k];
            coefficient[1 + k] = -w[k];
        }
        double rest = q->length * distance;
        ((struct length *)b->data)[e] = (struct length){q->tension_only ? rest : 0.0, rest};
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

/* The length of p, m, unless the element is slack. */
static double length_of(const pdyn_batch *b, int e) {
    const struct length *d = (const struct length *)b->data + e;
    return fmax(d->slack, d->rest);
}

static bool is_slack(const struct params *q, const pdyn_batch *b, int e) {
    return q->tension_only && vec3_length(b->u + 3 * (size_t)e) < length_of(b, e);
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        if (is_slack(par, b, e)) memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *b->p);
        else vec3_project_length(b->p + 3 * e, b->u + 3 * e, length_of(b, e));
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    static const double identity[] = {0.0, 0.0, 0.0, 1.0};
    for (int e = first; e < last; e++, axis += 4)
        if (is_slack(par, b, e)) memcpy(axis, identity, sizeof identity);
        else vec3_axis_length(axis, b->u + 3 * e, length_of(b, e));
}

static bool one_sided(const void *par) { return ((const struct params *)par)->tension_only; }

static double damping(const void *par) { return ((const struct params *)par)->damping; }

static void damping_rest(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        ((struct length *)b->data)[e].rest = vec3_length(b->u + 3 * e);
}

const pdyn_constraint_type pdyn_constraint_attachment = {
    .name = "attachment",
    .summary = "springs or strings from chosen points to the surface of another body",
    .flags = PDYN_ON_SURFACE | PDYN_SEVERAL,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct length),
    .elements = elements,
    .rows = 1,
    .width = WIDTH,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent_rank1 = tangent,
    .damping = damping,
    .damping_rest = damping_rest,
    .one_sided = one_sided,
};
