/* Wind on a sheet, and its drag in air at rest: on each triangle the pressure
 *
 *     1/2 rho drag |w_n| w_n,   w_n = n . (wind - v),
 *
 * along its normal n. n and |w_n| are those of the beginning of the step, v is that of its end: so
 * drag is stable on the lightest sheet. u are the corners; the projection moves each along n to
 * where it would be if it went with the wind. The weight is what pushes a corner, per speed and
 * step. */
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

struct air {
    double normal[3]; /* of length 1; 0 before the first step */
    double with[3];   /* m: where each corner would be along the normal, if it went with the wind */
    double push;      /* N s/m: force on a corner over its speed across the air */
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
    for (int t = first; t < last; t++) b->weight[t] = ((const struct air *)b->data)[t].push / b->h;
}

/* p are the velocities of the corners. */
static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int t = first; t < last; t++) {
        const double *x = b->u + 9 * t, *v = b->p + 9 * t;
        struct air *air = (struct air *)b->data + t;
        double side[3], other[3], speed = 0.0;
        for (int k = 0; k < 3; k++) side[k] = x[3 + k] - x[k], other[k] = x[6 + k] - x[k];
        vec3_cross(air->normal, side, other);
        double twice = vec3_length(air->normal), wind = 0.0;
        for (int k = 0; k < 3; k++) air->normal[k] = twice > 0.0 ? air->normal[k] / twice : 0.0;
        wind = vec3_dot(air->normal, q->velocity);
        for (int c = 0; c < 3; c++) {
            speed += (wind - vec3_dot(air->normal, v + 3 * c)) / 3.0;
            air->with[c] = vec3_dot(air->normal, x + 3 * c) + b->h * wind;
        }
        air->push = 0.5 * q->air_density * q->drag * (0.5 * twice) * fabs(speed) / 3.0;
    }
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int r = 3 * first; r < 3 * last; r++) {
        const struct air *air = (const struct air *)b->data + r / 3;
        double behind = air->with[r % 3] - vec3_dot(air->normal, b->u + 3 * r);
        for (int k = 0; k < 3; k++) b->p[3 * r + k] = b->u[3 * r + k] + behind * air->normal[k];
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int t = first; t < last; t++, J += 81) {
        const double *n = ((const struct air *)b->data)[t].normal;
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
    .data_size = sizeof(struct air),
    .elements = elements,
    .rows = 3,
    .width = 1,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .begin = begin,
};
