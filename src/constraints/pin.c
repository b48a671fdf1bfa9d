/* Holds points at their rest position or moves them along a given path: u = x_i,
 *
 *     p = pivot + R(t) (rest - pivot) + d(t),     J = 0,     E = w/2 |u - p|^2
 *
 * d: "path", R: rotation by the three angles of "turn", w: "stiffness". */
#include "projdyn/path.h"
#include "projdyn/vec3.h"

struct params {
    pdyn_vertices vertices;
    double stiffness;
    pdyn_path path, turn;
    double pivot[3];
};

static const pdyn_param params[] = {
    {"vertices", PDYN_VERTICES, offsetof(struct params, vertices), true, 0, 0, 0, "",
     "the points to hold"},
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1e7, 0, 1e15, "N/m",
     "of the hold: force per distance of a point from its target"},
    {"path", PDYN_PATH, offsetof(struct params, path), false, 0, 0, 0, "m",
     "displacement of the targets over time, linear in between"},
    {"turn", PDYN_PATH, offsetof(struct params, turn), false, 0, 0, 0, "degrees",
     "turns of the targets over time, about x, then y, then z, through the pivot"},
    {"pivot", PDYN_VECTOR, offsetof(struct params, pivot), false, 0, -1e6, 1e6, "m",
     "centre of the turns; the targets are turned first, then displaced"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)body;
    return ((const struct params *)par)->vertices.count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++)
        b->column[e] = b->body->first + q->vertices.index[e], b->coefficient[e] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    double displacement[3], degrees[3], R[9], arm[3], turned[3];
    path_at(&q->path, b->time, displacement), path_at(&q->turn, b->time, degrees);
    vec3_rotation(R, degrees);
    for (int e = first; e < last; e++) {
        vec3_subtract(arm, b->body->rest + 3 * (size_t)q->vertices.index[e], q->pivot);
        vec3_multiply(turned, R, arm);
        for (int a = 0; a < 3; a++) b->p[3 * e + a] = q->pivot[a] + turned[a] + displacement[a];
    }
}

const pdyn_constraint_type pdyn_constraint_pin = {
    .name = "pin",
    .summary = "holds points where they rest, or moves and turns them as given",
    .flags = PDYN_ON_SURFACE | PDYN_ANCHORED | PDYN_REACTION | PDYN_SEVERAL,
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .rows = 1,
    .width = 1,
    .select = select,
    .weight = weight,
    .project = project,
};
