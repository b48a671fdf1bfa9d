/* Particles that enter through inlets (inlets.c) and leave through outlets. */
#include "live_particles.h"

#include "crossings.h"
#include "hold.h"
#include "inlets.h"

#include <limits.h>
#include <string.h>

/* ---- live and vacant particles --------------------------------------------------------------- */

/* Initialises the stack of vacant particles, lowest index on top. */
static void init_vacant(struct pdyn_sim *sim, int b) {
    struct live_particles *p = sim->live;
    const pdyn_body *body = &sim->body[b];
    const struct scene_body *from = &sim->scene.body[b];
    int filled = from->has_mesh ? body->count : from->start.count;
    p->vacant[b] = body->count - filled;
    for (int k = 0; k < filled; k++) p->live[body->first + k] = true;
    for (int k = 0; from->is_rigid && k < RIGID_POINTS; k++)
        p->live[body->first + body->count + k] = true;
    for (int k = 0; k < p->vacant[b]; k++)
        p->slot[body->first + k] = body->first + body->count - 1 - k;
}

static void reset_particle(struct pdyn_sim *sim, int i) {
    double *const vectors[] = {sim->x,        sim->v,        sim->constraint_acceleration,
                               sim->x_before, sim->v_before, sim->control.force};
    sim->pressure[i] = 0.0;
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        if (vectors[k]) memset(vectors[k] + 3 * (size_t)i, 0, 3 * sizeof *vectors[k]);
}

static void remove_particle(struct pdyn_sim *sim, int b, int i) {
    struct live_particles *p = sim->live;
    reset_particle(sim, i);
    holds_leave(sim, i);
    crossings_leave(sim, i);
    p->live[i] = false;
    p->slot[sim->body[b].first + p->vacant[b]++] = i;
    p->removed++;
}

int live_particles_add(struct pdyn_sim *sim, int b) {
    struct live_particles *p = sim->live;
    int i = p->slot[sim->body[b].first + --p->vacant[b]];
    sim->density[i] = sim->body[b].rest_density;
    p->live[i] = true;
    p->emitted++;
    return i;
}

/* ---- outlets --------------------------------------------------------------------------------- */

static bool outlet_contains(const struct scene_outlet *outlet, const double x[3]) {
    return box_contains(&outlet->box, x) != outlet->outside;
}

bool outlets_contain(const struct scene *scene, const double x[3]) {
    for (int k = 0; k < scene->outlets; k++)
        if (outlet_contains(&scene->outlet[k], x)) return true;
    return false;
}

static void remove_outflow(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies && sim->scene.outlets; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            if (sim->live->live[i] && !particle_is_pushed(sim, i) &&
                outlets_contain(&sim->scene, sim->x + 3 * i))
                remove_particle(sim, b, i);
    }
}

/* ---- creation, saving, steps ----------------------------------------------------------------- */

static int count_inlets(const struct pdyn_sim *sim) {
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) count += sim->scene.body[b].inlets;
    return count;
}

static bool resize_arrays(struct pdyn_sim *sim, enum array_action action) {
    struct live_particles *p = sim->live;
    const struct array_entry table[] = {
        ARRAY(p->live, sim->objective.particles),
        ARRAY(p->vacant, sim->bodies),
        ARRAY(p->slot, sim->objective.particles),
        ARRAY(p->scratch, sim->objective.particles),
        ARRAY(p->near.bucket, p->inlets ? sim->objective.particles : 0),
        ARRAY(p->near.next, p->inlets ? sim->objective.particles : 0),
        ARRAY(p->pusher, p->inlets ? sim->objective.particles : 0),
        ARRAY(p->inertia, p->inlets ? sim->objective.particles : 0),
        ARRAY(p->inlet, p->inlets),
    };
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
}

static pdyn_status allocate(struct pdyn_sim *sim, int inlets) {
    sim->live = NEW_ARRAY(sim->context, 1, struct live_particles);
    if (!sim->live) return PDYN_NO_MEMORY;
    sim->live->inlets = inlets;
    return resize_arrays(sim, ARRAYS_ALLOCATE) ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status live_particles_create(struct pdyn_sim *sim) {
    int inlets = count_inlets(sim);
    if (!inlets && !sim->scene.outlets) return PDYN_OK;
    pdyn_status status = allocate(sim, inlets);
    if (status != PDYN_OK) return status;
    for (int b = 0; b < sim->bodies; b++) init_vacant(sim, b);
    inlets_create(sim);
    return PDYN_OK;
}

void live_particles_free(struct pdyn_sim *sim) {
    if (!sim->live) return;
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(sim->context, sim->live, 1);
}

/* Whether the stack of body b lists each of its particles that are not live once. scratch marks
 * the particles that are listed. */
static bool stack_is_valid(const struct pdyn_sim *sim, int b) {
    const struct live_particles *p = sim->live;
    const pdyn_body *body = &sim->body[b];
    int vacant = 0, end = body->first + body->count;
    for (int i = body->first; i < end; i++) vacant += !p->live[i], p->scratch[i] = 0;
    if (p->vacant[b] != vacant) return false;
    for (int k = body->first; k < body->first + vacant; k++) {
        int i = p->slot[k];
        if (i < body->first || i >= end || p->live[i] || p->scratch[i]++) return false;
    }
    return true;
}

static void require_valid(struct pdyn_sim *sim, struct snapshot_file *file) {
    if (!file->view.reading || file->status != PDYN_OK) return;
    for (int b = 0; b < sim->bodies; b++)
        snapshot_file_require(file, stack_is_valid(sim, b),
                              "its list of particles that are not live is wrong");
}

void live_particles_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    static const char total[] = "the number of particles emitted or removed is out of range";
    struct live_particles *p = sim->live;
    if (!p) return;
    size_t n = (size_t)sim->objective.particles;
    snapshot_file_flags(file, p->live, n, "the flag of a live particle is neither 0 nor 1");
    snapshot_file_bytes(file, p->slot, n * sizeof *p->slot);
    snapshot_file_bytes(file, p->vacant, (size_t)sim->bodies * sizeof *p->vacant);
    snapshot_file_long(file, &p->emitted, LONG_MAX / 4, total);
    snapshot_file_long(file, &p->removed, LONG_MAX / 4, total);
    require_valid(sim, file);
    inlets_persist(sim, file);
}

void live_particles_update_lists(struct pdyn_sim *sim) {
    if (sim->live && sim->objective.neighbours)
        neighbours_set_live(sim->objective.neighbours, sim->live->live, sim->live->pusher);
}

void live_particles_predict(struct pdyn_sim *sim) {
    for (int i = 0; sim->live && i < sim->objective.particles; i++)
        if (!sim->live->live[i])
            memcpy(sim->objective.s + 3 * i, sim->x + 3 * i, 3 * sizeof *sim->x);
    inlets_predict(sim);
}

void live_particles_step(struct pdyn_sim *sim) {
    struct live_particles *p = sim->live;
    if (!p) return;
    long removed = p->removed;
    remove_outflow(sim);
    if (inlets_step(sim) || p->removed != removed) live_particles_update_lists(sim);
}

int live_particles_count(const struct pdyn_sim *sim, int body) {
    return sim->body[body].count - (sim->live ? sim->live->vacant[body] : 0);
}

double live_mass(const struct pdyn_sim *sim) {
    double mass = 0.0;
    for (int i = 0; i < sim->objective.particles; i++)
        if (particle_is_live(sim, i)) mass += sim->objective.mass[i];
    return mass;
}
