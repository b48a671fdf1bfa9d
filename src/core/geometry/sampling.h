/* Sampling: fills volumes with particles and covers surfaces of solids with boundary points. */
#ifndef PDYN_SAMPLING_H
#define PDYN_SAMPLING_H

#include "mesh.h"
#include "point_list.h"

#include "projdyn/box.h"

#include <math.h>

struct sphere {
    double center[3], radius; /* m */
};

/* Number of whole lattice cells along an edge, with a tolerance against rounding. */
static inline double sample_cells(double edge, double spacing) {
    return floor(edge / spacing * (1.0 + 1e-12) + 1e-9);
}

/* Fills a box with a cubic lattice of particles, starting at its minimum; every particle of this
 * radius, m, is entirely inside. Appends to `out`. */
pdyn_status sample_box_volume(pdyn_context *context, const struct box *box, double radius,
                              struct point_list *out);

/* Fills a sphere with a cubic lattice of particles of this radius, m, that are entirely inside; one
 * particle is at the centre. Appends to `out`. */
pdyn_status sample_sphere_volume(pdyn_context *context, const struct sphere *sphere, double radius,
                                 struct point_list *out);

/* Fills a mesh that passed mesh_check_closed with a cubic lattice of particles of this radius, m,
 * that are entirely inside. The lattice is centred in the bounding box. A point is inside if a ray
 * from it crosses the mesh an odd number of times. Appends to `out`. */
pdyn_status sample_mesh_volume(pdyn_context *context, const struct mesh *mesh, double radius,
                               struct point_list *out);

struct boundary_point { /* attributes of a boundary point */
    double area;        /* m^2, area of the surface that the point represents */
    double normal[3];   /* unit normal at rest: into a vessel, out of another solid; 0 on slivers */
    bool of_box;
    int solid; /* index of the solid in the scene; set by solid_points_sample */
};

struct boundary_points { /* points on the surfaces of solids */
    struct point_list at;
    size_t capacity;
    struct boundary_point *point; /* at.count */
};

void boundary_points_free(pdyn_context *context, struct boundary_points *patches);

struct face_grid {  /* a grid of boundary points on the faces of a box */
    unsigned open;  /* bits of the faces without points, as in scene_solid */
    double spacing; /* m, largest distance of neighbouring points */
    double outside; /* m, distance of the points from the face, outwards */
    double beyond;  /* m, extension of the grid past an edge that two closed faces share */
};

enum { RECTANGLE_POINTS = 20000000 }; /* of a face or a plane: 6 GB with the neighbour lists */

/* Appends a regular grid of boundary points for every closed face of the box. name: of the solid,
 * for messages. PDYN_BAD_INPUT: a face has more than RECTANGLE_POINTS. */
pdyn_status sample_box_surface(pdyn_context *context, const char *name, const struct box *box,
                               const struct face_grid *grid, struct boundary_points *out);

/* The same for the mesh of primitive_plane, with about as many points as sample_mesh_surface makes
 * of this spacing, m, in a fraction of its time. */
pdyn_status sample_plane_surface(pdyn_context *context, const char *name, const struct mesh *mesh,
                                 double spacing, struct boundary_points *out);

struct surface_point { /* a point on a triangle */
    int triangle;
    double weight[3]; /* barycentric coordinates */
    double area;      /* m^2, area of the surface that is nearer to this point than to any other */
};

enum { SURFACE_CANDIDATES = 100000000 }; /* of one body or solid: half a minute */

struct surface_points {
    int count;
    size_t capacity;
    struct surface_point *point;
};

/* Samples a mesh with a Poisson-disk set in deterministic order (Akinci et al. 2012 sample
 * solids in this way): the distance between points is at least 0.75 spacing, and every place of the
 * surface is within about 1.1 spacing of a point. Time is proportional to area / spacing^2 + length
 * of the sides / spacing, memory to the number of points. name: of the body or solid, for messages.
 * *out must be zeroed before; free it after a failure, too. PDYN_BAD_INPUT: more than
 * SURFACE_CANDIDATES points to choose from. */
pdyn_status sample_triangles(pdyn_context *context, const char *name, const struct mesh *mesh,
                             double spacing, struct surface_points *out);
void surface_points_free(pdyn_context *context, struct surface_points *points);
/* Computes the position of a point on a mesh: x, 3 numbers, m. */
void surface_point_position(const struct surface_point *point, const struct mesh *mesh, double *x);

/* Samples a mesh as sample_triangles does and appends the points as boundary points. */
pdyn_status sample_mesh_surface(pdyn_context *context, const char *name, const struct mesh *mesh,
                                double spacing, struct boundary_points *out);

#endif
