/* How long the next step is: fixed, or by the CFL condition; frames fall at exact multiples. */
#ifndef PDYN_TIMESTEP_H
#define PDYN_TIMESTEP_H

#include "sim.h"

struct moment { /* the end of the coming step */
    double h;
    bool frame; /* it is the next frame */
};

/* longest: s; INFINITY for what the scene asks for. */
struct moment timestep_choose(const struct pdyn_sim *sim, double longest);

/* Warns, once, of a fixed step that was cut short and is too long for that. */
void timestep_check(struct pdyn_sim *sim, double h, double residual);

/* The step was done: moves the simulation's time. */
void timestep_advance(struct pdyn_sim *sim, const struct moment *end);

#endif
