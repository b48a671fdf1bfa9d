/* Conjugate gradients in single precision, preconditioned by the blocks of H and a coarse level,
 * z = D^-1 r + P A^-1 P' r.
 *
 * The residual is scaled to 1, so that floats hold it, and the solution added up in doubles. */
#ifndef PDYN_SINGLE_CG_H
#define PDYN_SINGLE_CG_H

#include "base/simd.h"
#include "coarse.h"
#include "jacobi.h"
#include "single.h"

struct single_cg {
    struct objective *objective;
    struct jacobi *jacobi; /* D */
    struct coarse *coarse;
    struct single product; /* H */
    float *r, *z, *p, *q;  /* single_size: r over |b|; p the last direction, q = H p */
    double length;         /* |b|, N */
    float *inverse;        /* particles x 9: D^-1, with room to load the last column as four */
    double curvature;      /* p.q, with H as it was then; 0: p is no direction yet */
    struct single_sums *sums;
};

/* Zeroed before; what it is given outlives it. */
pdyn_status single_cg_create(struct single_cg *s, struct objective *objective,
                             struct jacobi *jacobi, struct coarse *coarse);
void single_cg_free(struct single_cg *s);

enum single_end {
    SINGLE_SOLVED,   /* the residual is as small as was asked for, as far as floats can tell */
    SINGLE_ENOUGH,   /* more iterations are not wanted */
    SINGLE_EXHAUSTED /* or not possible in floats */
};

/* Takes the system's linearisation, before solves. */
void single_cg_prepare(struct single_cg *s);
/* As pdyn_global_solver.solve, but b stays. */
enum single_end single_cg_solve(struct single_cg *s, const double *b, double *y,
                                const pdyn_stop *stop, int *iterations);

/* Of the last solve, as floats have it. */
void single_cg_residual(struct single_cg *s, double *r);

#endif
