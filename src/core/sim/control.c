#include "control.h"

#include "base/bad_call.h"
#include "contact/contact.h"
#include "crossings.h"
#include "extent.h"
#include "forces.h"
#include "live_particles.h"
#include "parameters.h"
#include "rigid_fit.h"
#include "schedule.h"
#include "sim.h"

#include "projdyn/control.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

bool control_is_in_step(const char *function, const struct pdyn_sim *sim) {
    if (sim->in_step) bad_call(function, "within a step an observer may only read the simulation");
    return sim->in_step;
}

bool control_refuses(const char *function, const struct pdyn_sim *sim) {
    if (control_is_in_step(function, sim)) return true;
    if (sim->failed) bad_call(function, "the simulation has failed before: restore a state first");
    return sim->failed;
}

/* ---- batches and solvers after a change ------------------------------------------------------ */

/* Whether the forces of a constraint type do not sum to zero: by its flag, or on solids. */
static bool anchors(const struct pdyn_sim *sim, const pdyn_constraint_type *type) {
    bool on_solids =
        type->boundary_force || (type->matrix_free && type->matrix_free->boundary_force);
    return (type->flags & PDYN_ANCHORED) || (on_solids && sim->boundary.at.count > 0);
}

/* Marks the body of a constraint that acts and is anchored. */
static void find_held(struct pdyn_sim *sim, const struct batch *b) {
    struct contact *contact = sim->objective.contact;
    if (b->off || !anchors(sim, b->type)) return;
    sim->anchored = true;
    if (contact) contact_hold(contact, (int)(b->view.body - sim->body), true);
}

void control_find_anchored(struct pdyn_sim *sim) {
    const struct objective *objective = &sim->objective;
    struct contact *contact = objective->contact;
    sim->anchored = (contact && sim->scene.solids > 0) || (sim->live && sim->live->pushed > 0);
    for (int b = 0; contact && b < sim->bodies; b++) contact_hold(contact, b, false);
    for (int b = 0; b < sim->constraints; b++) find_held(sim, objective->batch[b]);
    for (int k = 1; k <= sim->control.batches; k++) /* holds: the last ones */
        find_held(sim, objective->batch[objective->batches - k]);
}

pdyn_status control_settle(struct pdyn_sim *sim) {
    if (!sim->control.stale) return PDYN_OK;
    solver_choice_free(sim); /* solvers keep what they found out about the constraints */
    pdyn_status status = holds_make_batches(sim);
    control_find_anchored(sim);
    if (status == PDYN_OK) status = solver_choice_create(sim);
    /* a failed simulation can be saved, which tries again */
    sim->control.stale = status != PDYN_OK;
    sim->failed |= status != PDYN_OK;
    return status;
}

void control_free(struct pdyn_sim *sim) {
    holds_free(sim);
    if (sim->control.force) FREE_VECTOR(sim->context, sim->control.force, sim->objective.particles);
}

/* ---- forces ---------------------------------------------------------------------------------- */

/* number: count x 3; NULL: none. */
static pdyn_status check_numbers(const char *function, const double *number, int count,
                                 double limit, const char *what, const char *unit) {
    for (size_t k = 0; number && k < 3 * (size_t)count; k++)
        if (!(fabs(number[k]) <= limit)) /* or NaN */
            return set_error(PDYN_BAD_INPUT,
                             "%s: number %zu: expected %s of at most %g %s, found %g", function, k,
                             what, limit, unit, number[k]);
    return PDYN_OK;
}

/* Whether the simulation has failed, or lacks some of the particles from `first`. */
static bool bad_range(const char *function, const pdyn_sim *sim, int first, int count) {
    int particles = sim->objective.particles;
    if (control_refuses(function, sim)) return true;
    if (first >= 0 && count >= 0 && first <= particles - count) return false;
    bad_call(function, "first %d, count %d: there are %d particles", first, count, particles);
    return true;
}

static pdyn_status change_forces(const char *function, struct pdyn_sim *sim, int first, int count,
                                 const double *force, double keep) {
    pdyn_status status = check_numbers(function, force, count, 1e15, "a force", "N");
    if (status != PDYN_OK || (!force && !sim->control.force)) return status;
    double **all = &sim->control.force;
    if (!*all && !(*all = NEW_VECTOR(sim->context, sim->objective.particles)))
        return PDYN_NO_MEMORY;
    double *own = *all + 3 * (size_t)first;
    sim->control.driven = true;
    for (int k = 0; k < 3 * count; k++)
        if (particle_is_live(sim, first + k / 3)) own[k] = keep * own[k] + (force ? force[k] : 0.0);
    return PDYN_OK;
}

pdyn_status pdyn_set_forces(pdyn_sim *sim, int first, int count, const double *force) {
    if (HAS_NULL(sim) || bad_range(__func__, sim, first, count)) return PDYN_BAD_CALL;
    return change_forces(__func__, sim, first, count, force, 0.0);
}

pdyn_status pdyn_add_forces(pdyn_sim *sim, int first, int count, const double *force) {
    if (HAS_NULL(sim, force) || bad_range(__func__, sim, first, count)) return PDYN_BAD_CALL;
    return change_forces(__func__, sim, first, count, force, 1.0);
}

void control_set_gravity(struct pdyn_sim *sim, const double gravity[3]) {
    memcpy(sim->scene.settings.gravity, gravity, sizeof sim->scene.settings.gravity);
    sim->control.gravity = fmax(sim->control.gravity, vec3_length(gravity));
    sim->floor = extent_floor(sim);
}

pdyn_status pdyn_set_gravity(pdyn_sim *sim, const double gravity[3]) {
    if (HAS_NULL(sim, gravity) || control_refuses(__func__, sim)) return PDYN_BAD_CALL;
    pdyn_status status = check_numbers(__func__, gravity, 1, 1e6, "an acceleration", "m/s^2");
    if (status != PDYN_OK) return status;
    sim->control.driven = true;
    sim->scene.settings.gravity_keys.replaced = true;
    control_set_gravity(sim, gravity);
    return PDYN_OK;
}

void pdyn_get_gravity(const pdyn_sim *sim, double gravity[3]) {
    for (int a = 0; a < 3 && gravity; a++) gravity[a] = sim ? sim->scene.settings.gravity[a] : 0.0;
}

/* ---- positions and velocities ---------------------------------------------------------------- */

/* After a change of the state. */
static void forget_last_step(struct pdyn_sim *sim) {
    sim->control.driven = true;
    forces_forget(sim);
    sim_forget_steps(sim);
}

static void copy_live(const struct pdyn_sim *sim, int first, int count, const double *from,
                      double *to) {
    for (int i = first; i < first + count; i++)
        if (particle_is_live(sim, i))
            memcpy(to + 3 * (size_t)i, from + 3 * (size_t)(i - first), 3 * sizeof *to);
}

static pdyn_status put_back(struct pdyn_sim *sim, const double *x) {
    struct contact *contact = sim->objective.contact;
    memcpy(sim->x, x, objective_bytes(&sim->objective));
    return contact ? contact_local(contact, sim->x) : PDYN_OK;
}

static pdyn_status place(struct pdyn_sim *sim, int first, int count, const double *x) {
    struct contact *contact = sim->objective.contact;
    copy_live(sim, first, count, x, sim->x);
    rigid_fit_positions(sim, first, count);
    pdyn_status status = contact ? contact_local(contact, sim->x) : PDYN_OK;
    return status == PDYN_OK && contact ? contact_check(contact, first, count) : status;
}

/* Whether x, count x 3, has one place for all live particles of a body, two or more; x: of the
 * body. */
static bool is_one_place(const struct pdyn_sim *sim, const pdyn_body *body, const double *x) {
    const double *place = NULL;
    int live = 0;
    for (int k = 0; k < body->count; k++) {
        const double *own = x + 3 * (size_t)k;
        if (!particle_is_live(sim, body->first + k)) continue;
        if (!live++) place = own;
        if (vec3_distance(own, place) > 0.0) return false;
    }
    return live > 1;
}

/* Refuses one place for a whole body. A sheet of no size has no direction in which it would open,
 * and in a fluid every particle would be a neighbour of every other one. */
static pdyn_status check_places(const struct pdyn_sim *sim, int first, int count, const double *x) {
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        bool whole = body->first >= first && body->first + body->count <= first + count;
        if (whole && is_one_place(sim, body, x + 3 * (size_t)(body->first - first)))
            return set_error(PDYN_BAD_INPUT,
                             "body \"%s\": expected places that differ, found one place for all of "
                             "it",
                             body->name);
    }
    return PDYN_OK;
}

pdyn_status pdyn_set_positions(pdyn_sim *sim, int first, int count, const double *x) {
    if (HAS_NULL(sim, x) || bad_range(__func__, sim, first, count)) return PDYN_BAD_CALL;
    pdyn_status status = check_numbers(__func__, x, count, SCENE_MAX_POSITION, "a coordinate", "m");
    if (status == PDYN_OK) status = check_places(sim, first, count, x);
    if (status == PDYN_OK) status = rigid_fit_check(sim, first, count);
    if (status != PDYN_OK) return status;
    double *before = NEW_VECTOR(sim->context, sim->objective.particles);
    if (!before) return PDYN_NO_MEMORY;
    memcpy(before, sim->x, objective_bytes(&sim->objective));
    status = place(sim, first, count, x);
    if (status == PDYN_OK) {
        forget_last_step(sim);
        crossings_forget(sim, first, count);
    } else sim->failed |= put_back(sim, before) != PDYN_OK;
    FREE_VECTOR(sim->context, before, sim->objective.particles);
    return status;
}

pdyn_status pdyn_set_velocities(pdyn_sim *sim, int first, int count, const double *v) {
    if (HAS_NULL(sim, v) || bad_range(__func__, sim, first, count)) return PDYN_BAD_CALL;
    pdyn_status status = check_numbers(__func__, v, count, STEP_MAX_SPEED, "a velocity", "m/s");
    if (status == PDYN_OK) status = rigid_fit_check(sim, first, count);
    if (status != PDYN_OK) return status;
    copy_live(sim, first, count, v, sim->v);
    rigid_fit_velocities(sim, first, count);
    forget_last_step(sim);
    return PDYN_OK;
}

/* ---- saved states ---------------------------------------------------------------------------- */

static void persist_forces(struct pdyn_sim *sim, struct snapshot_file *file) {
    double **force = &sim->control.force;
    bool has = *force;
    snapshot_file_flags(file, &has, 1, "the flag of forces is neither 0 nor 1");
    if (file->view.reading && file->status == PDYN_OK && *force && !has)
        FREE_VECTOR(sim->context, *force, sim->objective.particles);
    if (file->status != PDYN_OK || !has) return;
    if (!*force && !(*force = NEW_VECTOR(sim->context, sim->objective.particles)))
        file->status = PDYN_NO_MEMORY;
    else
        snapshot_file_numbers(file, *force, 3 * (size_t)sim->objective.particles,
                              "a force is not finite");
}

void control_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    snapshot_file_flags(file, &sim->control.driven, 1, "the flag of changes is neither 0 nor 1");
    snapshot_file_numbers(file, sim->scene.settings.gravity, 3, "gravity is not finite");
    snapshot_file_numbers(file, &sim->control.gravity, 1, "the largest gravity is not finite");
    SNAPSHOT(file, sim->floor);
    persist_forces(sim, file);
    schedule_persist(sim, file);
    parameters_persist(sim, file);
    if (file->status == PDYN_OK) holds_persist(sim, file);
    if (file->status == PDYN_OK) kinematic_persist(sim, file);
    if (file->view.reading && file->status == PDYN_OK) file->status = control_settle(sim);
}
