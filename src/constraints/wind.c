/* Pressure of moving air on a sheet, and drag of a sheet in air at rest. On each triangle
 *
 *     pressure = 1/2 rho drag |w_n| w_n along the normal n,     w_n = n . (wind - v)
 *
 * n and |w_n| are taken at the beginning of the step, v at its end: the drag is implicit and stable
 * for a sheet of any mass. An element is a corner u of a triangle of area A,
 *
 *     p = u + n (n . (x + h wind) - n . u),     w = 1/2 rho drag |w_n| A / (3 h),     J = I - n n'
 *
 * with the corner x at the beginning of the step: p is where the corner would be along n if it
 * moved with the air. */
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

struct params {
    double velocity[3], air_density, drag;
};

static const pdyn_param params[] = {
    {"velocity", PDYN_VECTOR, offsetof(struct params, velocity), false, 0, -1e6, 1e6, "m/s",
     "of the air"},
    {"air_density", PDYN_REAL, offsetof(struct params, air_density), false, 1.2, 0, 1e4, "kg/m^3",
     "of the air"},
    {"drag", PDYN_REAL, offsetof(struct params, drag), false, 1.2, 0, 1e3, "1",
     "pressure on the sheet over 1/2 air_density w^2, w the speed of the air across it"},
    {0}};

struct corner_wind {   /* data of an element, set at the beginning of a step */
    double normal[3];  /* unit normal n; 0 before the first step and for a triangle without area */
    double target;     /* n . (x + h wind), m */
    double resistance; /* 1/2 rho drag |w_n| A / 3: force on a corner over its speed along n
                          relative to the air, N s/m */
};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return 3 * body->triangles;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int c = first; c < last; c++)
        b->column[c] = b->body->first + b->body->triangle[c], b->coefficient[c] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int c = first; c < last; c++)
        b->weight[c] = ((const struct corner_wind *)b->data)[c].resistance / b->h;
}

/* u: positions, p: velocities of the corners at the beginning of the step. */
static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int c = first; c < last; c++) {
        struct corner_wind *d = (struct corner_wind *)b->data + c;
        const double *x = b->u + 9 * (c / 3), *v = b->p + 9 * (c / 3); /* of the triangle */
        vec3_normal(d->normal, x, x + 3, x + 6);
        double area = 0.5 * vec3_normalise(d->normal), wind = vec3_dot(d->normal, q->velocity);
        double speed = 0.0; /* w_n at the centroid, m/s */
        for (int k = 0; k < 3; k++) speed += (wind - vec3_dot(d->normal, v + 3 * k)) / 3.0;
        d->target = vec3_dot(d->normal, b->u + 3 * c) + b->h * wind;
        d->resistance = 0.5 * q->air_density * q->drag * area * fabs(speed) / 3.0;
    }
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int c = first; c < last; c++) {
        const struct corner_wind *d = (const struct corner_wind *)b->data + c;
        double behind = d->target - vec3_dot(d->normal, b->u + 3 * c);
        for (int k = 0; k < 3; k++) b->p[3 * c + k] = b->u[3 * c + k] + behind * d->normal[k];
    }
}

static void tangent_rank1(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    (void)par;
    for (int c = first; c < last; c++, axis += 4) {
        memcpy(axis, ((const struct corner_wind *)b->data)[c].normal, 3 * sizeof *axis);
        axis[3] = 1.0;
    }
}

const pdyn_constraint_type pdyn_constraint_wind = {
    .name = "wind",
    .summary = "pressure of the air on a sheet: wind, and drag in air at rest",
    .flags = PDYN_ON_SURFACE | PDYN_ANCHORED | PDYN_LOSSY,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct corner_wind),
    .elements = elements,
    .rows = 1,
    .width = 1,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent_rank1 = tangent_rank1,
    .begin = begin,
};
