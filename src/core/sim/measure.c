/* Accuracy and physical quantities of a step. */
#include "measure.h"

#include "live_particles.h"

#include "projdyn/vec3.h"

#include <string.h>

/* The acceleration, m/s^2, that stands for gravity where there was none. */
static const double standard_gravity = 9.81, least_gravity = 1e-3;

void measure_weights(struct pdyn_sim *sim) {
    double g = sim->control.gravity < least_gravity ? standard_gravity : sim->control.gravity;
    for (int b = 0; b < sim->objective.bodies; b++) {
        struct objective_body *body = &sim->objective.body[b];
        double sum = 0.0;
        for (int i = body->first; i < body->first + body->count; i++)
            if (particle_is_live(sim, i)) sum += sim->objective.mass[i] * sim->objective.mass[i];
        /* 1 while the body has no live particle */
        body->weight = sum > 0.0 ? g * sqrt(sum) : 1.0;
    }
}

/* Copies density and pressure of the particles from an operator. */
static void update_fluid(struct pdyn_sim *sim, const struct batch *b) {
    const pdyn_operator *op = b->op ? b->type->matrix_free : NULL;
    if (op && op->density) op->density(b->op, sim->density);
    if (op && op->pressure) op->pressure(b->op, sim->pressure);
}

pdyn_status measure_check_range(struct pdyn_sim *sim, double h) {
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        double x = sim->x_next[k], moved = fabs(x - sim->x[k]);
        if (fabs(x) <= STEP_MAX_POSITION && moved <= STEP_MAX_SPEED * h) continue; /* not NaN */
        return set_error(PDYN_DIVERGED,
                         "particle %d moves to %c = %.3g m with %.3g m/s, beyond %g m or %g m/s",
                         k / 3, "xyz"[k % 3], x, moved / h, STEP_MAX_POSITION, STEP_MAX_SPEED);
    }
    return PDYN_OK;
}

void measure_update_fluid(struct pdyn_sim *sim) {
    memcpy(sim->pressure_before, sim->pressure,
           (size_t)sim->objective.particles * sizeof *sim->pressure);
    for (int b = 0; b < sim->objective.batches; b++) update_fluid(sim, sim->objective.batch[b]);
}

static void compute_density_errors(const struct pdyn_sim *sim, pdyn_step_info *info) {
    double sum = 0.0, count = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++) {
            if (!particle_is_live(sim, i)) continue;
            double error = fmax(0.0, sim->density[i] / body->rest_density - 1.0);
            sum += error, count++;
            info->density_error_max = fmax(info->density_error_max, error);
        }
    }
    info->density_error_mean = count > 0.0 ? sum / count : 0.0;
    info->particles = (int)count;
}

static void add_energies(const struct pdyn_sim *sim, pdyn_step_info *info) {
    const struct objective *objective = &sim->objective;
    for (int i = 0; i < objective->particles; i++) {
        const double *x = sim->x + 3 * i, *v = sim->v + 3 * i;
        info->kinetic_energy += 0.5 * objective->mass[i] * vec3_dot(v, v);
        info->potential_energy -= objective->mass[i] * vec3_dot(sim->scene.settings.gravity, x);
        vec3_add(info->momentum, objective->mass[i], v);
    }
    for (int b = 0; b < sim->constraints; b++)
        if (type_stores_energy(objective->batch[b]->type))
            info->constraint_energy += objective->batch[b]->energy;
    for (int k = 1; k <= sim->control.batches; k++) /* holds: the last ones */
        info->constraint_energy += objective->batch[objective->batches - k]->energy;
    if (objective->barrier) info->constraint_energy += objective->barrier->energy;
}

/* Adds the reactions of pins. The force in a pin is the gradient of all other terms at its point:
 * the full gradient minus the part of the pin. At a solved step it balances the pin; otherwise the
 * difference is part of the residual. */
static void add_pin_reaction(const struct pdyn_sim *sim, pdyn_step_info *info) {
    const struct objective *objective = &sim->objective;
    for (int b = 0; b < objective->batches; b++) {
        const struct batch *pin = objective->batch[b];
        if (!(pin->type->flags & PDYN_REACTION) || pin->off) continue;
        double force[3] = {0};
        for (int i = 0; i < pin->touch_count; i++)
            for (int t = pin->touch_start[i]; t < pin->touch_start[i + 1]; t++) {
                const struct touch *touch = &pin->touch[t];
                if (t == pin->touch_start[i])
                    vec3_add(force, 1.0, sim->gradient + 3 * (pin->touch_first + i));
                vec3_add(force, -touch->coefficient, pin->flux + 4 * (size_t)touch->row);
            }
        vec3_add(info->pin_reaction, 1.0 - pin->left_out, force);
    }
}

void measure_step(struct pdyn_sim *sim, pdyn_step_info *info) {
    compute_density_errors(sim, info);
    add_energies(sim, info);
    add_pin_reaction(sim, info);
}
