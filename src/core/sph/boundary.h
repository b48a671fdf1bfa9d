/* Boundary models: where points lie on surfaces and what they add to the density of a fluid. */
#ifndef PDYN_BOUNDARY_H
#define PDYN_BOUNDARY_H

#include "base/context.h"

struct boundary_model {
    const char *name, *summary;
    /* lengths in units of the particle spacing of the fluid */
    double grid, outside, beyond; /* grid of points on the faces of a box, see struct face_grid */
    double layer;                 /* volume per area of points on a box; 0: volumes are 1 / sum W */
    double mesh_spacing;          /* spacing of points on a mesh, see sample_triangles */
    double support;               /* support of the kernel of points on meshes */
    bool volumes; /* points on meshes have volumes 1 / sum W (Akinci et al. 2012) and the kernel of
                   * particles; false: they have areas and the surface kernel (kernel.h) */
};

struct sampling { /* of a surface */
    const struct boundary_model *model;
    double spacing;   /* m, of the fluid's particles */
    double thickness; /* m, of a sheet: its sides are half of it away from the points, at most 0.3
                         spacings; 0 for the surface of a volume */
};

/* Computes the volumes, m^3, with which the points of a surface enter SPH sums, from their areas,
 * m^2: area times spacing, or 1 / sum W. x: count x 3, m. */
pdyn_status boundary_volumes(pdyn_context *context, const struct sampling *sampling, int count,
                             const double *x, const double *area, double *volume);

#endif
