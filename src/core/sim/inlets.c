#include "inlets.h"

#include "falling_jet.h"
#include "inlet_control.h"
#include "scene/inlet_motion.h"

#include <string.h>

/* Smallest distance, in spacings, from an entering particle to others: closer ones would burst
 * apart. */
static const double min_gap = 0.9;

/* How far in front of the opening an inlet lets a layer go, in spacings. One layer is always at or
 * behind the opening, so that nothing gets between the layers and a wall around it. */
static const double in_front = 0.5;

/* Inertia of a pushed particle, in masses. Rounding of positions makes larger ones inexact. */
static const double pushed_inertia = 1e7;

/* A layer that is compressed by more than this, on average, has nowhere to go. */
static const double max_compression = 0.05;

/* More particles that did not enter than this share of at least so many layers: a warning. */
static const double max_not_entered = 0.1;
enum { MANY_LAYERS = 10 };

/* ---- pushed particles ------------------------------------------------------------------------ */

static void set_pusher(struct pdyn_sim *sim, int i, int pusher) {
    struct live_particles *p = sim->live;
    bool any = p->pushed > 0;
    p->pushed += (pusher != 0) - (p->pusher[i] != 0);
    p->pusher[i] = pusher;
    p->inertia[i] = (pusher ? pushed_inertia : 1.0) * sim->objective.mass[i];
    sim->objective.weights_revision++;
    if (any != (p->pushed > 0)) control_find_anchored(sim);
}

/* The pusher of particles in a layer: an inlet pushes at most two at once. */
static int pusher_of(const struct pdyn_sim *sim, const struct live_inlet *inlet, double layer) {
    return 1 + 2 * (int)(inlet - sim->live->inlet) + (fmod(layer, 2.0) > 0.0);
}

static const struct live_inlet *inlet_of(const struct pdyn_sim *sim, int i) {
    return &sim->live->inlet[(sim->live->pusher[i] - 1) / 2];
}

/* From now on the inlet moves the particle; its state of the step before is set as if it had done
 * so then, too. */
static void push(struct pdyn_sim *sim, const struct live_inlet *inlet, int i) {
    double before = sim->time - sim->history, *x = sim->x + 3 * i;
    set_pusher(sim, i, pusher_of(sim, inlet, inlet->layers));
    inlet_velocity(inlet->from, sim->time, x, sim->v + 3 * i);
    memset(sim->constraint_acceleration + 3 * i, 0, 3 * sizeof *sim->constraint_acceleration);
    if (!sim->x_before) return;
    memcpy(sim->x_before + 3 * i, x, 3 * sizeof *x);
    inlet_carry(inlet->from, sim->time, before, sim->x_before + 3 * i);
    inlet_velocity(inlet->from, before, sim->x_before + 3 * i, sim->v_before + 3 * i);
}

void inlets_predict(struct pdyn_sim *sim) {
    for (int i = 0; sim->live && sim->live->pushed && i < sim->objective.particles; i++) {
        if (!particle_is_pushed(sim, i)) continue;
        double *s = sim->objective.s + 3 * i;
        memcpy(s, sim->x + 3 * i, 3 * sizeof *s);
        inlet_carry(inlet_of(sim, i)->from, sim->time, sim->objective.time, s);
    }
}

/* Others have moved pushed particles a little, as their inertia is finite. */
static void put_back(struct pdyn_sim *sim) {
    for (int i = 0; sim->live->pushed && i < sim->objective.particles; i++) {
        if (!particle_is_pushed(sim, i)) continue;
        const struct scene_inlet *from = inlet_of(sim, i)->from;
        double begin = sim->time - sim->last_h;
        memcpy(sim->x + 3 * i, sim->objective.s + 3 * i, 3 * sizeof *sim->x);
        inlet_velocity(from, sim->time, sim->x + 3 * i, sim->v + 3 * i);
        if (sim->v_before)
            inlet_velocity(from, begin, sim->x_before + 3 * i, sim->v_before + 3 * i);
    }
}

/* ---- layers ---------------------------------------------------------------------------------- */

static double spacing_of(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    return 2.0 * sim->body[inlet->body].radius;
}

static double layers_due(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    return inlet_layers(inlet->from, sim->time, spacing_of(sim, inlet));
}

/* Sorts the particles of fluids close to a plane `distance` in front of the opening. */
static void sort_near(struct pdyn_sim *sim, const struct live_inlet *inlet, double distance) {
    double spacing = spacing_of(sim, inlet), origin[3], normal[3];
    inlet_place(inlet->from, 0, distance, sim->time, origin);
    inlet_direction(inlet->from, sim->time, normal);
    layer_neighbours_sort(sim, origin, normal, (min_gap + INLET_STAGGER) * spacing, spacing);
}

/* Lists the sorted particles that are in the way of one at x in sim->live->scratch. */
static int find_near(struct pdyn_sim *sim, const struct live_inlet *inlet, const double x[3]) {
    return layer_neighbours_find(sim, x, min_gap * spacing_of(sim, inlet));
}

/* Whether the fluid in front of the opening is compressed, on average: it does not flow off. */
static bool is_blocked(struct pdyn_sim *sim, const struct live_inlet *inlet) {
    double distance = spacing_of(sim, inlet), sum = 0.0, x[3];
    int count = 0;
    sort_near(sim, inlet, distance);
    for (int k = 0; k < inlet->from->layer.count; k++) {
        inlet_place(inlet->from, k, distance, sim->time, x);
        int near = find_near(sim, inlet, x);
        for (int n = 0; n < near; n++) {
            int i = sim->live->scratch[n];
            double rest = sim->body[objective_body_of(&sim->objective, i)].rest_density;
            sum += sim->density[i] / rest - 1.0;
        }
        count += near;
    }
    return sum > max_compression * count;
}

/* Holds the particles that are in the way of one at x. Returns whether there are any. */
static bool hold_near(struct pdyn_sim *sim, const struct live_inlet *inlet, const double x[3]) {
    int near = find_near(sim, inlet, x);
    for (int n = 0; n < near; n++)
        if (!sim->live->pusher[sim->live->scratch[n]]) push(sim, inlet, sim->live->scratch[n]);
    return near > 0;
}

/* Emits the next layer at its current position: it may have entered within the step. Particles
 * that are in its way, as those of a pool in which the inlet begins, become part of it. */
static void emit_layer(struct pdyn_sim *sim, struct live_inlet *inlet) {
    const struct scene_inlet *from = inlet->from;
    double distance = inlet_travelled(from, sim->time) - inlet->layers * spacing_of(sim, inlet);
    sort_near(sim, inlet, distance);
    for (int k = 0; k < from->layer.count; k++) {
        double x[3];
        inlet_place(inlet->from, k, distance, sim->time, x);
        if (hold_near(sim, inlet, x)) {
            inlet->not_entered++;
            continue;
        }
        int i = live_particles_add(sim, inlet->body);
        memcpy(sim->x + 3 * i, x, sizeof x);
        push(sim, inlet, i);
    }
}

/* Lets go of layers that are far enough in front. */
static void let_go_of_layers(struct pdyn_sim *sim, struct live_inlet *inlet) {
    double free = inlet_layers_beyond(inlet->from, sim->time, spacing_of(sim, inlet), in_front);
    for (; inlet->free < fmin(free, inlet->layers); inlet->free++) {
        int pusher = pusher_of(sim, inlet, inlet->free);
        falling_jet_narrow(sim, inlet, pusher);
        for (int i = 0; i < sim->objective.particles; i++)
            if (sim->live->pusher[i] == pusher) set_pusher(sim, i, 0);
    }
}

static void warn_of_not_entered(struct pdyn_sim *sim, const struct live_inlet *inlet,
                                double count) {
    double share = inlet->not_entered / (inlet->layers * inlet->from->layer.count);
    if (!(count > 0.0) || inlet->layers < MANY_LAYERS || !(share > max_not_entered)) return;
    struct warning *w =
        sim_warning(sim, WARNING_BLOCKED, sim->body[inlet->body].name, (long)count, share);
    warnings_say(sim->context, w,
                 "%.0f of %.0f particles of inlet %d did not enter: others were in their way, and "
                 "less flows in than its speed says",
                 inlet->not_entered, inlet->layers * inlet->from->layer.count, inlet->number);
}

static void enter_layer(struct pdyn_sim *sim, struct live_inlet *inlet) {
    double before = inlet->not_entered;
    if (is_blocked(sim, inlet)) inlet->not_entered += inlet->from->layer.count;
    else emit_layer(sim, inlet);
    inlet->layers++;
    warn_of_not_entered(sim, inlet, inlet->not_entered - before);
}

static void close_inlet(struct pdyn_sim *sim, struct live_inlet *inlet) {
    inlet->closed = true;
    struct warning *w = sim_warning(sim, WARNING_BUDGET, sim->body[inlet->body].name, 1, 0.0);
    warnings_say(sim->context, w,
                 "its budget of %d particles is used up at %g s; inlet %d is closed",
                 sim->scene.body[inlet->body].budget, sim->time, inlet->number);
}

static void enter_due_layers(struct pdyn_sim *sim) {
    struct live_particles *p = sim->live;
    for (int k = 0; k < p->inlets; k++) {
        struct live_inlet *inlet = &p->inlet[k];
        double due = layers_due(sim, inlet);
        let_go_of_layers(sim, inlet);
        while (!inlet->closed && inlet->layers < due)
            if (inlet->from->layer.count <= p->vacant[inlet->body]) enter_layer(sim, inlet);
            else close_inlet(sim, inlet);
    }
}

double inlets_top_speed(const struct pdyn_sim *sim, double from, double to) {
    double speed = 0.0;
    for (int k = 0; sim->live && k < sim->live->inlets; k++)
        speed = fmax(speed, inlet_top_speed(sim->live->inlet[k].from, from, to));
    return speed;
}

bool inlets_step(struct pdyn_sim *sim) {
    unsigned before = sim->objective.weights_revision;
    put_back(sim);
    enter_due_layers(sim);
    return sim->objective.weights_revision != before;
}

/* ---- creation, saving ------------------------------------------------------------------------ */

void inlets_create(struct pdyn_sim *sim) {
    struct live_inlet *inlet = sim->live->inlet;
    if (!sim->live->inlets) return;
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; k < sim->scene.body[b].inlets; k++)
            *inlet++ =
                (struct live_inlet){.from = &sim->scene.body[b].inlet[k], .number = k, .body = b};
    memcpy(sim->live->inertia, sim->objective.mass,
           (size_t)sim->objective.particles * sizeof *sim->live->inertia);
    sim->objective.inertia = sim->live->inertia;
    enter_due_layers(sim);
}

/* At an open inlet the layers that are due have entered. The duration of the simulation, and with
 * it the number of layers, may differ from that of the saved one. */
static bool is_valid(const struct pdyn_sim *sim, const struct live_inlet *inlet) {
    double layers = inlet->layers, particles = layers * inlet->from->layer.count;
    double most =
        inlet_layers_beyond(inlet->from, sim->time, spacing_of(sim, inlet), -INLET_BEHIND);
    if (!(layers >= 0.0 && layers == floor(layers))) return false;
    if (!(inlet->free >= 0.0 && inlet->free <= layers && inlet->free == floor(inlet->free)))
        return false;
    if (!(inlet->not_entered >= 0.0 && inlet->not_entered <= particles)) return false;
    return layers <= most && (inlet->closed || layers >= layers_due(sim, inlet));
}

/* Only live particles have a pusher, which is one of the inlets. */
static bool pushers_are_valid(const struct pdyn_sim *sim, const int *pusher) {
    for (int i = 0; i < sim->objective.particles; i++)
        if (pusher[i] < 0 || pusher[i] > 2 * sim->live->inlets ||
            (pusher[i] && !sim->live->live[i]))
            return false;
    return true;
}

static void persist_pushers(struct pdyn_sim *sim, struct snapshot_file *file) {
    struct live_particles *p = sim->live;
    int *pusher = file->view.reading ? p->scratch : p->pusher;
    snapshot_file_bytes(file, pusher, (size_t)sim->objective.particles * sizeof *pusher);
    if (!file->view.reading || file->status != PDYN_OK) return;
    bool valid = pushers_are_valid(sim, pusher);
    snapshot_file_require(file, valid, "an inlet moves a particle that does not belong to it");
    for (int i = 0; valid && i < sim->objective.particles; i++) set_pusher(sim, i, pusher[i]);
}

void inlets_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    struct live_particles *p = sim->live;
    if (!p->inlets) return;
    for (int k = 0; k < p->inlets; k++) {
        inlet_control_persist(sim, k, file);
        SNAPSHOT(file, p->inlet[k].layers);
        SNAPSHOT(file, p->inlet[k].free);
        SNAPSHOT(file, p->inlet[k].not_entered);
        snapshot_file_flags(file, &p->inlet[k].closed, 1,
                            "the flag of an inlet is neither 0 nor 1");
        if (file->view.reading && file->status == PDYN_OK)
            snapshot_file_require(file, is_valid(sim, &p->inlet[k]),
                                  "the number of layers of an inlet does not belong to its time");
    }
    persist_pushers(sim, file);
}
