/* Particles that come and go. A body with inlets has all the particles of its budget from the
 * start; those that are not live rest at the origin and take no part: they have no neighbours, feel
 * nothing and count nowhere. A scene without inlets and outlets has no `struct live_particles`: all
 * particles are live. */
#ifndef PDYN_LIVE_PARTICLES_H
#define PDYN_LIVE_PARTICLES_H

#include "base/snapshot_file.h"
#include "sim.h"

struct emit_inlet {
    const struct scene_inlet *from;
    int number, body; /* number: in its body */
    double layers;    /* emitted so far, whole */
    bool closed;      /* the budget was used up */
};

struct live_particles {
    bool *live;  /* particles */
    int *vacant; /* bodies: how many of each are not live, */
    int *slot;   /* particles: these, a stack from the body's first on */
    int *near;   /* particles: scratch, those close to a layer */
    int inlets;
    struct emit_inlet *inlet;
    long emitted, removed; /* so far */
};

/* Begins with the particles that the bodies are filled with, and with the layers due at time 0.
 * Memory: 9 bytes per particle. */
pdyn_status live_particles_create(struct pdyn_sim *sim);
void live_particles_free(struct pdyn_sim *sim);

/* Tells the neighbour lists who takes part. */
void live_particles_tell(struct pdyn_sim *sim);

/* Particles that are not live do not move: s = x. */
void live_particles_hold(struct pdyn_sim *sim);

/* At the end of a step: removes what is in an outlet, then lets in the layers that are due. */
void live_particles_step(struct pdyn_sim *sim);

/* Writes or reads who is live, and what the inlets have done. */
void live_particles_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

/* How many particles of a body are live. */
int live_particles_count(const struct pdyn_sim *sim, int body);

static inline bool live_particles_has(const struct pdyn_sim *sim, int i) {
    return !sim->live || sim->live->live[i];
}

#endif
