#include "live_particles.h"

#include "projdyn/vec3.h"

#include <string.h>

/* How close to others a particle may enter, in spacings: a stream keeps one, and in a fluid that is
 * in the way there is hardly a gap as wide. Particles closer than that would burst apart. */
static const double clearance = 0.8;

/* ---- the live and the others ----------------------------------------------------------------- */

/* A stack with the first particle on top. */
static void fill_vacant(struct pdyn_sim *sim, int b) {
    struct live_particles *e = sim->live;
    const pdyn_body *body = &sim->body[b];
    const struct scene_body *from = &sim->scene.body[b];
    int filled = from->is_surface ? body->count : from->start.count;
    e->vacant[b] = body->count - filled;
    for (int k = 0; k < filled; k++) e->live[body->first + k] = true;
    for (int k = 0; k < e->vacant[b]; k++)
        e->slot[body->first + k] = body->first + body->count - 1 - k;
}

static void rest_at_origin(struct pdyn_sim *sim, int i) {
    sim->pressure[i] = 0.0;
    memset(sim->x + 3 * i, 0, 3 * sizeof *sim->x);
    memset(sim->v + 3 * i, 0, 3 * sizeof *sim->v);
    memset(sim->constraint_acceleration + 3 * i, 0, 3 * sizeof *sim->constraint_acceleration);
    if (!sim->x_before) return;
    memset(sim->x_before + 3 * i, 0, 3 * sizeof *sim->x_before);
    memset(sim->v_before + 3 * i, 0, 3 * sizeof *sim->v_before);
}

static void remove_particle(struct pdyn_sim *sim, int b, int i) {
    struct live_particles *e = sim->live;
    rest_at_origin(sim, i);
    e->live[i] = false;
    e->slot[sim->body[b].first + e->vacant[b]++] = i;
    e->removed++;
}

/* A particle that appears has been in free fall until then. */
static void fall_until_now(struct pdyn_sim *sim, int i) {
    const double *g = sim->scene.settings.gravity, h = sim->history;
    for (int a = 0; sim->x_before && a < 3; a++) {
        int k = 3 * i + a;
        sim->v_before[k] = sim->v[k] - h * g[a];
        sim->x_before[k] = sim->x[k] - h * sim->v[k] + 0.5 * h * h * g[a];
    }
}

static void add_particle(struct pdyn_sim *sim, int b, const double x[3], const double v[3]) {
    struct live_particles *e = sim->live;
    int i = e->slot[sim->body[b].first + --e->vacant[b]];
    memcpy(sim->x + 3 * i, x, 3 * sizeof *x);
    memcpy(sim->v + 3 * i, v, 3 * sizeof *v);
    fall_until_now(sim, i);
    sim->density[i] = sim->body[b].rest_density;
    e->live[i] = true;
    e->emitted++;
}

/* ---- outlets --------------------------------------------------------------------------------- */

static bool takes(const struct scene_outlet *outlet, const double x[3]) {
    bool inside = true;
    for (int a = 0; a < 3; a++) inside &= x[a] >= outlet->box.min[a] && x[a] <= outlet->box.max[a];
    return inside != outlet->outside;
}

static bool leaves(const struct scene *scene, const double x[3]) {
    for (int k = 0; k < scene->outlets; k++)
        if (takes(&scene->outlet[k], x)) return true;
    return false;
}

static void drain(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies && sim->scene.outlets; b++) {
        const pdyn_body *body = &sim->body[b];
        for (int i = body->first; !body->triangles && i < body->first + body->count; i++)
            if (sim->live->live[i] && leaves(&sim->scene, sim->x + 3 * i))
                remove_particle(sim, b, i);
    }
}

/* ---- inlets ---------------------------------------------------------------------------------- */

static double spacing_of(const struct pdyn_sim *sim, const struct emit_inlet *inlet) {
    return 2.0 * sim->body[inlet->body].radius;
}

/* Layers that have entered up to now. */
static double layers_due(const struct pdyn_sim *sim, const struct emit_inlet *inlet) {
    const struct scene_inlet *from = inlet->from;
    double travelled = (sim->time - from->start) * from->speed / spacing_of(sim, inlet) + 1e-9;
    return travelled < 0.0 ? 0.0 : fmin(from->layers, floor(travelled) + 1.0);
}

/* Lists the body's particles close to the plane that has come this far from the inlet. */
static int find_near(const struct pdyn_sim *sim, const struct emit_inlet *inlet, double distance) {
    const struct scene_inlet *from = inlet->from;
    const pdyn_body *body = &sim->body[inlet->body];
    double place = vec3_dot(from->layer.x, from->direction) + distance;
    double reach = clearance * spacing_of(sim, inlet);
    int count = 0;
    for (int i = body->first; i < body->first + body->count; i++)
        if (sim->live->live[i] && fabs(vec3_dot(sim->x + 3 * i, from->direction) - place) < reach)
            sim->live->near[count++] = i;
    return count;
}

static bool is_clear(const struct pdyn_sim *sim, const double x[3], double reach, int near) {
    for (int k = 0; k < near; k++)
        if (vec3_distance(x, sim->x + 3 * sim->live->near[k]) < reach) return false;
    return true;
}

/* The next layer, where it has come to by now: it may have entered within the step. */
static void live_particles_layer(struct pdyn_sim *sim, struct emit_inlet *inlet) {
    const struct scene_inlet *from = inlet->from;
    double v[3] = {0}, spacing = spacing_of(sim, inlet);
    double distance = (sim->time - from->start) * from->speed - inlet->layers * spacing;
    int near = find_near(sim, inlet, distance);
    vec3_add(v, from->speed, from->direction);
    for (int k = 0; k < from->layer.count; k++) {
        const double *at = from->layer.x + 3 * (size_t)k;
        double x[3] = {at[0], at[1], at[2]};
        vec3_add(x, distance, from->direction);
        if (is_clear(sim, x, clearance * spacing, near)) add_particle(sim, inlet->body, x, v);
    }
    inlet->layers++;
}

static void close_inlet(struct pdyn_sim *sim, struct emit_inlet *inlet) {
    inlet->closed = true;
    context_log(sim->context, PDYN_LOG_WARNING,
                "body \"%s\": its budget of %d particles is used up at %g s; inlet %d is closed",
                sim->body[inlet->body].name, sim->scene.body[inlet->body].budget, sim->time,
                inlet->number);
}

static void pour(struct pdyn_sim *sim) {
    struct live_particles *e = sim->live;
    for (int k = 0; k < e->inlets; k++) {
        struct emit_inlet *inlet = &e->inlet[k];
        double due = layers_due(sim, inlet);
        while (!inlet->closed && inlet->layers < due)
            if (inlet->from->layer.count <= e->vacant[inlet->body])
                live_particles_layer(sim, inlet);
            else close_inlet(sim, inlet);
    }
}

/* ---- the life of it -------------------------------------------------------------------------- */

static int count_inlets(const struct pdyn_sim *sim) {
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) count += sim->scene.body[b].inlets;
    return count;
}

static pdyn_status allocate(struct pdyn_sim *sim, int inlets) {
    pdyn_context *c = sim->context;
    struct live_particles *e = sim->live = NEW_ARRAY(c, 1, struct live_particles);
    if (!e) return PDYN_NO_MEMORY;
    e->live = NEW_ARRAY(c, sim->objective.particles, bool);
    e->vacant = NEW_ARRAY(c, sim->bodies, int);
    e->slot = NEW_ARRAY(c, sim->objective.particles, int);
    e->near = NEW_ARRAY(c, sim->objective.particles, int);
    e->inlet = NEW_ARRAY(c, inlets, struct emit_inlet);
    e->inlets = inlets;
    bool good = e->live && e->vacant && e->slot && e->near && (e->inlet || !inlets);
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status live_particles_create(struct pdyn_sim *sim) {
    int inlets = count_inlets(sim);
    if (!inlets && !sim->scene.outlets) return PDYN_OK;
    pdyn_status status = allocate(sim, inlets);
    if (status != PDYN_OK) return status;
    struct emit_inlet *inlet = sim->live->inlet;
    for (int b = 0; b < sim->bodies; b++) {
        fill_vacant(sim, b);
        for (int k = 0; k < sim->scene.body[b].inlets; k++)
            *inlet++ = (struct emit_inlet){&sim->scene.body[b].inlet[k], k, b, 0.0, false};
    }
    pour(sim);
    return PDYN_OK;
}

void live_particles_free(struct pdyn_sim *sim) {
    pdyn_context *c = sim->context;
    struct live_particles *e = sim->live;
    if (!e) return;
    FREE_ARRAY(c, e->live, sim->objective.particles);
    FREE_ARRAY(c, e->vacant, sim->bodies);
    FREE_ARRAY(c, e->slot, sim->objective.particles);
    FREE_ARRAY(c, e->near, sim->objective.particles);
    FREE_ARRAY(c, e->inlet, e->inlets);
    FREE_ARRAY(c, sim->live, 1);
}

void live_particles_persist(struct pdyn_sim *sim, struct snapshot_file *a) {
    struct live_particles *e = sim->live;
    if (!e) return;
    size_t n = (size_t)sim->objective.particles;
    snapshot_file_bytes(a, e->live, n * sizeof *e->live);
    snapshot_file_bytes(a, e->slot, n * sizeof *e->slot);
    snapshot_file_bytes(a, e->vacant, (size_t)sim->bodies * sizeof *e->vacant);
    for (int k = 0; k < e->inlets; k++) {
        ARCHIVE(a, e->inlet[k].layers);
        ARCHIVE(a, e->inlet[k].closed);
    }
    ARCHIVE(a, e->emitted);
    ARCHIVE(a, e->removed);
}

void live_particles_tell(struct pdyn_sim *sim) {
    if (sim->live && sim->neighbours) neighbours_set_live(sim->neighbours, sim->live->live);
}

void live_particles_hold(struct pdyn_sim *sim) {
    for (int i = 0; sim->live && i < sim->objective.particles; i++)
        if (!sim->live->live[i])
            memcpy(sim->objective.s + 3 * i, sim->x + 3 * i, 3 * sizeof *sim->x);
}

void live_particles_step(struct pdyn_sim *sim) {
    struct live_particles *e = sim->live;
    if (!e) return;
    long before = e->emitted + e->removed;
    drain(sim);
    pour(sim);
    if (e->emitted + e->removed != before) live_particles_tell(sim);
}

int live_particles_count(const struct pdyn_sim *sim, int body) {
    return sim->body[body].count - (sim->live ? sim->live->vacant[body] : 0);
}
