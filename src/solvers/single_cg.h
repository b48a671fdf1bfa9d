/* Conjugate gradients in single precision. Where all of H is static, preconditioned by blocks,
 * factor and blocks in turn, each on what those before leave:
 *
 *     z1 = omega D^-1 r
 *     z2 = z1 + A^-1 (r - H z1)
 *     z  = z2 + omega D^-1 (r - H z2)
 *
 * The factor of the projective step's matrix A knows how a push travels through a sheet, but
 * resists every motion alike. D, the block diagonal of H, knows how soft each particle is along
 * every direction, but nothing of its neighbours. Where H changes, groups of particles (groups.h)
 * are added to the blocks, z = omega D^-1 r + P A^-1 P' r.
 *
 * The residual is scaled to 1, so that floats hold it, and the solution added up in doubles. */
#ifndef PDYN_SINGLE_CG_H
#define PDYN_SINGLE_CG_H

#include "backbone.h"
#include "groups.h"
#include "jacobi.h"
#include "single.h"

struct single_cg {
    struct system *system;
    struct jacobi *jacobi;        /* D */
    double omega;                 /* how much of its inverse */
    struct backbone *backbone;    /* A, or NULL: */
    struct groups *groups;        /* these are added then */
    struct single product;        /* H */
    float *r, *z, *p, *q, *w, *t; /* single_size; w and t with a factor */
    float *inverse;   /* particles x 9: omega D^-1, with room to load the last column as four */
    double curvature; /* p.q, q = H p as H was then; 0: p is no direction yet */
    struct single_sums *sums;
};

/* Zeroed before; what it is given outlives it. One of backbone and groups is NULL. */
pdyn_status single_cg_create(struct single_cg *s, struct system *system, struct jacobi *jacobi,
                             double omega, struct backbone *backbone, struct groups *groups);
void single_cg_free(struct single_cg *s);

enum single_end {
    SINGLE_SOLVED,   /* the residual is as small as was asked for, as far as floats can tell */
    SINGLE_ENOUGH,   /* more iterations are not wanted */
    SINGLE_EXHAUSTED /* or not possible in floats */
};

/* Takes the system's linearisation, before solves. */
void single_cg_prepare(struct single_cg *s);
/* As pdyn_global_solver.solve, but b, of this size, stays. */
enum single_end single_cg_solve(struct single_cg *s, const double *b, double size, double *y,
                                const pdyn_goal *goal, int *iterations);

/* Of the last solve, as floats have it. */
void single_cg_residual(struct single_cg *s, double size, double *r);

#endif
