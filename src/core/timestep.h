/* How long the next step is: fixed, or by the CFL condition; frames fall at exact multiples. */
#ifndef PDYN_TIMESTEP_H
#define PDYN_TIMESTEP_H

#include "sim.h"

struct moment { /* the end of the coming step */
    double h;
    bool frame; /* it is the next frame */
};

struct moment timestep_choose(const struct pdyn_sim *sim);

/* The step was done: moves the simulation's time. */
void timestep_advance(struct pdyn_sim *sim, const struct moment *end);

#endif
