/* Particles that pass a surface: fluid through a sheet, a soft body or a solid, and cloth through a
 * solid in a scene without contact. Observes a step and changes nothing. How a path passes a
 * surface: crossing_path.h. */
#ifndef PDYN_CROSSINGS_H
#define PDYN_CROSSINGS_H

#include "base/snapshot_file.h"

struct pdyn_sim;
struct crossings;

/* Creates sim->crossings; it stays NULL in a scene in which nothing can be passed. After a failure
 * it is to be freed, too. */
pdyn_status crossings_create(struct pdyn_sim *sim);
void crossings_free(struct pdyn_sim *sim);

/* Finds the particles that pass a surface in a step of length h, s, from sim->x to sim->x_next. */
void crossings_step(struct pdyn_sim *sim, double h);

/* Number of particles that are on the other side of a surface than at the start, or were when they
 * left the scene. */
long crossings_total(const struct pdyn_sim *sim);

/* Raises a warning for every surface that particles are beyond. It keeps the largest number of
 * particles of the run, and its time. */
void crossings_warn(struct pdyn_sim *sim);

/* Particles were placed anew: they are not beyond any surface. */
void crossings_forget(struct pdyn_sim *sim, int first, int count);

/* A particle left the scene: its slot is free for a new one. It stays counted. */
void crossings_leave(struct pdyn_sim *sim, int particle);

void crossings_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
