/* The same steps of a scene by several solvers, in one process and in turn. */
#ifndef CONTEST_H
#define CONTEST_H

#include "app.h"

struct contender {
    const char *solver;   /* as in solver.type */
    double load_ms;       /* of reading the scene: the least of all rounds, as are */
    double *step_ms;      /* steps: those of each step */
    double outer, linear; /* iterations, sums over the steps */
    double residual;      /* step residual, sum over the steps */
    char integrator[16];  /* the scene's */
    double bytes;         /* held when the steps are done */
    int particles;
    double *x;   /* particles x 3, when the steps are done */
    double size; /* m, diagonal of all particles at the start */
};

struct contest {
    struct scene_options scene;
    int steps, rounds;
    int contenders;
    struct contender *contender; /* contenders */
};

/* Every second round the other way round. An exit code. */
int contest_run(struct contest *contest);
void contest_free(struct contest *contest);

/* Means over the steps after the first, and what comes before: loading, and what the first step
 * takes beyond the mean. */
double contest_step_ms(const struct contest *contest, const struct contender *c);
double contest_prepare_ms(const struct contest *contest, const struct contender *c);

/* Root mean square distance of the results, over the size of the scene. */
double contest_difference(const struct contender *a, const struct contender *b);

/* After how many steps `a`, with all it took from the start, has caught up with b; 0: it is ahead
 * from the start, INFINITY: never. Beyond the steps measured the means decide. */
double contest_catches_up(const struct contest *contest, const struct contender *a,
                          const struct contender *b);

#endif
