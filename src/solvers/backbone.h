/* A level for what is static: the factor of the projective step's matrix A beside the blocks of H,
 *
 *     z = omega D^-1 r + A^-1 r
 *
 * A knows how a push travels through a sheet, but resists every motion alike. D, the block diagonal
 * of H, knows how soft each particle is along every direction, but nothing of its neighbours. Used
 * in turn, each on what the other leaves, they take fewer iterations, but a product with H each.
 *
 * A is factored once. Where the length of the step changes, its old factor still is a
 * preconditioner; and what adds little to A but many entries, as bending does where springs are
 * stiffer, is left out of it: D knows it, and the factor becomes several times as small. */
#ifndef PDYN_BACKBONE_H
#define PDYN_BACKBONE_H

#include "factor.h"

struct backbone {
    struct system *system;
    struct batch **rows; /* batches: those in A, NULL for those left out */
    struct matrix matrix;
    struct factor factor;
    double *t;   /* particles x 3 */
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

/* z += A^-1 r; returns r.z of that. */
double backbone_add(struct backbone *backbone, const double *r, double *z);

/* The factor is made again from its length of step. */
void backbone_persist(struct backbone *backbone, pdyn_archive *archive);

#endif
