/* Geometry of a triangle of the rest shape in a coordinate system of its plane:
 *
 *     x: along the side from corner 0 to corner 1,   z: normal,   y = z x x */
#ifndef PDYN_FRAME_H
#define PDYN_FRAME_H

#include "projdyn/module.h"

struct frame {
    double area;           /* m^2 */
    double axis[3][3];     /* unit vectors x, y, z in space */
    double gradient[3][2]; /* of the barycentric coordinate of each corner, 1/m */
    double outward[3][2];  /* outward normal of the side opposite to each corner, as long as the
                              side, m */
};

/* Triangle t of a surface. */
struct frame frame_of(const pdyn_body *body, int t);

#endif
