/* A level for what is static: the factor of the projective step's matrix A. It is made once. Where
 * the length of the step changes, the old one still is a preconditioner; and what adds little to A
 * but many entries, as bending does where springs are stiffer, is left out of it: the blocks of H
 * know it, and the factor becomes several times as small. */
#ifndef PDYN_BACKBONE_H
#define PDYN_BACKBONE_H

#include "factor.h"

struct backbone {
    struct system *system;
    struct batch **rows; /* batches: those in A, NULL for those left out */
    struct matrix matrix;
    struct factor factor;
    float *t;    /* particles x 4 */
    double h;    /* s: the factor is for steps of this length; 0: not known yet */
    double made; /* s: it was made for this one; 0: not yet */
    int strange; /* iterations with a factor for steps of another length */
};

/* Zeroed before. */
pdyn_status backbone_create(struct backbone *backbone, struct system *system);
void backbone_free(struct backbone *backbone);

/* Before the solves of a step: another factor where that is worth it. */
pdyn_status backbone_update(struct backbone *backbone);
/* After one. */
void backbone_note(struct backbone *backbone, int iterations);

/* z = A^-1 r, particles x 4, fourth lanes 0; they may be one */
void backbone_solve(struct backbone *backbone, const float *r, float *z);
/* z += A^-1 r; returns r.z of that. */
double backbone_add(struct backbone *backbone, const double *r, double *z);

/* The factor is made again from its length of step. */
void backbone_persist(struct backbone *backbone, pdyn_archive *archive);

#endif
