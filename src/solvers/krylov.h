/* Conjugate gradients on the model of E without a matrix, for solvers that differ in how they
 * precondition.
 *
 * The model is quadratic but for one-sided constraints. These keep their sides for a linear solve;
 * then the model is followed with its sides along what was found, to the minimum there, and the
 * next solve begins from that: a semi-smooth Newton iteration with an exact line search.
 *
 * What is sought is a correction, so it is warm started by construction: its first residual is that
 * of the iterate, and the tolerance is relative to it. */
#ifndef PDYN_KRYLOV_H
#define PDYN_KRYLOV_H

#include "objective/objective.h"
#include "objective/solver_view.h"

struct krylov {
    pdyn_context *context;
    struct objective *objective;
    double *r, *z, *p, *q, *d; /* particles x 3 */
    double curvature;          /* p.q, q = H p as H was then; 0: p is no direction yet */
    bool patient;              /* of a solver: goes on where iterations gain little */
    /* Of a solver: before a linear solve; z = P^-1 r, P symmetric positive definite, returns r.z.
     */
    void (*prepare)(void *self);
    double (*precondition)(void *self);
    /* NULL, or a linear solve of its own: d = H^-1 r, |r| = size, and r what is left of it, at most
     * `target`. false: there is none, r is as it was. */
    bool (*linear)(void *self, double size, double target, const pdyn_stop *stop, int *iterations);
    void *self;
};

pdyn_status krylov_create(struct krylov *krylov, pdyn_context *context,
                          struct objective *objective);
void krylov_free(struct krylov *krylov);

/* As pdyn_global_solver.solve. */
void krylov_solve(struct krylov *krylov, double *b, double *y, const pdyn_stop *stop,
                  int *iterations);

#endif
