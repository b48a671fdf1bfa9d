/* A coarse level for the conjugate gradients of surfaces and solids: particles in groups that move
 * together. Its matrix is what H makes of these motions (Galerkin), so it knows the tangents as
 * they are and is a hundredth of H's size. Of what is not static, fluid and contact, it holds their
 * block diagonal. */
#ifndef PDYN_GROUPS_H
#define PDYN_GROUPS_H

#include "clusters.h"
#include "skyline.h"

struct groups {
    struct system *system;
    struct clusters clusters;
    struct skyline a;    /* 3 rows for each cluster */
    double *constant;    /* what linear batches give to it, as a.value */
    double *rest;        /* particles x 6: block diagonal of what is not static */
    double *sum, *x;     /* as rows: of r over each group; its displacement */
    float *moved;        /* clusters x 4: x, as floats */
    int left;            /* products with a's inverse until a is made anew; none: now */
    const double *r;     /* of the product that runs, */
    const float *single; /* or this */
    double *z;
};

/* Zeroed before. Groups of particles that static rows hold. */
pdyn_status groups_create(struct groups *groups, struct system *system);
void groups_free(struct groups *groups);

/* Makes and factors the matrix of H as it is linearised, unless the last one is not used up. */
void groups_prepare(struct groups *groups);
/* groups->moved = A^-1 P' r, r: particles x 4 */
void groups_solve_single(struct groups *groups, const float *r);
/* z += P A^-1 P' r, where P moves all of a group as one; adds r.z of that. */
double groups_add(struct groups *groups, const double *r, double *z);

void groups_persist(struct groups *groups, pdyn_archive *archive);

#endif
