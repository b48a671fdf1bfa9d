/* What a global solver sees: the model of E in one iteration (system.h), and the table that it
 * fills. */
#ifndef PDYN_SOLVER_H
#define PDYN_SOLVER_H

#include "context.h"
#include "projdyn/module.h"

struct system;

struct solve_goal {   /* when a solve may end: at the first of these */
    double tolerance; /* the model's gradient has fallen by this factor */
    double gain;      /* an iteration lowers the model by less than this part of the mean of all;
                         0: never; solvers that cannot tell ignore it */
    int iterations;   /* so many are done */
};

struct solver_type {
    const char *name, *summary;
    bool direct; /* factors a matrix: costs a factorisation where the constraints change every step
                  */
    bool keeps_multipliers; /* its memory of the last step; the next one then starts from s */
    size_t state_size;      /* zeroed before create */
    bool (*fits)(const struct system *system); /* NULL: any system */
    /* Refer to the system from now on. */
    pdyn_status (*create)(void *self, pdyn_context *context, struct system *system);
    /* Minimises the model of E that has the gradient -b at d = 0; without one-sided constraints
     * that is H y = b. A direct solver needs no goal and takes the sides of x. y: the d found,
     * particles x 3, zero on entry; b: particles x 3, may be overwritten; *iterations: 1 for a
     * direct solver. */
    pdyn_status (*solve)(void *self, double *b, double *y, const struct solve_goal *goal,
                         int *iterations);
    /* Drops what it keeps from step to step. NULL: nothing. */
    void (*forget)(void *self);
    void (*free)(void *self);
    /* Writes or reads what the next step depends on. NULL: nothing. */
    pdyn_status (*persist)(void *self, pdyn_archive *archive);
};

#endif
