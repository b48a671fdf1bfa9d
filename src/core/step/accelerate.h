/* Accelerations of classic Projective Dynamics: they extrapolate the next iterate from the last
 * ones. A proposal is accepted if it lowers E; otherwise the plain global step is used and the
 * acceleration restarts. They serve comparisons of methods; the step type "newton" needs none. */
#ifndef PDYN_ACCELERATE_H
#define PDYN_ACCELERATE_H

#include "objective/objective.h"

struct acceleration;

struct acceleration_type {
    const char *name, *summary;
    /* number of vectors (particles x 3) that the type stores; 0: no acceleration */
    int vectors;
    /* Changes `direction`, the global step from x; false: no proposal yet. */
    bool (*propose)(struct acceleration *a, const double *x, double *direction);
};

enum { ANDERSON_WINDOW = 5 };

struct acceleration {
    const struct acceleration_type *type;
    struct objective *objective;
    double **vector; /* type->vectors: storage of the type */
    double *plain;   /* particles x 3: direction of the plain global step */
    int iterations;  /* iterations since the restart */
    double omega;    /* omega of "chebyshev" */
};

pdyn_status acceleration_create(struct acceleration *a, const struct acceleration_type *type,
                                struct objective *objective);
void acceleration_free(struct acceleration *a); /* zeroed or created */
/* Restarts: at the start of a step, or after a proposal that was not accepted. */
void acceleration_start(struct acceleration *a);
/* Stores `direction` in a->plain and changes it; false: no proposal, `direction` is unchanged. */
bool acceleration_propose(struct acceleration *a, const double *x, double *direction);

#endif
