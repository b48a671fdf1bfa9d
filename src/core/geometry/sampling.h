/* Filling volumes with particles and covering solids with boundary points. */
#ifndef PDYN_SAMPLING_H
#define PDYN_SAMPLING_H

#include "mesh.h"
#include "point_list.h"
#include "primitives.h"

#include <math.h>

/* Whole cells of a lattice along an edge, where rounding takes none away. */
static inline double sample_cells(double edge, double spacing) {
    return floor(edge / spacing * (1.0 + 1e-12) + 1e-9);
}

/* Adds a cubic lattice of particles of this radius, each wholly inside the box, from its minimum.
 */
pdyn_status sample_box_volume(pdyn_context *context, const struct scene_box *box, double radius,
                              struct point_list *out);

/* Adds a cubic lattice of particles of this radius, each wholly inside the sphere, one of them in
 * its centre. */
pdyn_status sample_sphere_volume(pdyn_context *context, const struct scene_sphere *sphere,
                                 double radius, struct point_list *out);

/* Adds a cubic lattice of particles of this radius, each wholly inside a mesh that passed
 * mesh_check_closed; it lies in the middle of the mesh's bounding box. Inside is what an odd number
 * of the mesh's sheets separates from the outside. */
pdyn_status sample_mesh_volume(pdyn_context *context, const struct mesh *mesh, double radius,
                               struct point_list *out);

struct patch {   /* what a point of a surface stands for */
    double area; /* m^2 */
    bool of_box;
    int solid; /* of the scene; set by solid_points_sample */
};

struct patches { /* points on surfaces */
    struct point_list at;
    size_t capacity;
    struct patch *patch; /* at.count */
};

void patches_free(pdyn_context *context, struct patches *patches);

struct face_grid {  /* of points on the faces of a box */
    unsigned open;  /* faces that are not there: bits as in scene_solid */
    double spacing; /* m: the points lie at most so far apart */
    double outside; /* m: the points lie so far outside of the faces */
    double beyond;  /* m: a grid goes so far beyond an edge that its face shares with another one */
};

/* Adds a regular grid of points for every face of the box. */
pdyn_status sample_box_surface(pdyn_context *context, const struct scene_box *box,
                               const struct face_grid *grid, struct patches *out);

struct spot { /* a point of a surface */
    int triangle;
    double weight[3]; /* of its corners: barycentric coordinates */
    double area;      /* m^2: of the surface that is nearer to it than to any other spot */
};

struct spots {
    int count;
    size_t capacity;
    struct spot *spot;
};

/* Spots on triangles, none closer than 0.75 spacing to another and no spot of the surface further
 * than about 1.1 spacing from one: a Poisson-disk set (Akinci et al. 2012 sample solids so), taken
 * in a fixed order. `out` comes empty; free it after a failure, too. */
pdyn_status sample_triangles(pdyn_context *context, const double *vertex, int triangles,
                             const int *triangle, double spacing, struct spots *out);
void spots_free(pdyn_context *context, struct spots *spots);
void spot_position(const struct spot *spot, const double *vertex, const int *triangle, double *x);

/* Adds these spots of a mesh. */
pdyn_status sample_mesh_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                struct patches *out);

#endif
