/* Saved states: everything on which the next step of a simulation depends. */
#include "snapshot.h"

#include "base/bad_call.h"
#include "contact/contact.h"
#include "scene/fingerprint.h"
#include "sim/crossings.h"
#include "sim/forces.h"
#include "sim/live_particles.h"
#include "sim/probes.h"

#include <stdio.h>
#include <string.h>

/* Largest number of frames and of steps: a double represents every smaller integer. */
static const long max_count = 1L << 52;

/* Time, and the lengths of the last steps. A step ends at the next frame at the latest. */
static void persist_time(struct pdyn_sim *sim, struct snapshot_file *file) {
    const double interval = sim->scene.settings.frame_interval, rounding = 1e-6 * interval;
    snapshot_file_numbers(file, &sim->time, 1, "the time is not finite");
    snapshot_file_long(file, &sim->frame, max_count, "the number of frames is out of range");
    snapshot_file_long(file, &sim->steps, max_count, "the number of steps is out of range");
    snapshot_file_numbers(file, &sim->last_h, 1, "the step length is not finite");
    snapshot_file_numbers(file, &sim->history, 1, "the length of the history is not finite");
    double since = sim->time - (double)sim->frame * interval;
    snapshot_file_require(file, since >= -rounding && since <= interval + rounding,
                          "time and number of frames do not belong together");
    snapshot_file_require(file, sim->last_h >= 0.0 && sim->last_h <= sim->time + rounding,
                          "the step length is out of range");
    snapshot_file_require(file, sim->history == 0.0 || sim->history == sim->last_h,
                          "the history is not as long as the last step");
}

static void persist_numbers(struct pdyn_sim *sim, struct snapshot_file *file) {
    persist_time(sim, file);
    SNAPSHOT(file, sim->eps);
    snapshot_file_require(file, sim->eps >= 0.0 && sim->eps <= 1.0,
                          "the damping is not between 0 and 1");
    snapshot_file_flags(file, &sim->far_off, 1, "a flag of the last step is neither 0 nor 1");
}

static void persist_particles(struct pdyn_sim *sim, struct snapshot_file *file) {
    size_t n = (size_t)sim->objective.particles;
    double *states[][2] = {{sim->x, sim->v}, {sim->x_before, sim->v_before}};
    double *numbers[] = {sim->density, sim->pressure, sim->pressure_before};
    for (size_t k = 0; k < sizeof states / sizeof *states && states[k][0]; k++) {
        snapshot_file_range(file, states[k][0], 3 * n, STATE_MAX_POSITION,
                            "a position is out of range");
        snapshot_file_range(file, states[k][1], 3 * n, STATE_MAX_SPEED,
                            "a velocity is out of range");
    }
    snapshot_file_numbers(file, sim->constraint_acceleration, 3 * n,
                          "an acceleration is not finite");
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        snapshot_file_numbers(file, numbers[k], n, "a density or pressure is not finite");
}

/* Neighbour lists are built again at the positions of their last build, because the order of their
 * entries determines rounding errors of sums; samples that are not near have these positions, too.
 * Then solids are moved to the current time. */
static void persist_neighbours(struct pdyn_sim *sim, struct snapshot_file *file) {
    if (!sim->objective.neighbours) return;
    if (file->view.reading && file->status == PDYN_OK) live_particles_update_lists(sim);
    neighbours_persist(sim->objective.neighbours, file);
    if (!file->view.reading || file->status != PDYN_OK) return;
    struct surface_samples *samples = sim->objective.samples;
    if (samples)
        samples_interpolate(samples, neighbours_built_at(sim->objective.neighbours), samples->x);
    file->status = objective_share_lists(&sim->objective);
    kinematic_move(sim, sim->time);
}

/* Keeps the first error: that of the file, or that of a module. */
static void note_status(struct snapshot_file *file, pdyn_status status) {
    if (file->status == PDYN_OK) file->status = status;
}

/* After an error no module is called: it would read zeros. */
static void persist_modules(struct pdyn_sim *sim, struct snapshot_file *file) {
    for (int b = 0; b < sim->objective.batches && file->status == PDYN_OK; b++) {
        struct batch *batch = sim->objective.batch[b];
        unsigned errors = error_count();
        if (batch->op && batch->type->matrix_free->persist)
            note_status(file,
                        error_of_module(batch->type->name,
                                        batch->type->matrix_free->persist(batch->op, &file->view),
                                        errors));
        if (batch->op && file->status == PDYN_OK) one_sided_persist(&batch->one_sided, file);
        size_t size = batch->type->memory_size;
        if (size) row_memory_persist(sim->context, &batch->memory, size, file);
        if (file->view.reading && file->status == PDYN_OK && batch_is_static(batch))
            batch_recall(batch);
    }
    if (file->status == PDYN_OK) solver_choice_persist(sim, file);
}

static void persist_values(const struct scene *scene, struct snapshot_file *file) {
    for (int k = 0; k < FINGERPRINTS; k++) {
        char what[320];
        snprintf(what, sizeof what,
                 "values of \"%s\" in its scene; only the duration, colours, step lengths, and "
                 "tolerances and iterations of the solver may change: undo the change, or start a "
                 "new run; a program may restore the state and then set gravity and parameters of "
                 "constraints (docs/guide/python.md#run)",
                 fingerprint_key(k));
        snapshot_file_expect(file, scene->fingerprint[k], what);
    }
}

/* Writes what identifies the scene, or reads it and compares. */
static pdyn_status persist_scene(struct pdyn_sim *sim, struct snapshot_file *file) {
    snapshot_file_expect(file, hash_bytes(HASH_BEGIN, PROJDYN_VERSION, strlen(PROJDYN_VERSION)),
                         "versions of projdyn");
    persist_values(&sim->scene, file);
    snapshot_file_expect(
        file, (uint64_t)sim->objective.particles,
        "numbers of particles (to resume for longer, inlets need a \"budget\" from the "
        "start)");
    snapshot_file_expect(file, hash_bytes(HASH_BEGIN, sim->rest, objective_bytes(&sim->objective)),
                         "positions at rest");
    snapshot_file_expect(file, fingerprint_of_meshes(&sim->scene), "meshes");
    snapshot_file_expect(file, (uint64_t)sim->boundary.at.count, "numbers of boundary points");
    snapshot_file_expect(file, (uint64_t)(sim->objective.batches - sim->control.batches),
                         "constraints");
    return file->status;
}

/* The solver that the scene and its holds ask for. */
static void persist_solver(struct pdyn_sim *sim, struct snapshot_file *file) {
    const char *solver = pdyn_solver_type(sim);
    if (file->status != PDYN_OK) return;
    snapshot_file_expect(file, hash_bytes(HASH_BEGIN, solver, strlen(solver)), "solvers");
}

static pdyn_status persist_state(struct pdyn_sim *sim, struct snapshot_file *file) {
    persist_numbers(sim, file);
    control_persist(sim, file);
    persist_solver(sim, file);
    warnings_persist(&sim->warnings, file);
    energy_budget_persist(sim, file);
    crossings_persist(sim, file);
    persist_particles(sim, file);
    live_particles_persist(sim, file);
    probes_persist(sim, file);
    persist_neighbours(sim, file);
    persist_modules(sim, file);
    if (sim->objective.contact) contact_persist(sim->objective.contact, file);
    return file->status;
}

/* ---- writing and reading --------------------------------------------------------------------- */

pdyn_status snapshot_write(struct pdyn_sim *sim, struct snapshot_file *file) {
    file->status = control_settle(sim);
    return file->status == PDYN_OK && persist_scene(sim, file) == PDYN_OK ? persist_state(sim, file)
                                                                          : file->status;
}

/* Positions at which lists cannot be built make the search fail with PDYN_DIVERGED. */
static pdyn_status read_state(struct pdyn_sim *sim, struct snapshot_file *file) {
    pdyn_status status = persist_state(sim, file);
    if (status != PDYN_DIVERGED) return status;
    file->status = PDYN_OK;
    snapshot_file_require(file, false, pdyn_last_error(NULL));
    return file->status;
}

pdyn_status snapshot_read(struct pdyn_sim *sim, struct snapshot_file *file,
                          struct snapshot_file *before) {
    *before = (struct snapshot_file){0};
    sim->control.stale |= sim->failed; /* a solver without memory may be half made */
    file->status = control_settle(sim);
    if (file->status != PDYN_OK || persist_scene(sim, file) != PDYN_OK) return file->status;
    snapshot_memory_create(sim->context, before);
    pdyn_status status = persist_state(sim, before);
    if (status == PDYN_OK) {
        snapshot_memory_rewind(before);
        forces_forget(sim);
        return read_state(sim, file);
    }
    snapshot_file_close(before);
    *before = (struct snapshot_file){0};
    return file->status = status;
}

pdyn_status snapshot_end_read(struct pdyn_sim *sim, struct snapshot_file *before,
                              pdyn_status status) {
    if (!before->in_memory) return status;
    if (status == PDYN_OK) sim->failed = false;
    else if (persist_state(sim, before) != PDYN_OK) sim->failed = true;
    snapshot_file_close(before);
    return status;
}

/* ---- public functions ------------------------------------------------------------------------ */

pdyn_status pdyn_save(pdyn_sim *sim, const char *path) {
    struct snapshot_file file;
    if (HAS_NULL(sim, path) || control_is_in_step(__func__, sim)) return PDYN_BAD_CALL;
    pdyn_status status = snapshot_file_create(sim->context, path, &file);
    if (status != PDYN_OK) return status;
    snapshot_write(sim, &file);
    return snapshot_file_close(&file);
}

pdyn_status pdyn_save_memory(pdyn_sim *sim, void *buffer, size_t capacity, size_t *size) {
    struct snapshot_file file;
    if (HAS_NULL(sim, size) || control_is_in_step(__func__, sim)) return PDYN_BAD_CALL;
    if (!buffer && capacity) return bad_call(__func__, "buffer is NULL, capacity is %zu", capacity);
    snapshot_buffer_create(sim->context, buffer, capacity, &file);
    pdyn_status status = snapshot_write(sim, &file);
    if (status != PDYN_OK) return status;
    *size = snapshot_buffer_end(&file);
    if (!buffer || *size <= capacity) return PDYN_OK;
    return bad_call(__func__, "capacity: expected at least %zu, found %zu", *size, capacity);
}

/* Restores an opened state and closes it. */
static pdyn_status restore_from(pdyn_sim *sim, struct snapshot_file *file) {
    struct snapshot_file before;
    pdyn_status status = snapshot_end_read(sim, &before, snapshot_read(sim, file, &before));
    snapshot_file_close(file);
    return status;
}

pdyn_status pdyn_restore(pdyn_sim *sim, const char *path) {
    struct snapshot_file file;
    if (HAS_NULL(sim, path) || control_is_in_step(__func__, sim)) return PDYN_BAD_CALL;
    pdyn_status status = snapshot_file_open(sim->context, path, &file);
    return status == PDYN_OK ? restore_from(sim, &file) : status;
}

pdyn_status pdyn_restore_memory(pdyn_sim *sim, const void *buffer, size_t size) {
    struct snapshot_file file;
    if (HAS_NULL(sim, buffer) || control_is_in_step(__func__, sim)) return PDYN_BAD_CALL;
    pdyn_status status = snapshot_buffer_open(sim->context, buffer, size, &file);
    return status == PDYN_OK ? restore_from(sim, &file) : status;
}
