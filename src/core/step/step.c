/* One time step. The way of a position through it, with the files that do each part:
 *
 *     x, v                 the state
 *       | predict          s = x^ + h_e v^ + h_e^2 (g + f/m) integrator.h has the base x^, v^
 *       | minimise         first iterate, from x towards s   carried.h, start_point.h, contact.h
 *       |                  iterates                          minimise.c
 *       |                  no momentum error                 momentum.h
 *       | finish_step      x = last iterate, v from x        velocities.h
 *       v                  inlets and outlets                sim/live_particles.h
 *     x, v
 *
 * A step that diverges is attempted again, shorter. */
#include "applied_force.h"
#include "base/bad_call.h"
#include "base/clock.h"
#include "base/sized.h"
#include "carried.h"
#include "contact/contact.h"
#include "integrator.h"
#include "minimise.h"
#include "momentum.h"
#include "sim/crossings.h"
#include "sim/forces.h"
#include "sim/live_particles.h"
#include "sim/measure.h"
#include "sim/probes.h"
#include "sim/rigid_bodies.h"
#include "sim/schedule.h"
#include "sim/sim.h"
#include "timestep.h"
#include "velocities.h"
#include "warn_of_step.h"

#include "projdyn/control.h"
#include "projdyn/vec3.h"

#include <stdio.h>
#include <string.h>

/* Computes the prediction s = x^ + h_e v^ + h_e^2 (g + f/m), f: applied forces, and puts the
 * iterate there; start_point.h may move it. */
static pdyn_status predict(struct pdyn_sim *sim, const struct step_end *end) {
    sim->objective.length = end->h, sim->objective.time = end->time;
    double h_e = sim->objective.h = sim->scene.settings.integrator->begin(sim, end->h);
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        sim->objective.s[k] =
            sim->x_base[k] + h_e * sim->v_base[k] + h_e * h_e * applied_acceleration(sim, k);
    live_particles_predict(sim);
    rigid_bodies_predict(sim);
    memcpy(sim->x_next, sim->objective.s, objective_bytes(&sim->objective));
    return objective_begin(&sim->objective, &(struct step_start){sim->x, sim->v, sim->x_before,
                                                                 sim->x_base, sim->v_base});
}

/* Updates neighbour lists, after particles have come or gone, and volumes and friction of the
 * surface samples to the start of the step. Volumes and friction are constant within the step. */
static pdyn_status prepare_lists(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    struct wet_sides *wet = objective->wet_sides;
    const double *all = NULL;
    pdyn_status status = PDYN_OK;
    if (objective->neighbours && (sim->live || wet))
        status = objective_ensure_lists(objective, sim->x, &all);
    if (objective->samples) {
        samples_update_volumes(objective->samples, sim->x);
        neighbours_set_sample_volumes(objective->neighbours, objective->samples);
    }
    return status == PDYN_OK && wet ? wet_sides_find(wet, all) : status;
}

static void store_previous_state(struct pdyn_sim *sim, double h) {
    sim->history = h;
    if (!sim->x_before) return;
    memcpy(sim->x_before, sim->x, objective_bytes(&sim->objective));
    memcpy(sim->v_before, sim->v, objective_bytes(&sim->objective));
}

/* Accepts the iterate as the new state. */
static void accept(struct pdyn_sim *sim, double h, double rise) {
    struct objective *objective = &sim->objective;
    store_previous_state(sim, h);
    velocities_update(sim, h, rise);
    for (int k = 0; k < 3 * objective->particles; k++)
        sim->constraint_acceleration[k] =
            (sim->x_next[k] - objective->s[k]) / (objective->h * objective->h);
    memcpy(sim->x, sim->x_next, objective_bytes(objective));
    velocities_apply_operators(sim, h);
    for (int b = 0; b < objective->batches; b++)
        batch_accept(objective->batch[b], sim->impacts.left_out, sim->solved);
    forces_pass_on(sim);
    forces_store_normal(sim);
    sim->last_h = h;
    sim->steps++;
}

/* Step residual up to which an unsolved step may serve as history: half of the weight of every
 * particle. */
static const double history_residual = 0.5;

/* Attempts a step; the result is in x_next, the state is unchanged. What take_back needs is set
 * before anything can fail. */
static pdyn_status attempt(struct pdyn_sim *sim, const struct step_end *end,
                           struct progress *progress) {
    *progress = (struct progress){0};
    walls_move(sim, sim->time);
    if (sim->objective.neighbours) neighbours_begin_step(sim->objective.neighbours, sim->x);
    struct contact *contact = sim->objective.contact;
    pdyn_status status = contact ? contact_begin(contact, sim->x, end->time) : PDYN_OK;
    if (status == PDYN_OK) status = prepare_lists(sim);
    if (status == PDYN_OK) status = predict(sim, end);
    if (status == PDYN_OK)
        status = measure_check_range(sim, end->h); /* contact would take for ever on longer paths */
    if (status != PDYN_OK) return status;
    status = carried_move(sim);
    if (status == PDYN_OK) status = energy_budget_open(sim);
    if (status == PDYN_OK) status = minimise(sim, progress);
    if (status == PDYN_OK) status = momentum_restore(sim);
    progress->far_off = progress->residual > fmax(sim->scene.settings.tolerance, history_residual);
    if (status == PDYN_OK)
        status = velocities_measure_rise(sim, progress->far_off, &progress->rise);
    if (status == PDYN_OK) status = measure_check_range(sim, end->h);
    return status == PDYN_OK ? energy_budget_check(sim, end->h) : status;
}

/* After a failed attempt: moves solids back. */
static pdyn_status take_back(struct pdyn_sim *sim) {
    kinematic_move(sim, sim->time);
    return sim->objective.contact ? contact_take_back(sim->objective.contact, sim->x) : PDYN_OK;
}

/* After the last attempt: the state is that of the last successful step, its history included. The
 * error stays the one of the attempt; of a divergence it also says which step. */
static pdyn_status fail_step(struct pdyn_sim *sim, double h, pdyn_status status) {
    char what[512];
    snprintf(what, sizeof what, "%s", pdyn_last_error(NULL));
    take_back(sim);
    if (status != PDYN_DIVERGED) return set_error(status, "%s", what);
    return set_error(PDYN_DIVERGED,
                     "step %ld of %g s at %g s: %s; the state is that of the step before",
                     sim->steps + 1, h, sim->time, what);
}

/* Whether a particle moved more than twice the distance that the CFL condition allows. Such a step
 * was not solved: water squeezed into a corner would leave through the wall. The condition does not
 * limit steps that a program gives: where these are solved, particles may go far. */
static bool moved_too_far(const struct pdyn_sim *sim, const struct step_end *end, double residual) {
    const struct scene_settings *settings = &sim->scene.settings;
    if (settings->h_fixed > 0.0 || end->h <= settings->h_min) return false;
    if (end->given && residual <= settings->tolerance) return false;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            if (vec3_distance(sim->x_next + 3 * i, sim->x + 3 * i) >
                2.0 * settings->cfl * body->radius)
                return true;
    }
    return false;
}

/* Attempts that were taken back. */
struct retries {
    int count;
    char why[WARNING_TEXT]; /* of the last one */
};

/* Whether the attempt has to be repeated with a shorter step; retries->why says why. False, too,
 * for an error that a shorter step does not mend. */
static bool must_shorten(const struct pdyn_sim *sim, const struct step_end *end, pdyn_status status,
                         double residual, struct retries *retries) {
    const char *why = NULL;
    if (status == PDYN_DIVERGED) why = pdyn_last_error(NULL);
    if (status == PDYN_OK && moved_too_far(sim, end, residual))
        why = "it was unsolved and moved a particle more than twice as far as \"cfl\" allows";
    if (why) snprintf(retries->why, sizeof retries->why, "%s", why);
    return why != NULL;
}

/* The friction of a step takes its normal forces from the step before. The first step has none
 * before it: it is attempted without friction, for these forces alone, and taken back. */
static pdyn_status find_first_normal_forces(struct pdyn_sim *sim, const struct step_end *end) {
    const struct objective *objective = &sim->objective;
    struct progress progress;
    void (*observer)(void *, const pdyn_iteration *) = sim->observer;
    double eps = sim->eps;
    if (sim->steps || !objective->friction || !contact_current(objective->contact)->count)
        return PDYN_OK;
    sim->observer = NULL;
    pdyn_status status = attempt(sim, end, &progress);
    if (status == PDYN_OK) forces_store_normal(sim);
    sim->observer = observer, sim->eps = eps;
    return status == PDYN_OK || status == PDYN_DIVERGED ? take_back(sim) : status;
}

/* Attempts the step with shorter and shorter lengths, up to the number of retries of the scene. */
static pdyn_status attempt_with_retries(struct pdyn_sim *sim, struct step_end *end,
                                        struct progress *progress, struct retries *retries) {
    double eps = sim->eps, history = sim->history;
    pdyn_status status = find_first_normal_forces(sim, end);
    if (status == PDYN_OK) status = attempt(sim, end, progress);
    while (retries->count < sim->scene.settings.retries &&
           must_shorten(sim, end, status, progress->residual, retries)) {
        if ((status = take_back(sim)) != PDYN_OK) break;
        sim_forget_steps(sim);
        *end =
            end->given ? timestep_given(sim, 0.25 * end->h) : timestep_choose(sim, 0.25 * end->h);
        status = attempt(sim, end, progress);
        retries->count++;
    }
    if (status == PDYN_OK) status = warn_of_momentum(sim);
    if (status == PDYN_OK) status = objective_end(&sim->objective);
    if (status == PDYN_OK) return PDYN_OK;
    sim->eps = eps, sim->history = history;
    return fail_step(sim, end->h, status);
}

/* The step in x_next becomes the state; then time advances, and inlets and outlets act. */
static void finish_step(struct pdyn_sim *sim, const struct step_end *end,
                        const struct progress *progress) {
    measure_update_fluid(sim);
    sim->solved = progress->residual <= sim->scene.settings.tolerance;
    sim->far_off = progress->far_off;
    crossings_step(sim, end->h);
    accept(sim, end->h, progress->rise);
    if (sim->objective.neighbours) neighbours_end_step(sim->objective.neighbours);
    timestep_check(sim, end);
    solver_choice_step(sim, progress->linear);
    timestep_advance(sim, end);
    live_particles_step(sim);
    sim->forces_known = true;
    probes_step(sim, end->h);
}

static void measure_times(const struct pdyn_sim *sim, double ms, double ms_cpu,
                          pdyn_step_info *info) {
    info->ms_neighbours = sim->objective.ms_neighbours, info->ms_local = sim->objective.ms_local;
    info->ms_contact = sim->objective.contact ? contact_ms(sim->objective.contact) : 0.0;
    info->ms_global = ms - info->ms_neighbours - info->ms_local - info->ms_contact;
    info->ms_cpu = ms_cpu;
}

static pdyn_status step(struct pdyn_sim *sim, struct step_end end, pdyn_step_info *info) {
    struct progress progress = {0};
    struct retries retries = {0};
    double start = clock_ms(), cpu = clock_cpu_ms();
    sim->in_step = true;
    forces_forget(sim);
    sim->objective.ms_neighbours = sim->objective.ms_local = 0.0;
    if (sim->objective.contact) contact_clear_ms(sim->objective.contact);
    pdyn_status status = attempt_with_retries(sim, &end, &progress, &retries);
    sim->in_step = false;
    if (status != PDYN_OK) return status;
    finish_step(sim, &end, &progress);
    *info = (pdyn_step_info){.time = sim->time,
                             .h = end.h,
                             .frame = end.frame,
                             .outer_iterations = progress.outer,
                             .linear_iterations = progress.linear,
                             .impacts = sim->impacts.count,
                             .retries = retries.count,
                             .leaked = crossings_total(sim),
                             .step_residual = progress.residual};
    measure_step(sim, info);
    warn_of_step(sim, info, retries.why);
    measure_times(sim, clock_ms() - start, clock_cpu_ms() - cpu, info);
    return PDYN_OK;
}

/* h: s, as the caller gives it; 0: as the scene says. */
static pdyn_status step_by(struct pdyn_sim *sim, double h, pdyn_step_info *info, size_t size) {
    pdyn_step_info result = {0};
    pool_check_process(sim->context->pool);
    pdyn_status status = schedule_switch(sim);
    if (status == PDYN_OK) status = control_settle(sim);
    if (status == PDYN_OK)
        status =
            step(sim, h > 0.0 ? timestep_given(sim, h) : timestep_choose(sim, INFINITY), &result);
    sim->failed = status != PDYN_OK;
    if (status == PDYN_OK) sized_copy(info, size, &result, sizeof result);
    return status;
}

pdyn_status pdyn_step_sized(pdyn_sim *sim, pdyn_step_info *info, size_t size) {
    if (HAS_NULL(sim) || control_refuses(__func__, sim)) return PDYN_BAD_CALL;
    return step_by(sim, 0.0, info, size);
}

pdyn_status pdyn_step_by_sized(pdyn_sim *sim, double h, pdyn_step_info *info, size_t size) {
    if (HAS_NULL(sim) || control_refuses(__func__, sim)) return PDYN_BAD_CALL;
    if (!(h >= TIMESTEP_SHORTEST && h <= TIMESTEP_LONGEST))
        return set_error(PDYN_BAD_INPUT,
                         "pdyn_step_by: expected a step from %g to %g s, found %g s",
                         TIMESTEP_SHORTEST, TIMESTEP_LONGEST, h);
    return step_by(sim, h, info, size);
}
