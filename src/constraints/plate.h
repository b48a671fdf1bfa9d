/* Second derivatives of a function on a triangle mesh, from its values at the vertices: what a thin
 * plate feels, by the element of Morley (1968) without unknowns of its own at the edges. */
#ifndef PDYN_PLATE_H
#define PDYN_PLATE_H

#include "projdyn/module.h"

enum { PLATE_NODES = 12 }; /* a triangle, three around it, six around these */

/* A functional of the values at some vertices of a body: the sum of coefficient x value. */
struct plate {
    int nodes;
    int node[PLATE_NODES]; /* vertices, each once */
    /* Three integrals of second derivatives over the triangle, in m times the function's unit per
     * m: of f_xx, sqrt(2) f_xy and f_yy, x and y in the plane of the triangle, turned such that the
     * rest shape itself has the first one alone. Their squares sum to that of the Hessian's
     * integral. */
    double coefficient[3][PLATE_NODES];
    double curvature; /* m: the first one, of the rest shape; 0 where it is flat */
};

/* The vertices that it takes for triangle t: its own, of the triangles around it, and around these;
 * none where nothing but borders is around the triangle. Returns their number. */
int plate_nodes(const pdyn_body *body, int t, int node[PLATE_NODES]);

/* The Hessian on triangle t. Second derivatives are covariant: for the rest shape itself, only the
 * part along the normal is there. */
void plate_hessian(const pdyn_body *body, int t, struct plate *out);

#endif
