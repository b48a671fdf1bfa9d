/* Saved states: everything on which the next step of a simulation depends. */
#include "snapshot.h"

#include "step/live_particles.h"

#include <string.h>

static void persist_numbers(struct pdyn_sim *sim, struct snapshot_file *a) {
    SNAPSHOT(a, sim->time);
    SNAPSHOT(a, sim->frame);
    SNAPSHOT(a, sim->steps);
    SNAPSHOT(a, sim->last_h);
    SNAPSHOT(a, sim->history);
    SNAPSHOT(a, sim->damping);
    SNAPSHOT(a, sim->unfinished);
    SNAPSHOT(a, sim->warned);
}

static void persist_particles(struct pdyn_sim *sim, struct snapshot_file *a) {
    size_t n = (size_t)sim->objective.particles;
    double *vectors[] = {sim->x, sim->v, sim->constraint_acceleration, sim->x_before,
                         sim->v_before};
    double *numbers[] = {sim->density, sim->pressure, sim->pressure_before};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors && vectors[k]; k++)
        snapshot_file_bytes(a, vectors[k], 3 * n * sizeof(double));
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        snapshot_file_bytes(a, numbers[k], n * sizeof(double));
}

/* Neighbour lists are built again at the positions of their last build, because the order of their
 * entries determines rounding errors of sums; then solids are moved to the current time. */
static void persist_neighbours(struct pdyn_sim *sim, struct snapshot_file *a) {
    if (!sim->neighbours) return;
    if (a->view.reading) live_particles_update_lists(sim);
    pdyn_status status = neighbours_persist(sim->neighbours, &a->view);
    if (status == PDYN_OK && a->view.reading) status = objective_share_lists(&sim->objective);
    if (a->view.reading) kinematic_move(sim, sim->time);
    if (a->status == PDYN_OK) a->status = status;
}

static void persist_modules(struct pdyn_sim *sim, struct snapshot_file *a) {
    for (int b = 0; b < sim->objective.batches; b++) {
        struct batch *batch = sim->objective.batch[b];
        if (batch->op && batch->type->matrix_free->persist)
            batch->type->matrix_free->persist(batch->op, &a->view);
        size_t size = batch->type->memory_size;
        if (size) row_memory_persist(sim->context, &batch->memory, size, a);
    }
    if (!sim->solver->persist) return;
    pdyn_status status = sim->solver->persist(sim->solver_state, &a->view);
    if (a->status == PDYN_OK) a->status = status;
}

pdyn_status snapshot_simulation(struct pdyn_sim *sim, struct snapshot_file *a) {
    snapshot_file_expect(a, hash_bytes(HASH_BEGIN, PROJDYN_VERSION, strlen(PROJDYN_VERSION)),
                         "versions of projdyn");
    snapshot_file_expect(a, sim->scene.fingerprint, "values in its scene");
    snapshot_file_expect(a, (uint64_t)sim->objective.particles, "numbers of particles");
    snapshot_file_expect(a, hash_bytes(HASH_BEGIN, sim->rest, objective_bytes(&sim->objective)),
                         "positions at rest");
    snapshot_file_expect(a, (uint64_t)sim->boundary.at.count, "numbers of boundary points");
    snapshot_file_expect(a, (uint64_t)sim->objective.batches, "constraints");
    snapshot_file_expect(a, hash_bytes(HASH_BEGIN, sim->solver->name, strlen(sim->solver->name)),
                         "solvers");
    if (a->status != PDYN_OK) return a->status;
    persist_numbers(sim, a);
    persist_particles(sim, a);
    live_particles_persist(sim, a);
    persist_neighbours(sim, a);
    persist_modules(sim, a);
    if (sim->objective.contact) contact_persist(sim->objective.contact, sim->x, a);
    return a->status;
}

pdyn_status pdyn_save(pdyn_sim *sim, const char *path) {
    struct snapshot_file a;
    if (!sim || !path) return PDYN_BAD_CALL;
    pdyn_status status = snapshot_file_create(sim->context, path, &a);
    if (status != PDYN_OK) return status;
    snapshot_simulation(sim, &a);
    return snapshot_file_close(&a);
}

pdyn_status pdyn_restore(pdyn_sim *sim, const char *path) {
    struct snapshot_file a;
    if (!sim || !path) return PDYN_BAD_CALL;
    pdyn_status status = snapshot_file_open(sim->context, path, &a);
    if (status != PDYN_OK) return status;
    solid_load_begin_step(sim);
    snapshot_simulation(sim, &a);
    return snapshot_file_close(&a);
}
