/* Points that are held where they rest, or follow a given path: p is the target, J = 0. */
#include "projdyn/module.h"

struct params {
    pdyn_vertices vertices;
    double stiffness;
    pdyn_path path;
};

static const pdyn_param params[] = {
    {"vertices", PDYN_VERTICES, offsetof(struct params, vertices), true, 0, 0, 0, "",
     "the points to hold"},
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1e7, 0, 1e15, "N/m",
     "of the hold: force per distance of a point from its target"},
    {"path", PDYN_PATH, offsetof(struct params, path), false, 0, 0, 0, "s, m",
     "displacement of the targets over time: [t, dx, dy, dz], linear in between"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)body;
    return ((const struct params *)par)->vertices.count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++) {
        b->column[e] = b->body->first + q->vertices.index[e];
        b->coefficient[e] = 1.0;
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

static void displacement(const pdyn_path *path, double time, double d[3]) {
    const double *key = path->key;
    int k = 0;
    while (k < path->count && key[4 * k] <= time) k++;
    for (int a = 0; a < 3; a++) {
        const double *left = key + 4 * (k ? k - 1 : 0),
                     *right = key + 4 * (k < path->count ? k : k - 1);
        double t = right[0] > left[0] ? (time - left[0]) / (right[0] - left[0]) : 0.0;
        d[a] = left[1 + a] + t * (right[1 + a] - left[1 + a]);
    }
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    double d[3] = {0};
    if (q->path.count) displacement(&q->path, b->time, d);
    for (int e = first; e < last; e++)
        for (int a = 0; a < 3; a++)
            b->p[3 * e + a] = b->body->rest[3 * q->vertices.index[e] + a] + d[a];
}

const pdyn_constraint_type pdyn_constraint_pin = {
    .name = "pin",
    .summary = "holds points where they rest or moves them along a path",
    .flags = PDYN_ON_SURFACE | PDYN_ANCHORED | PDYN_REACTION,
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .rows = 1,
    .width = 1,
    .select = select,
    .weight = weight,
    .project = project,
};
