/* Filling of a closed surface: the pressure p of a gas or a liquid inside. V is the volume that the
 * triangles enclose, V_1 the volume of the filling at the pressure p_1, s = V / V_1:
 *
 *     gas      p = p_1 s^-gamma             E = V_1 (p_1 (s^(1 - gamma) - 1) / (gamma - 1)
 *                                                    + p_outside (s - 1))
 *     liquid   p = p_1 + K (1 - s)          E = V_1 (K/2 (s - 1)^2 - (p_1 - p_outside) (s - 1))
 *
 * One element, J = I - E''(V) / w grad V grad V'. Its rows are the vertices relative to the first
 * one, u_i = x_i - x_0, so that no iterate resists translation, and
 *
 *     p_i = u_i - E'(V) / w dV/dx_i                                  docs/theory/gas.md */
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

struct params {
    double overpressure, outside, gamma, bulk_modulus, inflation;
};

static const pdyn_param params[] = {
    {"overpressure", PDYN_REAL, offsetof(struct params, overpressure), false, 0, -1e9, 1e9, "Pa",
     "of the filling at its volume, above the pressure outside"},
    {"outside", PDYN_REAL, offsetof(struct params, outside), false, 101325, 0, 1e9, "Pa",
     "pressure around the surface"},
    {"gamma", PDYN_REAL, offsetof(struct params, gamma), false, 1.4, 0, 10, "1",
     "of a gas, p V^gamma is constant: 1.4 air in fast motion, 1 at constant temperature, 0 at "
     "constant pressure"},
    {"bulk_modulus", PDYN_REAL, offsetof(struct params, bulk_modulus), false, -1, 0, 1e12, "Pa",
     "the filling is a liquid: pressure per relative decrease of its volume"},
    {"inflation", PDYN_REAL, offsetof(struct params, inflation), false, 1, 1e-3, 1e3, "1",
     "volume of the filling, in that of the surface at rest"},
    {0}};

static const char *const alternatives[] = {"gamma", "bulk_modulus", NULL};

struct filling {   /* data */
    double volume; /* V_1, m^3; negative for triangles that face inwards */
    double weight; /* w, N/m; 0 before the first step */
};

/* ---- the filling ----------------------------------------------------------------------------- */

static const double least = 0.01; /* of s; below, E goes on as a parabola and is finite */

struct law { /* E / |V_1| and its derivatives with respect to s, Pa; the slope is p_outside - p */
    double energy, slope, curvature;
};

static struct law gas_law(const struct params *q, double s) {
    double full = fmax(0.0, q->outside + q->overpressure), n = q->gamma - 1.0, log_s = log(s);
    double work = n != 0.0 ? expm1(-n * log_s) / n : -log_s;
    double pressure = full * exp(-q->gamma * log_s);
    return (struct law){full * work + q->outside * (s - 1.0), q->outside - pressure,
                        q->gamma * pressure / s};
}

static struct law law_at(const struct params *q, double s) {
    double beyond = s - (q->bulk_modulus >= 0.0 ? 1.0 : fmax(s, least));
    struct law at = {0.0, -q->overpressure, q->bulk_modulus};
    if (q->bulk_modulus < 0.0) at = gas_law(q, s - beyond);
    at.energy += beyond * (at.slope + 0.5 * beyond * at.curvature);
    at.slope += beyond * at.curvature;
    return at;
}

static pdyn_param_fault resolve(void *par, const pdyn_scene_info *scene) {
    const struct params *q = par;
    (void)scene;
    if (q->bulk_modulus >= 0.0 || q->outside + q->overpressure > 0.0)
        return (pdyn_param_fault){NULL, NULL};
    return (pdyn_param_fault){"a gas has a pressure above 0: expected more than minus \"outside\"",
                              "overpressure"};
}

/* ---- the volume ------------------------------------------------------------------------------ */

/* Returns V, m^3, of vertex 0 at `first` and the others at `x`. gradient: dV/dx of the others, m^2;
 * area: of all triangles, m^2; NULL: not wanted. */
static double volume(const pdyn_body *body, const double *first, const double *x, double *gradient,
                     double *area) {
    double sum = 0.0;
    if (gradient) memset(gradient, 0, 3 * (size_t)(body->count - 1) * sizeof *gradient);
    if (area) *area = 0.0;
    for (int t = 0; t < body->triangles; t++) {
        const int *c = body->triangle + 3 * (size_t)t;
        const double *corner[3];
        double normal[3];
        for (int k = 0; k < 3; k++) corner[k] = c[k] ? x + 3 * (size_t)(c[k] - 1) : first;
        vec3_normal(normal, corner[0], corner[1], corner[2]);
        sum += vec3_dot(corner[0], normal) / 6.0;
        if (area) *area += 0.5 * vec3_length(normal);
        for (int k = 0; gradient && k < 3; k++)
            if (c[k]) vec3_add(gradient + 3 * (size_t)(c[k] - 1), 1.0 / 6.0, normal);
    }
    return sum;
}

/* s of the rows u */
static double relative_volume(const pdyn_batch *b, double *gradient, double *area) {
    static const double origin[3];
    return volume(b->body, origin, b->u, gradient, area) / ((struct filling *)b->data)->volume;
}

/* ---- callbacks ------------------------------------------------------------------------------- */

static int elements(const void *par, const pdyn_body *body) {
    (void)par, (void)body;
    return 1;
}

static void row_sizes(const void *par, const pdyn_batch *b, int e, int *rows, int *width) {
    (void)par, (void)e;
    *rows = b->body->count - 1, *width = 2;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const pdyn_body *body = b->body;
    if (first == last) return;
    for (int k = 0; k < 2 * (body->count - 1); k++) {
        b->column[k] = body->first + (k % 2 ? 0 : 1 + k / 2);
        b->coefficient[k] = k % 2 ? -1.0 : 1.0;
    }
    double rest = volume(body, body->rest, body->rest + 3, NULL, NULL);
    *(struct filling *)b->data =
        (struct filling){((const struct params *)par)->inflation * rest, 0.0};
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    if (first < last) b->weight[0] = ((const struct filling *)b->data)->weight;
}

/* w is an upper bound of the stiffness of E: twice E'' |grad V|^2 from areas, and 3 |E'| times the
 * length of an edge for the curvature of V. */
static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    const pdyn_body *body = b->body;
    struct filling *f = b->data;
    double area, rest = 0.0, squares = 0.0;
    if (first == last) return;
    struct law at = law_at(par, relative_volume(b, NULL, &area));
    for (int i = 0; i < body->count; i++)
        rest += body->vertex_area[i], squares += body->vertex_area[i] * body->vertex_area[i];
    squares *= area * area / (rest * rest);
    f->weight = 2.0 * at.curvature / fabs(f->volume) * squares +
                3.0 * fabs(at.slope) * sqrt(area / body->triangles);
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct filling *f = b->data;
    if (first == last) return;
    double slope = law_at(par, relative_volume(b, b->p, NULL)).slope;
    double way = f->weight > 0.0 ? slope / f->weight : 0.0; /* over grad V */
    if (f->volume < 0.0) way = -way;
    for (int k = 0; k < 3 * (b->body->count - 1); k++) b->p[k] = b->u[k] - way * b->p[k];
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    const struct filling *f = b->data;
    int n = 3 * (b->body->count - 1);
    double squares = 0.0;
    if (first == last) return;
    struct law at = law_at(par, relative_volume(b, axis, NULL));
    for (int k = 0; k < n; k++) squares += axis[k] * axis[k];
    double part = f->weight > 0.0 ? at.curvature / fabs(f->volume) / f->weight : 0.0;
    double root = sqrt(part * squares > 1.0 ? 1.0 / squares : part);
    for (int k = 0; k < n; k++) axis[k] *= root;
    axis[n] = 1.0;
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    const struct filling *f = b->data;
    if (first == last) return 0.0;
    return fabs(f->volume) * law_at(par, relative_volume(b, NULL, NULL)).energy;
}

const pdyn_constraint_type pdyn_constraint_gas = {
    .name = "gas",
    .summary = "pressure of a gas or a liquid in a closed surface",
    .flags = PDYN_ON_SURFACE | PDYN_ON_CLOSED,
    .params_size = sizeof(struct params),
    .params = params,
    .alternatives = alternatives,
    .resolve = resolve,
    .data_size = sizeof(struct filling),
    .elements = elements,
    .row_sizes = row_sizes,
    .select = select,
    .weight = weight,
    .begin = begin,
    .project = project,
    .tangent_rank1 = tangent,
    .energy = energy,
};
