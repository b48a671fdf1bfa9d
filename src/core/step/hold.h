/* Holds: pins that a program puts on single particles (pdyn_hold). Each is a constraint of the type
 * "pin" with one element, and a batch of its own behind all others of the objective. */
#ifndef PDYN_HOLD_H
#define PDYN_HOLD_H

#include "base/snapshot_file.h"

struct pdyn_sim;

struct hold {
    int particle;
    double stiffness; /* N/m */
    double target[3]; /* m */
    bool released;    /* to be removed when batches are made */
    int index;        /* of the particle in its body */
    double key[4];    /* of the pin's path */
    void *params;     /* of the type "pin"; refers to index and key */
};

/* Removes released holds and makes the batches of all others anew. No solver refers to them. */
pdyn_status holds_make_batches(struct pdyn_sim *sim);

/* The hold of a particle that leaves the scene, if it has one, ends. */
void holds_leave(struct pdyn_sim *sim, int particle);
void holds_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);
void holds_free(struct pdyn_sim *sim); /* not their batches */

#endif
