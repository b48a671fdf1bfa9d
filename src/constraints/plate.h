/* Second derivatives of a function on a triangle mesh from its vertex values: the strains of a thin
 * plate, by Morley's element (1968) without unknowns at the edges (plate.c). */
#ifndef PDYN_PLATE_H
#define PDYN_PLATE_H

#include "projdyn/module.h"

enum { PLATE_NODES = 12 }; /* vertices of a triangle, of its 3 neighbours and of their 6 others */

/* Three linear functionals of the vertex values f: sum_i coefficient[r][i] f(node[i]). */
struct plate {
    int nodes;
    int node[PLATE_NODES]; /* vertices, each once */
    /* Integrals over the triangle of f_xx, sqrt(2) f_xy and f_yy, dimensionless per unit of f, with
     * x and y in the plane of the triangle. The sum of squares is the squared norm of the integral
     * of the Hessian. The three are rotated such that of the rest shape only the first is not 0. */
    double coefficient[3][PLATE_NODES];
    double curvature; /* value of the first row for the rest shape, m; 0 where it is flat */
};

/* Sets node to the vertices that the second derivatives on triangle t depend on and returns their
 * number: those of t, its neighbours and their neighbours; 0 for a triangle without neighbour. */
int plate_nodes(const pdyn_body *body, int t, int node[PLATE_NODES]);

/* Computes the functionals for triangle t. The second derivatives are covariant: for the rest shape
 * they point along its normal. */
void plate_hessian(const pdyn_body *body, int t, struct plate *out);

#endif
