/* One time step: predict, then local and global steps in turn until the step is solved, then the
 * new velocity. Implicit Euler as a minimisation (Bouaziz et al. 2014). The global step is the
 * damped newton step of E; with eps = 1 it is that of classic Projective Dynamics. */
#include "clock.h"
#include "emit.h"
#include "measure.h"
#include "sim.h"
#include "timestep.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { BACKTRACKS = 6 };

struct progress {                    /* of the minimisation of one step */
    double before, energy, residual; /* before: the energy an iteration earlier */
    int outer, linear;
};

struct taken {                 /* a step along the direction */
    double length;             /* 1: all of it */
    double slope, slope_after; /* of E along it, before and after */
};

static size_t bytes_of(const struct pdyn_sim *sim) {
    return 3 * (size_t)sim->system.particles * sizeof(double);
}

/* s = x + h v + h^2 g, and the iterate starts there. */
static void predict(struct pdyn_sim *sim, double h) {
    const double *g = sim->scene.settings.gravity;
    sim->system.h = h;
    sim->system.time = sim->time + h;
    for (int k = 0; k < 3 * sim->system.particles; k++)
        sim->system.s[k] = sim->x[k] + h * sim->v[k] + h * h * g[k % 3];
    emit_hold(sim);
    memcpy(sim->x_next, sim->system.s, bytes_of(sim));
}

/* Warm start: what the constraints did in the last step, x - s, scaled to this one, is likely to be
 * needed again; taken where it lowers E. (Leaving out gravity instead would look as good in density
 * and destroy the motion of unconverged steps.) */
static pdyn_status warm_start(struct pdyn_sim *sim, double h, double *energy) {
    pdyn_status status = system_local(&sim->system, sim->x_next, energy, sim->gradient);
    if (status != PDYN_OK || sim->last_h == 0.0 || sim->solver->keeps_multipliers) return status;
    double warm, ratio = h / sim->last_h;
    memcpy(sim->trial, sim->x_next, bytes_of(sim));
    system_axpy(&sim->system, ratio * ratio, sim->correction, sim->trial);
    status = system_local(&sim->system, sim->trial, &warm, sim->trial_gradient);
    if (status != PDYN_OK) return status;
    if (!(warm < *energy)) return system_local(&sim->system, sim->x_next, energy, sim->gradient);
    memcpy(sim->x_next, sim->trial, bytes_of(sim));
    memcpy(sim->gradient, sim->trial_gradient, bytes_of(sim));
    *energy = warm;
    return PDYN_OK;
}

/* x_next + direction, halved until E falls enough (Armijo). step->length: what was taken, 0 for
 * none; then the iterate and its local step are as before. Unfinished multipliers may raise E once;
 * then it has to fall below what it was before that. */
static pdyn_status descend(struct pdyn_sim *sim, double before, double *energy,
                           struct taken *step) {
    struct system *sys = &sim->system;
    double slope = system_dot(sys, sim->gradient, sim->direction), trial;
    double bound = *energy;
    *step = (struct taken){.length = 1.0, .slope = slope};
    if (sim->solver->keeps_multipliers) bound = fmax(before, *energy), slope = 0.0;
    for (int k = 0; k < BACKTRACKS; k++, step->length *= 0.5) {
        memcpy(sim->trial, sim->x_next, bytes_of(sim));
        system_axpy(sys, step->length, sim->direction, sim->trial);
        pdyn_status status = system_local(sys, sim->trial, &trial, sim->trial_gradient);
        if (status != PDYN_OK) return status;
        if (trial <= bound + 1e-4 * step->length * slope + 1e-13 * fabs(bound)) {
            memcpy(sim->x_next, sim->trial, bytes_of(sim));
            memcpy(sim->gradient, sim->trial_gradient, bytes_of(sim));
            *energy = trial;
            step->slope_after = system_dot(sys, sim->gradient, sim->direction);
            return PDYN_OK;
        }
    }
    step->length = 0.0;
    return system_local(sys, sim->x_next, energy, sim->gradient);
}

/* The direction to the minimum of E's model. */
static pdyn_status solve_model(struct pdyn_sim *sim, struct progress *p) {
    const struct scene_settings *set = &sim->scene.settings;
    int iterations = 0;
    memset(sim->direction, 0, bytes_of(sim));
    for (int k = 0; k < 3 * sim->system.particles; k++) sim->negative[k] = -sim->gradient[k];
    double enough = 0.5 * set->tolerance / p->residual; /* for the step, to first order */
    pdyn_status status = sim->solver->solve(sim->solver_state, sim->negative, sim->direction,
                                            fmax(set->linear_tolerance, enough),
                                            set->linear_iterations, &iterations);
    p->linear += iterations;
    return status;
}

/* Levenberg-Marquardt: more damping where the step went too far, less where it was good. With
 * multipliers the first iteration is undamped, for it alone carries the motion, and damping lasts:
 * what needs it is the change of a fluid's gradients under pressure, which the model does not know.
 * There, the slope along the step says at its end whether it was too long or too short. */
static double more_damping(double eps, double factor) {
    return fmin(1.0, fmax(factor * eps, 1e-6));
}

static double less_damping(double eps, double factor) { return eps > 1e-7 ? eps / factor : 0.0; }

static void adapt_damping(struct pdyn_sim *sim, const struct taken *step) {
    double factor = 4.0, overshoot = step->slope_after / fmax(fabs(step->slope), 1e-300);
    if (!sim->solver->keeps_multipliers) factor = 10.0, overshoot = step->length < 1.0 ? 1.0 : -1.0;
    if (step->length < 1.0 || overshoot > 0.5) sim->damping = more_damping(sim->damping, factor);
    else if (overshoot < -0.5) sim->damping = less_damping(sim->damping, factor);
}

/* One global step. *moved is false where no step lowers E any more. */
static pdyn_status global_step(struct pdyn_sim *sim, struct progress *p, bool *moved) {
    struct taken taken = {0};
    double energy = p->energy;
    bool first = sim->solver->keeps_multipliers && p->outer == 0;
    pdyn_status status = system_linearise(&sim->system, first ? 0.0 : sim->damping);
    if (status == PDYN_OK) status = solve_model(sim, p);
    if (status == PDYN_OK) status = descend(sim, p->before, &p->energy, &taken);
    p->before = energy;
    if (status != PDYN_OK) return status;
    *moved = taken.length > 0.0 || sim->damping < 1.0;
    if (!sim->scene.settings.newton) return PDYN_OK;
    if (!first) adapt_damping(sim, &taken);
    return PDYN_OK;
}

static void observe(const struct pdyn_sim *sim, const struct progress *p, int linear) {
    if (!sim->observer) return;
    pdyn_iteration iteration = {.iteration = p->outer,
                                .linear_iterations = linear,
                                .energy = p->energy,
                                .residual = p->residual,
                                .damping = sim->damping,
                                .x = sim->x_next};
    sim->observer(sim->observer_user, &iteration);
}

/* Local and global steps in turn until the step residual is small enough. */
static pdyn_status minimise(struct pdyn_sim *sim, double h, struct progress *p) {
    const struct scene_settings *set = &sim->scene.settings;
    double weight = measure_weight(sim);
    int linear = 0; /* of the iterations before this one */
    bool moved = true;
    if (sim->solver->keeps_multipliers && set->newton)
        sim->damping = less_damping(sim->damping, 4.0);
    pdyn_status status = warm_start(sim, h, &p->energy);
    p->before = p->energy;
    while (status == PDYN_OK) {
        p->residual = sqrt(system_dot(&sim->system, sim->gradient, sim->gradient)) / weight;
        if (!isfinite(p->energy) || !isfinite(p->residual))
            return context_fail(
                sim->context, PDYN_DIVERGED,
                "step %ld at %g s: the energy is not finite; the state is that of the "
                "step before",
                sim->steps + 1, sim->time);
        observe(sim, p, p->linear - linear);
        linear = p->linear;
        if (!moved || p->residual <= set->tolerance || p->outer >= set->outer_iterations) break;
        status = global_step(sim, p, &moved);
        p->outer++;
    }
    return status;
}

/* Where nothing can take momentum away, the step must not either, however far it was solved: the
 * mean of x - s over the mass is the momentum that an unfinished solve made up. */
static pdyn_status keep_momentum(struct pdyn_sim *sim) {
    struct system *sys = &sim->system;
    double moved[3] = {0}, mass = 0.0, energy;
    if (sim->anchored) return PDYN_OK;
    for (int i = 0; i < sys->particles; i++) {
        if (!emit_is_live(sim, i)) continue;
        mass += sys->mass[i];
        for (int a = 0; a < 3; a++)
            moved[a] += sys->mass[i] * (sim->x_next[3 * i + a] - sys->s[3 * i + a]);
    }
    for (int k = 0; k < 3 * sys->particles; k++)
        if (emit_is_live(sim, k / 3)) sim->x_next[k] -= moved[k % 3] / mass;
    return system_local(sys, sim->x_next, &energy, sim->gradient);
}

/* v = (x_next - x) / h, then viscosity; the iterate becomes the state. */
static void accept(struct pdyn_sim *sim, double h) {
    struct system *sys = &sim->system;
    for (int k = 0; k < 3 * sys->particles; k++) {
        sim->v[k] = (sim->x_next[k] - sim->x[k]) / h;
        sim->correction[k] = sim->x_next[k] - sys->s[k];
    }
    memcpy(sim->x, sim->x_next, bytes_of(sim));
    for (int b = 0; b < sys->batches; b++)
        if (sys->batch[b]->op && sys->batch[b]->type->op->velocity)
            sys->batch[b]->type->op->velocity(sys->batch[b]->op, sim->v);
    sim->last_h = h;
    sim->steps++;
}

static pdyn_status step(struct pdyn_sim *sim, pdyn_step_info *info) {
    struct progress progress = {0};
    struct moment end = timestep_choose(sim);
    double start = clock_ms();
    sim->system.ms_neighbours = sim->system.ms_local = 0.0;

    predict(sim, end.h);
    motion_carry(sim, sim->system.time);
    pdyn_status status = minimise(sim, end.h, &progress);
    if (status == PDYN_OK) status = keep_momentum(sim);
    if (status == PDYN_OK) status = measure_end(sim);
    if (status != PDYN_OK) {
        motion_carry(sim, sim->time);
        return status;
    }
    accept(sim, end.h);

    timestep_advance(sim, &end);
    emit_step(sim);
    *info = (pdyn_step_info){.time = sim->time,
                             .h = end.h,
                             .frame = end.frame,
                             .outer_iterations = progress.outer,
                             .linear_iterations = progress.linear,
                             .step_residual = progress.residual};
    measure_step(sim, info);
    info->ms_neighbours = sim->system.ms_neighbours, info->ms_local = sim->system.ms_local;
    info->ms_global = clock_ms() - start - info->ms_neighbours - info->ms_local;
    return PDYN_OK;
}

pdyn_status pdyn_step(pdyn_sim *sim, pdyn_step_info *info) {
    pdyn_step_info unused;
    if (!sim) return PDYN_BAD_CALL;
    if (sim->failed)
        return context_fail(sim->context, PDYN_BAD_CALL,
                            "the simulation has failed before: no further step");
    pdyn_status status = step(sim, info ? info : &unused);
    sim->failed = status != PDYN_OK;
    return status;
}
