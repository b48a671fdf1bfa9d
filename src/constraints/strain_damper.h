/* The rows of a damper of strain, the manifold of all rotations R of a shape U:
 *
 *     p = R U,   R: the rotation closest to u U      (U symmetric, u and p column by column)
 *
 * u and U have 2 columns (a triangle) or 3 (a tetrahedron). U is the stretch tensor at the
 * beginning of a step, so |u - p| is the change of strain of the step: the model of Kelvin and
 * Voigt. The principal stretches alone do not give it: where two of them cross, their change is
 * less than that of the strain. */
#ifndef PDYN_STRAIN_DAMPER_H
#define PDYN_STRAIN_DAMPER_H

#include "projdyn/svd3.h"

/* The numbers that describe U: its quadratic forms along the axes, then between two of them. They
 * are lengths, as core extrapolates the numbers of a damper. U = sum_i s_i right_i right_i' of u,
 * `columns` of them. */
void strain_damper_rest(const svd3 *u, int columns, double *rest);

/* product = u U. */
void strain_damper_product(const double *u, const double *rest, int columns, double *product);

/* J = dp/du; product: of u U. A turn of R about left_k moves p by g_k = left_k x p, and the
 * distance to u has the second derivative s_i + s_j there: J = sum_k g_k g_k' / (s_i + s_j), less
 * where an eigenvalue would be above 1. */
void strain_damper_tangent(const svd3 *product, const double *p, int columns, double *J);

#endif
