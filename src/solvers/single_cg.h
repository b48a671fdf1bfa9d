/* Conjugate gradients in single precision for static scenes, where H has no sides (krylov.h).
 * Preconditioned by blocks, factor and blocks in turn, each on what those before leave:
 *
 *     z1 = omega D^-1 r
 *     z2 = z1 + A^-1 (r - H z1)
 *     z  = z2 + omega D^-1 (r - H z2)
 *
 * The factor of the projective step's matrix A knows how a push travels through a sheet, but
 * resists every motion alike. D, the block diagonal of H, knows how soft each particle is along
 * every direction, but nothing of its neighbours.
 *
 * The residual is scaled to 1, so that floats hold it, and the solution added up in doubles. */
#ifndef PDYN_SINGLE_CG_H
#define PDYN_SINGLE_CG_H

#include "backbone.h"
#include "jacobi.h"
#include "single.h"

struct single_cg {
    struct system *system;
    struct backbone *backbone;    /* A */
    struct jacobi *jacobi;        /* D */
    struct single product;        /* H */
    float *r, *z, *p, *q, *w, *t; /* single_size */
    float *inverse;   /* particles x 9: omega D^-1, with room to load the last column as four */
    double curvature; /* p.q, q = H p as H was then; 0: p is no direction yet */
    struct single_sums *sums;
};

/* Zeroed before; backbone and jacobi outlive it. */
pdyn_status single_cg_create(struct single_cg *s, struct system *system, struct backbone *backbone,
                             struct jacobi *jacobi);
void single_cg_free(struct single_cg *s);

enum single_end {
    SINGLE_SOLVED,   /* the residual is as small as was asked for, as far as floats can tell */
    SINGLE_ENOUGH,   /* more iterations are not wanted */
    SINGLE_EXHAUSTED /* or not possible in floats */
};

/* As pdyn_global_solver.solve, but b, of this size, stays. */
enum single_end single_cg_solve(struct single_cg *s, const double *b, double size, double *y,
                                const pdyn_goal *goal, int *iterations);

#endif
