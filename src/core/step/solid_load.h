/* Loads on solids: force and moment by fluid, contact and friction at the end of a step. They are
 * computed on demand; a step only marks the last ones as outdated. */
#ifndef PDYN_SOLID_LOAD_H
#define PDYN_SOLID_LOAD_H

#include "projdyn/projdyn.h"

struct pdyn_sim;

struct solid_load {
    double force[3];  /* N */
    double moment[3]; /* N m, about the origin of the world */
};

struct solid_loads {
    bool known;               /* the last local step belongs to the accepted state */
    bool summed;              /* `solid` is up to date */
    struct solid_load *solid; /* scene.solids */
};

/* sim->loads stays NULL in a scene without solids. */
pdyn_status solid_load_create(struct pdyn_sim *sim);
void solid_load_free(struct pdyn_sim *sim);

/* begin_step: loads are unknown until end_step. */
void solid_load_begin_step(struct pdyn_sim *sim);
void solid_load_end_step(struct pdyn_sim *sim);

/* Computes the loads after the last step: *loads, one per solid of the scene; NULL: unknown. */
pdyn_status solid_load_compute(const struct pdyn_sim *sim, const struct solid_load **loads);

#endif
