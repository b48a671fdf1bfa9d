/* The warning about a type of a plug-in that lacks PDYN_ANCHORED: its forces do not sum to zero,
 * and momentum_restore takes away what they do to the momentum. */
#include "base/registry.h"
#include "sim/live_particles.h"
#include "warn_of_step.h"

#include "projdyn/vec3.h"

#include <string.h>

/* A sum of forces that is worth a warning: as an acceleration of all mass, m/s^2, and as a part of
 * the sum of their lengths, of which rounding leaves 1e-14. */
static const double max_acceleration = 1e-6, max_part = 1e-9;

/* Length of the sum of a force on all particles, N. */
static double length_of_sum(const struct pdyn_sim *sim, const double *force) {
    double sum[3] = {0};
    for (int i = 0; i < sim->objective.particles; i++) vec3_add(sum, 1.0, force + 3 * (size_t)i);
    return vec3_length(sum);
}

static double sum_of_lengths(const struct pdyn_sim *sim, const double *force) {
    double sum = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) sum += vec3_length(force + 3 * (size_t)i);
    return sum;
}

/* Whether the library has the type. Its forces sum to zero but for rounding, which is a larger part
 * of them where a matrix takes the differences of positions, as that of `bending`. */
static bool is_builtin(const pdyn_constraint_type *type) {
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t; t++)
        if (*t == type) return true;
    return false;
}

/* The constraint of rows, of a plug-in, whose forces have the largest sum, N, at the iterate.
 * Operators, whose local step needs the samples, too, are left out. Overwrites
 * sim->trial_gradient. */
static pdyn_status find_unbalanced(struct pdyn_sim *sim, const struct batch **out,
                                   double *largest) {
    const struct objective *objective = &sim->objective;
    double *force = sim->trial_gradient;
    pdyn_status status = PDYN_OK;
    *out = NULL, *largest = 0.0;
    for (int b = 0; b < sim->constraints && status == PDYN_OK; b++) {
        if (objective->batch[b]->op || is_builtin(objective->batch[b]->type)) continue;
        memset(force, 0, objective_bytes(objective));
        status = batch_local(objective->batch[b], sim->x_next, force);
        double sum = length_of_sum(sim, force);
        bool rounded = sum <= max_part * sum_of_lengths(sim, force);
        if (sum > *largest && !rounded) *largest = sum, *out = objective->batch[b];
    }
    return status;
}

pdyn_status warn_of_momentum(struct pdyn_sim *sim) {
    const struct batch *found;
    double sum;
    if (sim->anchored || length_of_sum(sim, sim->gradient) <= max_acceleration * live_mass(sim))
        return PDYN_OK;
    pdyn_status status = find_unbalanced(sim, &found, &sum);
    if (status != PDYN_OK || !found) return status;
    struct warning *w = sim_warning(sim, WARNING_MOMENTUM, found->view.body->name, 1, sum);
    warnings_say(sim->context, w,
                 "in %ld of %ld steps the forces of \"%s\" do not sum to zero, but to up to %.3g "
                 "N, and the step takes their sum away: the type needs PDYN_ANCHORED, or has a "
                 "fault that \"projdyn check --conformance\" finds",
                 w->count, sim->steps + 1, found->type->name, w->worst);
    return PDYN_OK;
}
