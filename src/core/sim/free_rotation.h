/* Free rotation of a rigid body, and rotations as 3 x 3 matrices row by row. */
#ifndef PDYN_FREE_ROTATION_H
#define PDYN_FREE_ROTATION_H

#include "rows/rigid_map.h"

/* R becomes the free rotation F(t; R, L): that from R over the time t, s, with the constant angular
 * momentum L, kg m^2/s. */
void rotate_free(const struct rigid_body *body, const double L[3], double t, double R[9]);

/* R becomes exp([w]) R. */
void rotation_turn(const double w[3], double R[9]);
/* The vector w with exp([w]) = R, for angles below pi. */
void rotation_vector(const double R[9], double w[3]);
/* C = A B' */
void rotation_multiply_transposed(const double A[9], const double B[9], double C[9]);
/* I = R I_0 R', with the inertia tensor I_0 of the rest shape, kg m^2. */
void rigid_inertia_at(const struct rigid_body *body, const double R[9], double I[9]);

#endif
