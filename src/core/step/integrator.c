/* The integrators "bdf2" and "euler". */
#include "integrator.h"

#include "scene/choices.h"
#include "sim/sim.h"

#include <string.h>

/* x^ = x_n + part (x_n - x_(n-1)), and v^ in the same way. */
static void extrapolate(struct pdyn_sim *sim, double part) {
    sim->objective.extrapolation = part;
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        sim->x_base[k] = sim->x[k] + part * (sim->x[k] - sim->x_before[k]);
        sim->v_base[k] = sim->v[k] + part * (sim->v[k] - sim->v_before[k]);
    }
}

static double begin_euler(struct pdyn_sim *sim, double h) {
    sim->objective.extrapolation = 0.0;
    memcpy(sim->x_base, sim->x, objective_bytes(&sim->objective));
    memcpy(sim->v_base, sim->v, objective_bytes(&sim->objective));
    return h;
}

/* BDF2 is zero-stable while the step length grows by less than 1 + sqrt(2) per step (Hairer,
 * Norsett, Wanner, Solving Ordinary Differential Equations I, section III.5). A step that grows
 * more is an Euler step; the method stays of second order. */
static const double max_growth = 2.0;

/* BDF2 with variable step length. */
static double begin_bdf2(struct pdyn_sim *sim, double h) {
    double w = sim->history > 0.0 ? h / sim->history : INFINITY;
    if (w > max_growth) return begin_euler(sim, h);
    extrapolate(sim, w * w / (1.0 + 2.0 * w));
    return h * (1.0 + w) / (1.0 + 2.0 * w);
}

static const struct integrator integrators[] = {
    {"bdf2", "second order; one implicit step from two states", begin_bdf2, true},
    {"euler", "first order; implicit, as published", begin_euler, false},
};
const struct choices integrator_choices = {integrators, sizeof *integrators,
                                           sizeof integrators / sizeof *integrators};

const char *pdyn_integrator(const pdyn_sim *sim) {
    return sim ? sim->scene.settings.integrator->name : "";
}
