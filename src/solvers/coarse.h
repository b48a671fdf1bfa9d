/* A coarse level for the conjugate gradients of surfaces and solids: what they do slowly over a
 * body, as a few hundred nodes have it. Its matrix is what H makes of these motions (Galerkin), so
 * it knows the tangents as they are. Of what is not static, fluid and contact, it holds their block
 * diagonal. */
#ifndef PDYN_COARSE_H
#define PDYN_COARSE_H

#include "interpolation.h"
#include "skyline.h"

struct followed {              /* the rows of a batch, as nodes have them */
    struct sparse rows, nodes; /* G P and its transpose, where elements have several rows; */
    struct sparse terms;       /* where they have one: blocks of a x rows, what each counts there */
};

struct coarse {
    struct objective *objective;
    struct interpolation p;
    struct followed *batch; /* batches: of those that are static and have no matrix already */
    struct skyline a;
    double *stiffness, *mass; /* blocks of a: what linear batches give to it, N/m; kg */
    double *rest;        /* particles x 6: block diagonal of what is not static; NULL: all is */
    double *sum, *x;     /* nodes x 3: P' r; displacement */
    float *moved;        /* nodes x 4: x, as floats */
    int worth;           /* products with a's inverse that one a is good for */
    int left;            /* products with a's inverse until a is made anew; none: now */
    const double *r;     /* of the product that runs; */
    const float *single; /* or this, if there is one */
    double *z;
};

/* Zeroed before. */
pdyn_status coarse_create(struct coarse *coarse, struct objective *objective);
void coarse_free(struct coarse *coarse);

/* Makes and factors the matrix of H as it is linearised, unless the last one is not used up; first:
 * for the first solve of a step. */
void coarse_prepare(struct coarse *coarse, bool first);
/* coarse->moved = A^-1 P' r, r: particles x 4 */
void coarse_solve_single(struct coarse *coarse, const float *r);
/* z += P A^-1 P' r; returns r.z of that. */
double coarse_add(struct coarse *coarse, const double *r, double *z);

void coarse_persist(struct coarse *coarse, pdyn_snapshot *snapshot);

#endif
