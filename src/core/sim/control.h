/* What a program has changed in a simulation between two steps (projdyn/control.h): forces,
 * gravity, parameters, holds, keys of solids. */
#ifndef PDYN_STEP_CONTROL_H
#define PDYN_STEP_CONTROL_H

#include "base/snapshot_file.h"
#include "hold.h"

struct control {
    bool driven;    /* something was changed: nothing bounds the energy of the scene */
    bool stale;     /* constraints have changed: batches of holds, and solvers, are out of date */
    double gravity; /* m/s^2: the largest |g| so far, with keys the largest of all keys */
    double *force;  /* particles x 3, N; NULL: none was ever set */
    struct hold *hold; /* holds */
    size_t holds, room;
    int *hold_of; /* particles: 1 + index of its hold; 0: none. NULL: there never was a hold */
    struct hold_group *group; /* bodies: of the batches of holds, the last of the objective */
    int batches;              /* number of these */
};

/* Whether a step is being computed, where an observer may only read the simulation: a bad call of
 * the function. */
bool control_is_in_step(const char *function, const struct pdyn_sim *sim);

/* The same, or the simulation has failed. */
bool control_refuses(const char *function, const struct pdyn_sim *sim);

/* After changes of constraints: makes the batches of holds and the linear solvers anew. After a
 * failure the simulation takes no further step. */
pdyn_status control_settle(struct pdyn_sim *sim);

/* Gravity from now on; control.gravity becomes at least |gravity|. */
void control_set_gravity(struct pdyn_sim *sim, const double gravity[3]);

/* Updates sim->anchored and the bodies that contact knows as held, after changes of holds, of
 * constraints that are off, and of particles that inlets move. */
void control_find_anchored(struct pdyn_sim *sim);

/* Writes or reads what was changed; settles it after reading. */
void control_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);
void control_free(struct pdyn_sim *sim);

#endif
