/* What a simulation is between two steps: everything that its next step depends on. */
#include "persist.h"

#include "step/emit.h"

#include <string.h>

static void persist_numbers(struct pdyn_sim *sim, struct archive *a) {
    ARCHIVE(a, sim->time);
    ARCHIVE(a, sim->frame);
    ARCHIVE(a, sim->steps);
    ARCHIVE(a, sim->last_h);
    ARCHIVE(a, sim->history);
    ARCHIVE(a, sim->damping);
    ARCHIVE(a, sim->unfinished);
    ARCHIVE(a, sim->warned);
}

static void persist_particles(struct pdyn_sim *sim, struct archive *a) {
    size_t n = (size_t)sim->system.particles;
    double *vectors[] = {sim->x, sim->v, sim->constraint_acceleration, sim->x_before,
                         sim->v_before};
    double *numbers[] = {sim->density, sim->pressure, sim->pressure_before};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors && vectors[k]; k++)
        archive_bytes(a, vectors[k], 3 * n * sizeof(double));
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        archive_bytes(a, numbers[k], n * sizeof(double));
}

/* Lists are built again where they were built, for the order of what they hold decides how sums
 * are rounded; then solids go to where they are. */
static void persist_neighbours(struct pdyn_sim *sim, struct archive *a) {
    if (!sim->neighbours) return;
    if (a->view.reading) emit_tell(sim);
    pdyn_status status = neighbours_persist(sim->neighbours, &a->view);
    if (status == PDYN_OK && a->view.reading) status = system_tell_lists(&sim->system);
    if (a->view.reading) motion_carry(sim, sim->time);
    if (a->status == PDYN_OK) a->status = status;
}

static void persist_modules(struct pdyn_sim *sim, struct archive *a) {
    for (int b = 0; b < sim->system.batches; b++) {
        struct batch *batch = sim->system.batch[b];
        if (batch->op && batch->type->op->persist) batch->type->op->persist(batch->op, &a->view);
    }
    if (!sim->solver->persist) return;
    pdyn_status status = sim->solver->persist(sim->solver_state, &a->view);
    if (a->status == PDYN_OK) a->status = status;
}

pdyn_status persist(struct pdyn_sim *sim, struct archive *a) {
    archive_expect(a, hash_bytes(HASH_BEGIN, PROJDYN_VERSION, strlen(PROJDYN_VERSION)),
                   "versions of projdyn");
    archive_expect(a, sim->scene.fingerprint, "values in its scene");
    archive_expect(a, (uint64_t)sim->system.particles, "numbers of particles");
    archive_expect(a, hash_bytes(HASH_BEGIN, sim->rest, system_bytes(&sim->system)),
                   "positions at rest");
    archive_expect(a, (uint64_t)sim->boundary.at.count, "numbers of boundary points");
    archive_expect(a, (uint64_t)sim->system.batches, "constraints");
    archive_expect(a, hash_bytes(HASH_BEGIN, sim->solver->name, strlen(sim->solver->name)),
                   "solvers");
    if (a->status != PDYN_OK) return a->status;
    persist_numbers(sim, a);
    persist_particles(sim, a);
    emit_persist(sim, a);
    persist_neighbours(sim, a);
    persist_modules(sim, a);
    if (sim->system.contact) contact_persist(sim->system.contact, sim->x, a);
    return a->status;
}

pdyn_status pdyn_save(pdyn_sim *sim, const char *path) {
    struct archive a;
    if (!sim || !path) return PDYN_BAD_CALL;
    pdyn_status status = archive_create(sim->context, path, &a);
    if (status != PDYN_OK) return status;
    persist(sim, &a);
    return archive_close(&a);
}

pdyn_status pdyn_restore(pdyn_sim *sim, const char *path) {
    struct archive a;
    if (!sim || !path) return PDYN_BAD_CALL;
    pdyn_status status = archive_open(sim->context, path, &a);
    if (status != PDYN_OK) return status;
    solid_load_begin(sim);
    persist(sim, &a);
    return archive_close(&a);
}
