/* How surfaces act on a fluid: where points lie on them, and what these add to its density. */
#ifndef PDYN_BOUNDARY_H
#define PDYN_BOUNDARY_H

#include "base/context.h"

struct boundary_model {
    const char *name, *summary;
    /* all lengths in spacings of the fluid's particles */
    double grid, outside, beyond; /* of points of a box, see face_grid */
    double layer;                 /* of points of a box: volume per area; 0: 1 / sum W */
    double mesh_spacing;                 /* between points of a mesh, as sample_triangles says */
    double support;               /* of the kernel of meshes */
    bool volumes; /* points of meshes have volumes 1 / sum W (Akinci et al. 2012) and the
                     kernel of particles; otherwise areas, and the surface kernel (kernel.h) */
};

/* What the points of a surface count in SPH sums, m^3, from their areas, m^2: area times spacing,
 * or a volume. thickness: m, of a sheet; its two sides lie half of that from the points, up to 0.3
 * spacings. spacing: m, of the particles. */
pdyn_status boundary_volumes(pdyn_context *context, const struct boundary_model *model, int count,
                             const double *x, const double *area, double thickness, double spacing,
                             double *volume);

#endif
