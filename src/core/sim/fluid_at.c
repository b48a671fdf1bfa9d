/* The fluid at a place, from its particles at the end of the last step. The fit of a quantity f
 *
 *     min over f_0, g of sum_i w_i (f_0 + g . d_i - f_i)^2,    d_i = x_i - x,
 *     w_i = (1 - |d_i|^2 / R^2)^3,                             R: radius
 *
 * gives f_0 at x. With means < > by the weights: c = <d>, C = <d d'> - c c', and
 * f_0 = <f> - c . C^-1 (<f d> - <f> c). C gets `ridge` R^2 on its diagonal, so that in a direction
 * along which the particles do not extend the mean is taken. */
#include "fluid_at.h"

#include "base/bad_call.h"
#include "live_particles.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

static const double ridge = 1e-4;
enum { LEAST_NEIGHBOURS = 4 }; /* of a fit; the mean is taken of fewer */

/* ---- the fit --------------------------------------------------------------------------------- */

struct fit { /* sums over the particles, lengths in units of the radius */
    const struct pdyn_sim *sim;
    const double *at;
    double radius;
    int count;
    double weight, first[3], second[9];
    double value[FLUID_VALUES], moment[FLUID_VALUES][3];
};

static void add_particle(void *user, int i) {
    struct fit *s = user;
    const double *x = s->sim->x + 3 * (size_t)i, *v = s->sim->v + 3 * (size_t)i;
    double d[3], w;
    for (int a = 0; a < 3; a++) d[a] = (x[a] - s->at[a]) / s->radius;
    w = 1.0 - vec3_dot(d, d);
    if (!(w > 0.0) || !particle_is_live(s->sim, i)) return;
    w = w * w * w;
    const double value[FLUID_VALUES] = {s->sim->pressure[i], v[0], v[1], v[2]};
    s->count++, s->weight += w;
    vec3_add(s->first, w, d);
    for (int a = 0; a < 3; a++) vec3_add(s->second + 3 * a, w * d[a], d);
    for (int k = 0; k < FLUID_VALUES; k++) {
        s->value[k] += w * value[k];
        vec3_add(s->moment[k], w * value[k], d);
    }
}

/* Divides the sums by the weight and evaluates the fit at `at`. */
static void evaluate(struct fit *s, double value[FLUID_VALUES]) {
    double C[9], c[3], y[3] = {0};
    for (int a = 0; a < 3; a++) c[a] = s->first[a] / s->weight;
    for (int k = 0; k < 9; k++)
        C[k] = s->second[k] / s->weight - c[k / 3] * c[k % 3] + (k % 4 == 0 ? ridge : 0.0);
    if (s->count >= LEAST_NEIGHBOURS) vec3_solve(y, C, c);
    for (int k = 0; k < FLUID_VALUES; k++) {
        double mean = s->value[k] / s->weight;
        value[k] = mean * (1.0 + vec3_dot(y, c)) - vec3_dot(y, s->moment[k]) / s->weight;
    }
    value[0] = fmax(0.0, value[0]);
}

void fluid_at_fit(const struct pdyn_sim *sim, const double *at, double radius,
                  double value[FLUID_VALUES]) {
    struct fit fit = {.sim = sim, .at = at, .radius = radius};
    memset(value, 0, FLUID_VALUES * sizeof *value);
    if (!sim->forces_known || !sim->objective.neighbours) return;
    neighbours_visit(sim->objective.neighbours, at, radius, add_particle, &fit);
    if (fit.count) evaluate(&fit, value);
}

/* ---- the free surface ------------------------------------------------------------------------ */

/* The column above a place: particles closer to its axis than a spacing, of which each is less than
 * GAP spacings above the one below. */
#define GAP 1.5

struct column {
    const struct pdyn_sim *sim;
    const double *at;
    double up[3], spacing;
    double level, top; /* m, above `at`: the particle reached so far, the highest one in reach */
};

static void climb(void *user, int i) {
    struct column *c = user;
    double d[3];
    vec3_subtract(d, c->sim->x + 3 * (size_t)i, c->at);
    double height = vec3_dot(d, c->up);
    vec3_add(d, -height, c->up);
    if (vec3_length(d) < c->spacing && height > c->top && height < c->level + GAP * c->spacing &&
        particle_is_live(c->sim, i))
        c->top = height;
}

double fluid_at_height(const struct pdyn_sim *sim, const double *at) {
    const double *g = sim->scene.settings.gravity, size = vec3_length(g);
    double spacing = sim_spacing(sim);
    if (!sim->forces_known || spacing == 0.0 || size == 0.0) return 0.0;
    struct column c = {sim, at, {-g[0] / size, -g[1] / size, -g[2] / size}, spacing, 0.0, 0.0};
    do {
        double x[3] = {at[0], at[1], at[2]};
        c.level = c.top;
        vec3_add(x, c.level + 0.5 * GAP * c.spacing, c.up);
        neighbours_visit(sim->objective.neighbours, x, GAP * c.spacing, climb, &c);
    } while (c.top > c.level);
    return c.top > 0.0 ? c.top + 0.5 * c.spacing : 0.0;
}

/* ---- public functions ------------------------------------------------------------------------ */

pdyn_status pdyn_fluid_at(const pdyn_sim *sim, int count, const double *x, double *pressure,
                          double *velocity) {
    if (HAS_NULL(sim) || BAD_ARRAY(x, count)) return PDYN_BAD_CALL;
    for (int k = 0; k < 3 * count; k++)
        if (!isfinite(x[k]))
            return set_error(PDYN_BAD_INPUT,
                             "pdyn_fluid_at: expected finite coordinates of point %d, found %g",
                             k / 3, x[k]);
    double spacing = sim_spacing(sim);
    for (int k = 0; k < count; k++) {
        double value[FLUID_VALUES];
        fluid_at_fit(sim, x + 3 * (size_t)k, spacing > 0.0 ? 2.0 * spacing : 1.0, value);
        if (pressure) pressure[k] = value[0];
        if (velocity) memcpy(velocity + 3 * (size_t)k, value + 1, 3 * sizeof *velocity);
    }
    return PDYN_OK;
}
