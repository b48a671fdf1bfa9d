/* Loads on solids: force and moment by fluid, contact and friction at the end of a step. They are
 * computed on demand; a step only marks the last ones as outdated. */
#ifndef PDYN_SOLID_LOAD_H
#define PDYN_SOLID_LOAD_H

#include "projdyn/probe.h"

struct pdyn_sim;

struct load {         /* on a solid, or on a body or by a constraint (forces.h) */
    double force[3];  /* N */
    double moment[3]; /* N m, about the origin of the world */
};

enum { LOAD_SOURCES = PDYN_LOAD_CONTACT + 1 };

struct solid_loads {
    bool summed;                      /* `solid` is up to date */
    struct load *solid[LOAD_SOURCES]; /* scene.solids: by enum pdyn_load_source */
    double *force;                    /* boundary points x 3, N: scratch */
};

/* Adds a force, N, that acts at x, m. */
void load_add(struct load *load, const double *x, const double *force);
void load_copy(const struct load *load, double force[3], double moment[3]);

/* sim->loads stays NULL in a scene without solids. */
pdyn_status solid_load_create(struct pdyn_sim *sim);
void solid_load_free(struct pdyn_sim *sim);

/* The loads by a source after the last step, one per solid of the scene. NULL: unknown, or no
 * solids. */
const struct load *solid_load_compute(const struct pdyn_sim *sim, pdyn_load_source source);

#endif
