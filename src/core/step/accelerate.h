/* Accelerations of classic Projective Dynamics: from the last iterates they extrapolate where the
 * next ones would go. What they propose is taken where it lowers E; elsewhere the global step is,
 * and they start anew. References for who compares methods: the newton step needs none. */
#ifndef PDYN_ACCELERATE_H
#define PDYN_ACCELERATE_H

#include "objective/objective.h"

struct acceleration;

struct acceleration_type {
    const char *name, *summary;
    /* Vectors (particles x 3) to keep; 0: nothing is accelerated. */
    int vectors;
    /* Changes the direction of the global step from x; false: it cannot say anything yet. */
    bool (*propose)(struct acceleration *a, const double *x, double *direction);
};

enum { ANDERSON_WINDOW = 5 };

struct acceleration {
    const struct acceleration_type *type;
    struct objective *objective;
    double **vector; /* type->vectors: the type's own */
    double *plain;   /* particles x 3: the direction of the global step */
    int seen;        /* iterations since the start */
    double omega;    /* of chebyshev */
};

pdyn_status acceleration_create(struct acceleration *a, const struct acceleration_type *type,
                                struct objective *objective);
void acceleration_free(struct acceleration *a); /* zeroed or created */
/* A new step, or a proposal that was not taken: forgets what it has seen. */
void acceleration_start(struct acceleration *a);
/* Keeps `direction` in a->plain and changes it; false: there is nothing to propose. */
bool acceleration_propose(struct acceleration *a, const double *x, double *direction);

#endif
