/* A magnet: an energy that is not w/2 |u - p|^2. It attracts each point u of a body, at the
 * distance r from its place, with the force k / r^2 beyond its radius a:
 *
 *     E = k / a - k / sqrt(r^2 + a^2),     p = u - dE/du / w,     w = k / a^3
 *
 * w is the second derivative of E at r = 0. Such a p is the end of a step along the gradient (Liu,
 * Bouaziz and Kavan 2017). The tangent is that of PDYN_NUMERIC_TANGENT.
 *
 *     cc -shared -fPIC -Iinclude -o magnet.so magnet.c -lm
 *     projdyn check --conformance ./magnet.so
 *     projdyn run magnet.json --allow-plugins */
#include <projdyn/module.h>
#include <projdyn/vec3.h>

#include <math.h>

struct params {
    double place[3], strength, radius;
};

static const pdyn_param params[] = {
    {"place", PDYN_VECTOR, offsetof(struct params, place), false, 0, -1e6, 1e6, "m",
     "where the magnet is"},
    {"strength", PDYN_REAL, offsetof(struct params, strength), true, 0, 0, 1e9, "N m^2",
     "k: the force on a point far away is k / distance^2"},
    {"radius", PDYN_REAL, offsetof(struct params, radius), false, 0.1, 1e-3, 1e3, "m",
     "a: nearer than this the force falls to 0"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    for (int e = first; e < last; e++) b->weight[e] = q->strength / pow(q->radius, 3.0);
}

/* sqrt(r^2 + a^2), m */
static double softened(const struct params *q, const double *u) {
    return hypot(vec3_distance(u, q->place), q->radius);
}

/* dE/du = k (u - place) / softened^3 */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    for (int e = first; e < last; e++) {
        const double *u = b->u + 3 * e;
        double part = pow(q->radius / softened(q, u), 3.0);
        for (int k = 0; k < 3; k++) b->p[3 * e + k] = u[k] - part * (u[k] - q->place[k]);
    }
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    double sum = 0.0;
    for (int e = first; e < last; e++)
        sum += q->strength * (1.0 / q->radius - 1.0 / softened(q, b->u + 3 * e));
    return sum;
}

static const pdyn_constraint_type type = {
    .name = "magnet",
    .summary = "attracts points to a place",
    .flags = PDYN_ANCHORED | PDYN_NUMERIC_TANGENT,
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .rows = 1,
    .width = 1,
    .select = select_rows,
    .weight = weight,
    .project = project,
    .energy = energy,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "magnet", types, NULL};
