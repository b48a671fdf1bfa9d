/* Choice of the step length: fixed, or by the CFL condition; frames are at exact multiples of the
 * frame interval. */
#ifndef PDYN_TIMESTEP_H
#define PDYN_TIMESTEP_H

#include "sim/sim.h"

struct step_end {   /* end of the coming step */
    double h, time; /* s: length of the step; time at its end, exact at a frame */
    bool frame;     /* the step ends at the next frame, or goes beyond it */
    bool given;     /* the caller gave the length, so the step may pass a frame */
};

/* The number of equal steps of at most h that make up a time, s. */
double timestep_count(double time, double h);

/* Chooses the next step, at most `longest`, s; INFINITY: the scene decides. */
struct step_end timestep_choose(const struct pdyn_sim *sim, double longest);

/* Bounds of a step that a caller gives, s. */
#define TIMESTEP_SHORTEST 1e-9
#define TIMESTEP_LONGEST  1e3

/* A step of length h, s. */
struct step_end timestep_given(const struct pdyn_sim *sim, double h);

/* Counts a warning for an accepted step that is too long for pressure or speed. */
void timestep_check(struct pdyn_sim *sim, const struct step_end *end);

/* Advances the time of the simulation. */
void timestep_advance(struct pdyn_sim *sim, const struct step_end *end);

#endif
