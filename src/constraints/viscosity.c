/* Viscosity of a fluid: a dashpot between every two particles closer than two spacings, along the
 * line between them (Monaghan 1992; implicit: Weiler, Koschier, Brand, Bender 2018),
 *
 *     E = c / (2 h) (|u| - l)^2,    u = x_i - x_j,    l: |u| at the base of the step
 *     c = 2.161 mu d f(|u| / 2d),   f(q) = (1 - q)(7/4 - q)
 *
 * so its force at the end of a step is c d|u|/dt. A motion without strain has no force, and linear
 * and angular momentum are exact. mu: Pa s; d: particle spacing; |u| in c: when the step begins.
 * docs/theory/viscosity.md derives c. */
#include "listed_points.h"

struct params {
    double viscosity; /* mu, Pa s */
};

static const pdyn_param params[] = {
    {"viscosity", PDYN_REAL, offsetof(struct params, viscosity), true, 0, 0, 1e9, "Pa s",
     "dynamic viscosity: water 0.001, oil 0.1, honey 10, pitch 1e8"},
    {0}};

struct dashpot {
    double length;      /* l, m */
    double coefficient; /* c, N s/m */
    double start[3];    /* m: u when the step begins */
    int particle[2];
};

static struct dashpot *dashpots(const pdyn_batch *b) { return b->data; }

/* 30 d^5 over the integral of f |u|^2 over the ball of radius 2d: in a continuum, the power of the
 * dashpots in a shear is that of mu. */
static const double amplitude = 2.161;

static double coefficient_at(double mu, double spacing, double distance) {
    double q = distance / (2.0 * spacing);
    return amplitude * mu * spacing * (1.0 - q) * (1.75 - q);
}

static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    const pdyn_neighbours *l = b->neighbours;
    double mu = ((const struct params *)par)->viscosity, spacing = 2.0 * b->body->radius;
    int count = 0;
    (void)v;
    for (int i = b->body->first; mu > 0.0 && i < b->body->first + b->body->count; i++)
        for (int k = l->start[i]; k < l->surface_start[i]; k++) {
            int j = l->index[k];
            double u[3];
            if (j <= i || !body_has(b->body, j)) continue;
            vec3_subtract(u, x + 3 * (size_t)i, x + 3 * (size_t)j);
            double distance = vec3_length(u);
            if (distance >= 2.0 * spacing || count++ >= room) continue;
            dashpots(b)[count - 1] =
                (struct dashpot){.coefficient = coefficient_at(mu, spacing, distance),
                                 .start = {u[0], u[1], u[2]},
                                 .particle = {i, j}};
        }
    return count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        for (int k = 0; k < 2; k++) {
            b->column[2 * e + k] = dashpots(b)[e].particle[k];
            b->coefficient[2 * e + k] = k ? -1.0 : 1.0;
        }
}

/* Extrapolates the length |u| to the base: the length of the extrapolated vector would be too large
 * where u rotates. */
static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    double part = b->extrapolation;
    for (int e = first; e < last; e++) {
        struct dashpot *d = dashpots(b) + e;
        double before[3], length = vec3_length(d->start);
        for (int a = 0; a < 3; a++)
            before[a] = d->start[a] - (part > 0.0 ? (b->u[3 * e + a] - d->start[a]) / part : 0.0);
        d->length = fmax(0.0, length + part * (length - vec3_length(before)));
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = dashpots(b)[e].coefficient / b->h;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        vec3_project_length(b->p + 3 * e, b->u + 3 * e, dashpots(b)[e].length);
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4)
        vec3_axis_length(axis, b->u + 3 * e, dashpots(b)[e].length);
}

const pdyn_constraint_type pdyn_constraint_viscosity = {
    .name = "viscosity",
    .summary = "viscosity of a fluid, from water to honey",
    .flags = PDYN_ON_PARTICLES | PDYN_NEIGHBOURS | PDYN_LOSSY,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct dashpot),
    .update = update,
    .rows = 1,
    .width = 2,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent_rank1 = tangent,
    .begin = begin,
};
