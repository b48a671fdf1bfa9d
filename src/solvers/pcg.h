/* Preconditioned conjugate gradients for H y = b (Hestenes and Stiefel 1952), without a matrix.
 *
 * A direction is made conjugate to the last one only, by the product H p that is stored for it
 * (Polak-Ribiere form). This is the usual method while H stays the same; and it lets the first
 * iteration of a solve continue from the last direction of the solve before, if H changed little.
 */
#ifndef PDYN_PCG_H
#define PDYN_PCG_H

#include "projdyn/module.h"

/* z = P^-1 r, where P approximates H, symmetric positive definite. */
typedef void pcg_preconditioner(void *self, const double *r, double *z);

struct pcg {
    pdyn_model *model;
    pcg_preconditioner *precondition;
    void *self;        /* its first argument */
    double *z, *p, *q; /* vectors: preconditioned residual; direction; H p */
    double curvature;  /* p . H p of the last direction; 0: there is none */
    double *partial;   /* partial sums, one per parallel block */
};

/* PDYN_NO_MEMORY */
pdyn_status pcg_create(struct pcg *pcg, pdyn_model *model, pcg_preconditioner *precondition,
                       void *self);
void pcg_free(struct pcg *pcg); /* zeroed is fine */

/* As pdyn_global_solver.solve; ends, too, where the error of y in the norm of H is `error` of y (0:
 * not), and where p . H p is not positive: the residual is 0, or not finite. The square of the
 * error is estimated from below: what the last two iterations lowered the model by, over what all
 * did (Hestenes and Stiefel 1952; Strakos and Tichy 2002). */
void pcg_solve(struct pcg *pcg, double *b, double *y, const pdyn_stop *stop, double error,
               int *iterations);

#endif
