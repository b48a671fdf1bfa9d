/* Inlets. A layer of particles appears one spacing behind the opening, and the inlet moves it with
 * its velocity, whatever stands in front of it, to half a spacing in front: it is the piston of the
 * nozzle, and the flow is the area times the speed. Particles of such layers are pushed: they act
 * on others, have so much inertia in the minimisation that others do not act on them, and have no
 * neighbours on the wall around the opening. */
#ifndef PDYN_INLETS_H
#define PDYN_INLETS_H

#include "live_particles.h"

/* Lists the inlets of sim->live and emits the layers due at time 0. */
void inlets_create(struct pdyn_sim *sim);

/* Sets the prediction s of pushed particles: they move with the inlet, without gravity. */
void inlets_predict(struct pdyn_sim *sim);

/* At the end of a step: sets pushed particles to their exact places in the inlet, and emits the
 * layers that are due. Returns whether the set of pushed particles has changed. */
bool inlets_step(struct pdyn_sim *sim);

/* Upper bound of the speed of pushed particles between two times, s: m/s. */
double inlets_top_speed(const struct pdyn_sim *sim, double from, double to);

/* Saves or reads the state of the inlets. */
void inlets_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
