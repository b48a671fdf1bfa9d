/* Points that are held where they rest, or follow a given path: p is the target, J = 0. */
#include "projdyn/module.h"
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
     "what the targets turn about, before they are displaced"},
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

/* The three numbers of a path at a time; 0 without a path. */
static void along(const pdyn_path *path, double time, double d[3]) {
    const double *key = path->key;
    int k = 0;
    while (k < path->count && key[4 * k] <= time) k++;
    for (int a = 0; a < 3 && path->count; a++) {
        const double *left = key + 4 * (k ? k - 1 : 0),
                     *right = key + 4 * (k < path->count ? k : k - 1);
        double t = right[0] > left[0] ? (time - left[0]) / (right[0] - left[0]) : 0.0;
        d[a] = left[1 + a] + t * (right[1 + a] - left[1 + a]);
    }
}

/* Where the axes go by turns about x, then y, then z: rows of the matrix. */
static void matrix_of(const double degrees[3], double R[9]) {
    double c[3], s[3];
    for (int a = 0; a < 3; a++) {
        c[a] = cos(degrees[a] * acos(-1.0) / 180.0), s[a] = sin(degrees[a] * acos(-1.0) / 180.0);
    }
    R[0] = c[1] * c[2], R[1] = s[0] * s[1] * c[2] - c[0] * s[2];
    R[2] = c[0] * s[1] * c[2] + s[0] * s[2];
    R[3] = c[1] * s[2], R[4] = s[0] * s[1] * s[2] + c[0] * c[2];
    R[5] = c[0] * s[1] * s[2] - s[0] * c[2];
    R[6] = -s[1], R[7] = s[0] * c[1], R[8] = c[0] * c[1];
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    double d[3] = {0}, degrees[3] = {0}, R[9];
    along(&q->path, b->time, d);
    along(&q->turn, b->time, degrees);
    matrix_of(degrees, R);
    for (int e = first; e < last; e++) {
        const double *rest = b->body->rest + 3 * (size_t)q->vertices.index[e];
        double arm[3], turned[3];
        for (int a = 0; a < 3; a++) arm[a] = rest[a] - q->pivot[a];
        vec3_multiply(turned, R, arm);
        for (int a = 0; a < 3; a++) b->p[3 * e + a] = q->pivot[a] + turned[a] + d[a];
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
