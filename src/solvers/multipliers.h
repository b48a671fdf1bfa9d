/* Multipliers of the scalar constraints of all matrix-free constraints, and the loops over them of
 * conjugate gradients with bounds (dual.c):
 *
 *     S lambda = rhs,     S = K^-1 + G A^-1 G',     lambda >= 0 */
#ifndef PDYN_MULTIPLIERS_H
#define PDYN_MULTIPLIERS_H

#include "projdyn/module.h"

struct multipliers {
    const pdyn_services *services;
    int count;
    double *lambda;    /* count, N m for a fluid, whose C has no unit: kept from step to step */
    double *value;     /* count: C at the last local step */
    double *stiffness; /* count: K of the damped model, N m for a fluid */
    double *squares;   /* count: |grad C|^2 */
    double *g;         /* count: C + G d - lambda / K: the residual */
    double *p;         /* count: direction; at both ends of a solve lambda - K max(0, C) */
    double *q;         /* count: S p */
    double *inverse;   /* count: of S's diagonal D */
    bool *in_solve;    /* count: takes part in the solve */
    double *sums;      /* partial sums for each parallel block */
};

/* Allocates the arrays of `count` constraints, with multipliers of 0; 0 frees them. After a failure
 * there are none. */
pdyn_status multipliers_reserve(struct multipliers *m, int count);

/* Takes value, gradients and stiffness of a matrix-free constraint, whose scalar ones begin at
 * `first`. mobility: particles of the system, diagonal of A^-1. p = lambda - K max(0, C), the
 * change of their force relative to the last local step. */
void multipliers_start(struct multipliers *m, int first, const pdyn_one_sided *at,
                       const pdyn_body *body, double eps, const double *mobility);

/* g, from q = G d; p = q = 0. Constraints far below 0 are left out of the solve. */
void multipliers_compute_residual(struct multipliers *m);

struct multipliers_step {
    double beyond, all; /* squares, in the norm of D: of the part beyond the bounds; of the step */
    double gradient;    /* N^2, square of the estimate of the model's gradient after it */
    double gz;          /* g . D^-1 g after it */
};

/* lambda += scale p, g -= scale q. */
struct multipliers_step multipliers_advance(struct multipliers *m, double scale);

/* p = D^-1 g + scale p; 0 where lambda = 0 and C < 0 stays so. */
void multipliers_update_direction(struct multipliers *m, double scale);

/* q, which is -G A^-1 G' p, becomes S p. Returns p . q and, in *gp, g . p. */
double multipliers_add_compliance(struct multipliers *m, double *gp);

/* p = the step from lambda to the bounds. */
void multipliers_find_clipping(struct multipliers *m);

/* Clips lambda; p = lambda - K max(0, C). */
void multipliers_find_change(struct multipliers *m);

/* Writes or reads lambda. */
pdyn_status multipliers_persist(struct multipliers *m, int particles, pdyn_snapshot *snapshot);

#endif
