/* A sphere that moves along a path and keeps the points of a body outside. A point inside is one
 * row u = x; its projection is the closest point on the sphere,
 *
 *     p = c + R n,   n = (u - c) / |u - c|,   J = R / |u - c| (I - n n'), clamped to I - n n'.
 *
 * Elements come and go: `update` looks in every local step which points are inside. */
#include <projdyn/module.h>
#include <projdyn/path.h>
#include <projdyn/vec3.h>

struct params {
    pdyn_path centre;
    double radius, stiffness;
};

static const pdyn_param params[] = {{"centre", PDYN_PATH, offsetof(struct params, centre), true, 0,
                                     0, 0, "m", "where the sphere is over time"},
                                    {"radius", PDYN_REAL, offsetof(struct params, radius), false,
                                     0.2, 1e-9, 1e6, "m", "of the sphere"},
                                    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness),
                                     false, 1e4, 0, 1e12, "N/m", "of each point that is inside"},
                                    {0}};

/* The data of an element is the number of its point in the system. */
static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    const struct params *q = (const struct params *)par;
    double centre[3];
    int count = 0;
    (void)v;
    path_at(&q->centre, b->time, centre);
    for (int i = b->body->first; i < b->body->first + b->body->count; i++) {
        if (vec3_distance(x + 3 * i, centre) >= q->radius) continue;
        if (count < room) ((int *)b->data)[count] = i;
        count++;
    }
    return count;
}

static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        b->column[e] = ((const int *)b->data)[e], b->coefficient[e] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

/* The direction of a point from the centre, length 1; upwards for the centre itself. */
static void direction(const double *u, const double centre[3], double n[3]) {
    double d = vec3_distance(u, centre);
    for (int a = 0; a < 3; a++) n[a] = d > 0.0 ? (u[a] - centre[a]) / d : a == 1;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    double centre[3], n[3];
    path_at(&q->centre, b->time, centre);
    for (int e = first; e < last; e++) {
        direction(b->u + 3 * e, centre, n);
        for (int a = 0; a < 3; a++) b->p[3 * e + a] = centre[a] + q->radius * n[a];
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    double centre[3];
    path_at(&((const struct params *)par)->centre, b->time, centre);
    for (int e = first; e < last; e++, axis += 4)
        direction(b->u + 3 * e, centre, axis), axis[3] = 1.0;
}

static const pdyn_constraint_type type = {
    .name = "sphere",
    .summary = "keeps points outside of a sphere that moves",
    .flags = PDYN_ANCHORED | PDYN_ONE_SIDED | PDYN_EVERY_ITERATION,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(int),
    .update = update,
    .rows = 1,
    .width = 1,
    .select = select_rows,
    .weight = weight,
    .project = project,
    .tangent_rank1 = tangent,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "sphere", types, NULL};
