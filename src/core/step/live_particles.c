/* Particles that enter through inlets and leave through outlets. */
#include "live_particles.h"

#include "projdyn/vec3.h"

#include <limits.h>
#include <string.h>

/* Smallest distance, in spacings, from an entering particle to others. The layers of an inlet are
 * one spacing apart; in fluid in front of the inlet there is hardly a gap of that size. Particles
 * closer than this would burst apart. */
static const double min_gap = 0.8;

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
    sim->pressure[i] = 0.0;
    memset(sim->x + 3 * i, 0, 3 * sizeof *sim->x);
    memset(sim->v + 3 * i, 0, 3 * sizeof *sim->v);
    memset(sim->constraint_acceleration + 3 * i, 0, 3 * sizeof *sim->constraint_acceleration);
    if (!sim->x_before) return;
    memset(sim->x_before + 3 * i, 0, 3 * sizeof *sim->x_before);
    memset(sim->v_before + 3 * i, 0, 3 * sizeof *sim->v_before);
}

static void remove_particle(struct pdyn_sim *sim, int b, int i) {
    struct live_particles *p = sim->live;
    reset_particle(sim, i);
    p->live[i] = false;
    p->slot[sim->body[b].first + p->vacant[b]++] = i;
    p->removed++;
}

/* Sets the history of an emitted particle to free fall over the previous step. */
static void set_free_fall_history(struct pdyn_sim *sim, int i) {
    const double *g = sim->scene.settings.gravity, h = sim->history;
    for (int a = 0; sim->x_before && a < 3; a++) {
        int k = 3 * i + a;
        sim->v_before[k] = sim->v[k] - h * g[a];
        sim->x_before[k] = sim->x[k] - h * sim->v[k] + 0.5 * h * h * g[a];
    }
}

static void emit_particle(struct pdyn_sim *sim, int b, const double x[3], const double v[3]) {
    struct live_particles *p = sim->live;
    int i = p->slot[sim->body[b].first + --p->vacant[b]];
    memcpy(sim->x + 3 * i, x, 3 * sizeof *x);
    memcpy(sim->v + 3 * i, v, 3 * sizeof *v);
    set_free_fall_history(sim, i);
    sim->density[i] = sim->body[b].rest_density;
    p->live[i] = true;
    p->emitted++;
}

/* ---- outlets --------------------------------------------------------------------------------- */

static bool outlet_contains(const struct scene_outlet *outlet, const double x[3]) {
    return scene_box_contains(&outlet->box, x) != outlet->outside;
}

static bool is_in_outlet(const struct scene *scene, const double x[3]) {
    for (int k = 0; k < scene->outlets; k++)
        if (outlet_contains(&scene->outlet[k], x)) return true;
    return false;
}

static void remove_outflow(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies && sim->scene.outlets; b++) {
        const pdyn_body *body = &sim->body[b];
        for (int i = body->first; !body->triangles && i < body->first + body->count; i++)
            if (sim->live->live[i] && is_in_outlet(&sim->scene, sim->x + 3 * i))
                remove_particle(sim, b, i);
    }
}

/* ---- inlets ---------------------------------------------------------------------------------- */

static double spacing_of(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    return 2.0 * sim->body[inlet->body].radius;
}

/* Number of layers that would have entered by the current time if the inlet never ended. */
static double layers_without_end(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    const struct scene_inlet *from = inlet->from;
    double travelled = (sim->time - from->start) * from->speed / spacing_of(sim, inlet) + 1e-9;
    return travelled < 0.0 ? 0.0 : floor(travelled) + 1.0;
}

/* Number of layers that should have entered by the current time. */
static double layers_due(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    return fmin(inlet->from->layers, layers_without_end(sim, inlet));
}

/* Lists the live particles of fluids close to a plane `distance` in front of the inlet. */
static int find_near(const struct pdyn_sim *sim, const struct live_inlet *inlet, double distance) {
    const struct scene_inlet *from = inlet->from;
    double place = vec3_dot(from->layer.x, from->direction) + distance;
    double reach = min_gap * spacing_of(sim, inlet);
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        for (int i = body->first; !body->triangles && i < body->first + body->count; i++)
            if (sim->live->live[i] &&
                fabs(vec3_dot(sim->x + 3 * i, from->direction) - place) < reach)
                sim->live->near[count++] = i;
    }
    return count;
}

static bool is_clear(const struct pdyn_sim *sim, const double x[3], double reach, int near) {
    for (int k = 0; k < near; k++)
        if (vec3_distance(x, sim->x + 3 * sim->live->near[k]) < reach) return false;
    return true;
}

/* Emits the next layer at its current position: it may have entered within the step. */
static void emit_layer(struct pdyn_sim *sim, struct live_inlet *inlet) {
    const struct scene_inlet *from = inlet->from;
    double v[3] = {0}, spacing = spacing_of(sim, inlet);
    double distance = (sim->time - from->start) * from->speed - inlet->layers * spacing;
    int near = find_near(sim, inlet, distance);
    vec3_add(v, from->speed, from->direction);
    for (int k = 0; k < from->layer.count; k++) {
        const double *at = from->layer.x + 3 * (size_t)k;
        double x[3] = {at[0], at[1], at[2]};
        vec3_add(x, distance, from->direction);
        if (is_clear(sim, x, min_gap * spacing, near)) emit_particle(sim, inlet->body, x, v);
    }
    inlet->layers++;
}

static void close_inlet(struct pdyn_sim *sim, struct live_inlet *inlet) {
    inlet->closed = true;
    struct warning *w = warnings_count(&sim->warnings, WARNING_BUDGET, sim->body[inlet->body].name,
                                       sim->time, 1, 0.0);
    warnings_say(sim->context, w,
                 "its budget of %d particles is used up at %g s; inlet %d is closed",
                 sim->scene.body[inlet->body].budget, sim->time, inlet->number);
}

static void emit_due_layers(struct pdyn_sim *sim) {
    struct live_particles *p = sim->live;
    for (int k = 0; k < p->inlets; k++) {
        struct live_inlet *inlet = &p->inlet[k];
        double due = layers_due(sim, inlet);
        while (!inlet->closed && inlet->layers < due)
            if (inlet->from->layer.count <= p->vacant[inlet->body]) emit_layer(sim, inlet);
            else close_inlet(sim, inlet);
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
        ARRAY(p->near, sim->objective.particles),
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
    struct live_inlet *inlet = sim->live->inlet;
    for (int b = 0; b < sim->bodies; b++) {
        init_vacant(sim, b);
        for (int k = 0; k < sim->scene.body[b].inlets; k++)
            *inlet++ = (struct live_inlet){&sim->scene.body[b].inlet[k], k, b, 0.0, false};
    }
    emit_due_layers(sim);
    return PDYN_OK;
}

void live_particles_free(struct pdyn_sim *sim) {
    if (!sim->live) return;
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(sim->context, sim->live, 1);
}

/* Whether the stack of body b lists each of its particles that are not live once. near: scratch,
 * marks the particles that are listed. */
static bool stack_is_valid(const struct pdyn_sim *sim, int b) {
    const struct live_particles *p = sim->live;
    const pdyn_body *body = &sim->body[b];
    int vacant = 0, end = body->first + body->count;
    for (int i = body->first; i < end; i++) vacant += !p->live[i], p->near[i] = 0;
    if (p->vacant[b] != vacant) return false;
    for (int k = body->first; k < body->first + vacant; k++) {
        int i = p->slot[k];
        if (i < body->first || i >= end || p->live[i] || p->near[i]++) return false;
    }
    return true;
}

/* An open inlet has emitted the layers that are due. The duration of the simulation, and with it
 * the last layer, may differ from that of the saved one: a layer may be missing at the end of a
 * shorter duration, and there may be further layers after the end of it. */
static bool inlet_is_valid(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    double layers = inlet->layers;
    if (!(layers >= 0.0 && layers == floor(layers))) return false;
    if (layers > layers_without_end(sim, inlet)) return false;
    return inlet->closed || layers_due(sim, inlet) - layers <= 1.0;
}

static void require_valid(struct pdyn_sim *sim, struct snapshot_file *a) {
    struct live_particles *p = sim->live;
    if (!a->view.reading || a->status != PDYN_OK) return;
    for (int b = 0; b < sim->bodies; b++)
        snapshot_file_require(a, stack_is_valid(sim, b),
                              "its list of particles that are not live is wrong");
    for (int k = 0; k < p->inlets; k++)
        snapshot_file_require(a, inlet_is_valid(sim, &p->inlet[k]),
                              "the number of layers of an inlet does not belong to its time");
}

void live_particles_persist(struct pdyn_sim *sim, struct snapshot_file *a) {
    static const char total[] = "the number of particles emitted or removed is out of range";
    struct live_particles *p = sim->live;
    if (!p) return;
    size_t n = (size_t)sim->objective.particles;
    snapshot_file_flags(a, p->live, n, "the flag of a live particle is neither 0 nor 1");
    snapshot_file_bytes(a, p->slot, n * sizeof *p->slot);
    snapshot_file_bytes(a, p->vacant, (size_t)sim->bodies * sizeof *p->vacant);
    for (int k = 0; k < p->inlets; k++) {
        SNAPSHOT(a, p->inlet[k].layers);
        snapshot_file_flags(a, &p->inlet[k].closed, 1, "the flag of an inlet is neither 0 nor 1");
    }
    snapshot_file_long(a, &p->emitted, LONG_MAX / 4, total);
    snapshot_file_long(a, &p->removed, LONG_MAX / 4, total);
    require_valid(sim, a);
}

void live_particles_update_lists(struct pdyn_sim *sim) {
    if (sim->live && sim->neighbours) neighbours_set_live(sim->neighbours, sim->live->live);
}

void live_particles_fix_inactive(struct pdyn_sim *sim) {
    for (int i = 0; sim->live && i < sim->objective.particles; i++)
        if (!sim->live->live[i])
            memcpy(sim->objective.s + 3 * i, sim->x + 3 * i, 3 * sizeof *sim->x);
}

void live_particles_step(struct pdyn_sim *sim) {
    struct live_particles *p = sim->live;
    if (!p) return;
    long before = p->emitted + p->removed;
    remove_outflow(sim);
    emit_due_layers(sim);
    if (p->emitted + p->removed != before) live_particles_update_lists(sim);
}

int live_particles_count(const struct pdyn_sim *sim, int body) {
    return sim->body[body].count - (sim->live ? sim->live->vacant[body] : 0);
}
