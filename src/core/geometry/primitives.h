/* Simple shapes given by a few numbers in a scene: boxes, with min < max along every axis, and
 * spheres. */
#ifndef PDYN_PRIMITIVES_H
#define PDYN_PRIMITIVES_H

#include "projdyn/box.h"

struct scene_sphere {
    double center[3], radius; /* m */
};

#endif
