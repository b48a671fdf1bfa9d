/* Holds: springs that a program ties between single particles and places (pdyn_hold),
 *
 *     u = x_i,     p = target,     J = 0,     E = w/2 |u - p|^2,     w: stiffness
 *
 * All holds of a body are one batch, behind all batches of the scene. */
#ifndef PDYN_HOLD_H
#define PDYN_HOLD_H

#include "base/snapshot_file.h"

struct pdyn_sim;

struct hold {
    int particle;
    double stiffness; /* N/m */
    double target[3]; /* m */
    bool released;    /* to be removed when batches are made */
};

struct control;
struct hold_group { /* the parameters of a batch: holds of one body */
    const struct control *control;
    size_t first; /* in control->hold */
    int count;
};

/* Removes released holds and makes the batches of all others anew. No solver refers to them. */
pdyn_status holds_make_batches(struct pdyn_sim *sim);

/* The hold of a particle that leaves the scene, if it has one, ends. */
void holds_leave(struct pdyn_sim *sim, int particle);
void holds_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);
void holds_free(struct pdyn_sim *sim); /* not their batches */

#endif
