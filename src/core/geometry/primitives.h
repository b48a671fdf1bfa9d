/* The simple shapes that a scene names by numbers. */
#ifndef PDYN_PRIMITIVES_H
#define PDYN_PRIMITIVES_H

struct scene_box {
    double min[3], max[3]; /* m; min < max in every axis */
};

struct scene_sphere {
    double center[3], radius; /* m */
};

#endif
