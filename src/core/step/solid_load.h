/* Loads on solids: what fluid, contact and friction put on each of them at the end of a step. They
 * are summed up when somebody asks; a step only tells that the last sums are out of date. */
#ifndef PDYN_SOLID_LOAD_H
#define PDYN_SOLID_LOAD_H

#include "projdyn/projdyn.h"

struct pdyn_sim;

struct solid_load {
    double force[3];  /* N */
    double moment[3]; /* N m, about the origin of the world */
};

struct solid_loads {
    bool known;               /* the last local step is that of the last step */
    bool summed;              /* `solid` is of that one */
    struct solid_load *solid; /* scene.solids */
};

/* sim->loads stays NULL in a scene without solids. */
pdyn_status solid_load_create(struct pdyn_sim *sim);
void solid_load_free(struct pdyn_sim *sim);

/* Loads are not known from here on, until a step has ended. */
void solid_load_begin(struct pdyn_sim *sim);
void solid_load_end(struct pdyn_sim *sim);

/* *loads: one for each solid of the scene, of the last step; NULL where they are not known. */
pdyn_status solid_load_sum(const struct pdyn_sim *sim, const struct solid_load **loads);

#endif
