/* A triangle of the rest shape, in its own plane. */
#ifndef PDYN_FRAME_H
#define PDYN_FRAME_H

#include "projdyn/module.h"

struct frame {
    double area;           /* m^2 */
    double axis[3][3];     /* x along the first side, y, normal; of length 1, in space */
    double gradient[3][2]; /* 1/m: of the linear functions that are 1 at one corner */
    double outward[3][2];  /* m: normal of the side opposite to a corner, as long as the side */
};

struct frame frame_of(const pdyn_body *body, int t);

#endif
