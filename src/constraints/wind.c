/* Pressure of moving air on a sheet, and drag of a sheet in air at rest. On each triangle
 *
 *     pressure = 1/2 rho drag |w_n| w_n along the normal n,     w_n = n . (wind - v)
 *
 * n and |w_n| are taken at the beginning of the step, v at its end: the drag is implicit and stable
 * for a sheet of any mass. u: the three corners x_c of a triangle of area A,
 *
 *     p_c = u_c + n (n . (x_c + h wind) - n . u_c),     w = 1/2 rho drag |w_n| A / (3 h)
 *
 * with x_c at the beginning of the step: p_c is where the corner would be along n if it moved with
 * the air. J = I - n n' for each corner. */
#include "projdyn/module.h"
#include "projdyn/vec3.h"

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

struct triangle_wind { /* data of an element, set at the beginning of a step */
    double normal[3];  /* unit normal n; 0 before the first step and for a triangle without area */
    double target[3];  /* n . (x_c + h wind) for each corner c, m */
    double resistance; /* 1/2 rho drag |w_n| A / 3: force on a corner over its speed along n
                          relative to the air, N s/m */
};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->triangles;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++)
        b->column[k] = b->body->first + b->body->triangle[k], b->coefficient[k] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int t = first; t < last; t++)
        b->weight[t] = ((const struct triangle_wind *)b->data)[t].resistance / b->h;
}

/* u: positions, p: velocities of the corners at the beginning of the step. */
static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int t = first; t < last; t++) {
        const double *x = b->u + 9 * t, *v = b->p + 9 * t;
        struct triangle_wind *d = (struct triangle_wind *)b->data + t;
        vec3_normal(d->normal, x, x + 3, x + 6);
        double area = 0.5 * vec3_normalise(d->normal), wind = vec3_dot(d->normal, q->velocity);
        double speed = 0.0; /* w_n at the centroid, m/s */
        for (int c = 0; c < 3; c++) {
            speed += (wind - vec3_dot(d->normal, v + 3 * c)) / 3.0;
            d->target[c] = vec3_dot(d->normal, x + 3 * c) + b->h * wind;
        }
        d->resistance = 0.5 * q->air_density * q->drag * area * fabs(speed) / 3.0;
    }
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int r = 3 * first; r < 3 * last; r++) {
        const struct triangle_wind *d = (const struct triangle_wind *)b->data + r / 3;
        double behind = d->target[r % 3] - vec3_dot(d->normal, b->u + 3 * r);
        for (int k = 0; k < 3; k++) b->p[3 * r + k] = b->u[3 * r + k] + behind * d->normal[k];
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int t = first; t < last; t++, J += 81) {
        const double *n = ((const struct triangle_wind *)b->data)[t].normal;
        for (int c = 0; c < 9; c += 3)
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) J[9 * (c + i) + c + j] = (i == j) - n[i] * n[j];
    }
}

const pdyn_constraint_type pdyn_constraint_wind = {
    .name = "wind",
    .summary = "pressure of the air on a sheet: wind, and drag in air at rest",
    .flags = PDYN_ON_SURFACE | PDYN_ANCHORED | PDYN_LOSSY,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct triangle_wind),
    .elements = elements,
    .rows = 3,
    .width = 1,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .begin = begin,
};
