/* Particles that enter and leave the scene. A body with inlets has all particles of its budget from
 * the start. Particles that are not live rest at the origin and take no part: no neighbours, no
 * forces, no contribution to any sum. In a scene without inlets and outlets sim->live is NULL and
 * all particles are live. */
#ifndef PDYN_LIVE_PARTICLES_H
#define PDYN_LIVE_PARTICLES_H

#include "base/snapshot_file.h"
#include "layer_neighbours.h"
#include "sim.h"

struct live_inlet {
    struct scene_inlet *from;
    int number, body;   /* `number`: index in the body */
    double layers;      /* number of layers that were due so far, a whole number */
    double free;        /* number of these layers that move freely, a whole number */
    double not_entered; /* number of their particles that did not enter, a whole number */
    bool closed;        /* the budget is used up */
};

struct live_particles {
    bool *live;  /* particles */
    int *vacant; /* bodies: number of particles that are not live */
    int *slot;   /* particles: for every body, from its first particle on, a stack of particles that
                    are not live */
    int *scratch; /* particles: indices of those near a place of a layer, or marks */
    struct layer_neighbours near; /* arrays NULL: there are no inlets */
    int *pusher; /* particles: which layer of which inlet it is pushed in (inlets.c); 0: none. NULL:
                    there are no inlets */
    double *inertia; /* particles, kg: of the objective. NULL: no inlets */
    int pushed;      /* number of particles that inlets move */
    int inlets;
    struct live_inlet *inlet;
    long emitted, removed; /* totals */
};

/* Makes the particles of "fill" live and emits the layers due at time 0. Does nothing in a scene
 * without inlets and outlets. Memory: 9 bytes per particle, 29 with inlets. */
pdyn_status live_particles_create(struct pdyn_sim *sim);
void live_particles_free(struct pdyn_sim *sim);

/* Informs the neighbour lists which particles are live. */
void live_particles_update_lists(struct pdyn_sim *sim);

/* Makes a vacant particle of the body live, at rest at the origin, and returns its index. */
int live_particles_add(struct pdyn_sim *sim, int body);

/* Sets the prediction s of particles that are not live, which stay where they are, and of those
 * that inlets move. */
void live_particles_predict(struct pdyn_sim *sim);

/* Whether a particle at x is in an outlet of the scene. */
bool outlets_contain(const struct scene *scene, const double x[3]);

/* Call at the end of a step: removes particles in outlets, then emits the layers that are due. */
void live_particles_step(struct pdyn_sim *sim);

/* Saves or reads which particles are live, and the state of the inlets. */
void live_particles_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

/* Number of live particles of a body. */
int live_particles_count(const struct pdyn_sim *sim, int body);

static inline bool particle_is_live(const struct pdyn_sim *sim, int i) {
    return !sim->live || sim->live->live[i];
}

/* Mass of all live particles, kg. */
double live_mass(const struct pdyn_sim *sim);

/* Whether an inlet moves the particle. */
static inline bool particle_is_pushed(const struct pdyn_sim *sim, int i) {
    return sim->live && sim->live->inlets && sim->live->pusher[i];
}

#endif
