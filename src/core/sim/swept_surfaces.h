/* Surfaces of bodies and solids that move along straight lines from the beginning to the end of a
 * step, and bounding volume hierarchies of their triangles. */
#ifndef PDYN_SWEPT_SURFACES_H
#define PDYN_SWEPT_SURFACES_H

#include "geometry/bvh.h"
#include "scene/scene.h"

struct pdyn_sim;

struct swept_surface { /* of a body or a solid */
    const char *name;
    bool is_solid;
    const int *triangle; /* triangles x 3 */
    const int *across;   /* triangles x 3: -1 for a side on the border */
    int *own_across;     /* the same array, of a solid; else NULL */
    int triangles, vertices;
    const double *begin, *end;       /* vertices x 3, m: at the two ends of the step */
    const struct scene_solid *moves; /* the solid with prescribed motion, or NULL */
    double *pose[2];                 /* its vertices at both ends of the step */
};

struct swept_triangles { /* triangles of some surfaces and their hierarchy */
    int count, capacity;
    int *surface, *triangle; /* capacity: of each triangle */
    struct box *box;         /* capacity, m: from the beginning to the end of the step */
    struct bvh tree;
};

struct swept_surfaces {
    int count, capacity, solids;   /* the last ones are solids */
    struct swept_surface *surface; /* capacity */
    struct swept_triangles resting, moving;
};

/* Lists the surfaces of bodies that no fluid passes, if `bodies`, then all solids. After a failure
 * it is to be freed, too. */
pdyn_status swept_surfaces_create(struct pdyn_sim *sim, bool bodies, struct swept_surfaces *swept);
void swept_surfaces_free(pdyn_context *context, struct swept_surfaces *swept);

/* Moves the surfaces: bodies from sim->x to sim->x_next, solids in a step of length h, s. */
void swept_surfaces_step(const struct pdyn_sim *sim, struct swept_surfaces *swept, double h);

#endif
