/* The part of H between rigid bodies, as a matrix B of their motions (t, w), u_i = G_i (t, w) as in
 * rigid_map.h:
 *
 *     B_ab = sum of G_i' H_ij G_j     i: particles of body a, j: of body b
 *
 * The block diagonal of H gives a part of B_aa; rows that come and go (contact) give the rest, with
 * a block for each pair of bodies that a row ties. B is solved by conjugate gradients, which have
 * B's diagonal blocks as preconditioner: the matrix is small beside a fluid, and needs no order. */
#ifndef PDYN_RIGID_MATRIX_H
#define PDYN_RIGID_MATRIX_H

#include "batch.h"

enum { RIGID_BLOCK = RIGID_SIZE * RIGID_SIZE };

struct rigid_part { /* of a body */
    /* what rows add to B_aa between different particles, B_aa, its Cholesky factor */
    double coupled[RIGID_BLOCK], block[RIGID_BLOCK], factor[RIGID_BLOCK];
    int last_pair; /* of the pairs with this body first; -1: there is none */
};

struct rigid_pair { /* bodies that a row ties, a < b */
    int a, b;
    int before; /* the pair before with the same a; -1: there is none */
    double block[RIGID_BLOCK];
};

struct rigid_matrix {
    const struct rigid_map *map;
    struct rigid_part *body; /* map->bodies */
    int pairs;
    size_t room;
    struct rigid_pair *pair;   /* room: in the order of the rows */
    bool closed;               /* rows that come and go select particles of rigid bodies alone */
    double *x, *r, *p, *q, *z; /* bodies x 6, of a solve: solution, residual, direction, product,
                                  corrected residual */
};

/* After a failure *out is to be freed, too. */
pdyn_status rigid_matrix_create(const struct rigid_map *map, struct rigid_matrix **out);
void rigid_matrix_free(struct rigid_matrix *matrix); /* NULL: nothing */

/* Sets B_ab, a != b, and what rows add to B_aa between different particles, at the tangent of the
 * batches. */
pdyn_status rigid_matrix_couple(struct rigid_matrix *matrix, struct batch *const *batch,
                                int batches);

/* Completes B_aa by the block diagonal of H, packed xx xy xz yy yz zz, particles x 6. */
void rigid_matrix_factor(struct rigid_matrix *matrix, const double *blocks);

/* z of every body becomes G B^-1 G' r. */
void rigid_matrix_solve(const struct rigid_matrix *matrix, const double *r, double *z);

#endif
