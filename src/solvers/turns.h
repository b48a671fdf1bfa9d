/* A preconditioner for what is static: a factor and blocks in turn,
 *
 *     z = omega D^-1 r,   z += A^-1 (r - H z),   z += omega D^-1 (r - H z)
 *
 * A is the matrix of the projective step: it knows how a push travels through a sheet, but resists
 * every motion alike. D, the block diagonal of H, knows how soft each particle is along every
 * direction, but nothing of its neighbours. Each removes what the other leaves, as smoother and
 * coarse level do in multigrid.
 *
 * A is factored once. Where the length of the step changes, its old factor still is a
 * preconditioner. */
#ifndef PDYN_TURNS_H
#define PDYN_TURNS_H

#include "factor.h"
#include "jacobi.h"
#include "krylov.h"

struct turns {
    struct krylov *krylov;
    struct matrix matrix;
    struct factor factor;
    const struct jacobi *jacobi;
    double *t;   /* particles x 3 */
    double h;    /* s: the factor is for steps of this length; 0: not known yet */
    double made; /* s: it was made for this one; 0: not yet */
    double omega;
    int strange; /* iterations with a factor for steps of another length */
};

pdyn_status turns_create(struct turns *turns, struct krylov *krylov, const struct jacobi *jacobi);
void turns_free(struct turns *turns); /* zeroed is fine */

/* Before the solves of a step: another factor where that is worth it. */
pdyn_status turns_update(struct turns *turns);
/* After one. */
void turns_note(struct turns *turns, int iterations);

/* As that of struct krylov, after jacobi_prepare(). */
double turns_precondition(struct turns *turns);

/* The factor is made again from its length of step. */
void turns_persist(struct turns *turns, pdyn_archive *archive);

#endif
