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

/* Sets B_ab, a != b, and what rows add to B_aa between different particles, at the tangent of the
 * batches. map->closed: rows that come and go select particles of rigid bodies alone. */
pdyn_status rigid_matrix_couple(struct rigid_map *map, struct batch *const *batch, int batches);

/* Completes B_aa by the block diagonal of H, packed xx xy xz yy yz zz, particles x 6. */
void rigid_matrix_factor(struct rigid_map *map, const double *blocks);

/* z of every body becomes G B^-1 G' r. */
void rigid_matrix_solve(const struct rigid_map *map, const double *r, double *z);

#endif
