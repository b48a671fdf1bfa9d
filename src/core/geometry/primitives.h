/* Simple shapes given by a few numbers in a scene: boxes and spheres. */
#ifndef PDYN_PRIMITIVES_H
#define PDYN_PRIMITIVES_H

struct scene_box {
    double min[3], max[3]; /* m; min < max along every axis */
};

struct scene_sphere {
    double center[3], radius; /* m */
};

#endif
