/* Conjugate gradients in single precision. Where all of H is static, with a factor, each iteration
 * goes to the minimum over several directions (single_turn.h). Where H changes, groups of particles
 * (groups.h) are added to the blocks, z = omega D^-1 r + P A^-1 P' r.
 *
 * The residual is scaled to 1, so that floats hold it, and the solution added up in doubles. */
#ifndef PDYN_SINGLE_CG_H
#define PDYN_SINGLE_CG_H

#include "../core/simd.h"
#include "backbone.h"
#include "groups.h"
#include "jacobi.h"
#include "single.h"

struct single_cg {
    struct system *system;
    struct jacobi *jacobi;     /* D */
    double omega;              /* how much of its inverse */
    struct backbone *backbone; /* A, or NULL: */
    struct groups *groups;     /* these are added then */
    struct single product;     /* H */
    float *r, *z, *p, *q;      /* single_size: p the last step or direction, q = H p */
    float *w, *t, *u;          /* with a factor: what is left of r, two more directions, */
    float *hz, *ht, *hu;       /* and H times z and these */
    float *inverse;   /* particles x 9: omega D^-1, with room to load the last column as four */
    double curvature; /* with groups: p.q, with H as it was then; 0: p is no direction yet */
    bool cut;         /* with a factor: the last solve ended for its number of iterations */
    struct single_sums *sums;
    struct turn_sums *turn_sums; /* with a factor */
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

/* z = omega D^-1 r of particle i */
INLINE void single_cg_block(const struct single_cg *s, int i, const v4f *r, v4f *z) {
    v4f column[3];
    for (int a = 0; a < 3; a++)
        memcpy(&column[a], s->inverse + 9 * (size_t)i + 3 * a, sizeof column[a]);
    *z = (*r)[0] * column[0] + (*r)[1] * column[1] + (*r)[2] * column[2];
    (*z)[3] = 0.0F;
}

#endif
