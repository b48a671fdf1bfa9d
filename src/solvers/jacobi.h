/* The inverse 3 x 3 block diagonal of H, as a preconditioner. */
#ifndef PDYN_JACOBI_H
#define PDYN_JACOBI_H

#include "objective/objective.h"

struct jacobi {
    struct objective *objective;
    double *inverse; /* particles x 6 */
    bool *held;      /* particles: some rows hold it */
    const double *r; /* of the product that runs */
    double *z;
};

pdyn_status jacobi_create(struct jacobi *jacobi, struct objective *objective);
void jacobi_free(struct jacobi *jacobi); /* zeroed is fine */

/* Takes the blocks of H as it is linearised. */
void jacobi_prepare(struct jacobi *jacobi);
/* Takes those that have been put into `inverse`. */
void jacobi_invert(struct jacobi *jacobi);
/* z = D^-1 r; returns r.z */
double jacobi_apply(struct jacobi *jacobi, const double *r, double *z);

#endif
