/* How surfaces act on a fluid: where points lie on them, and what these add to its density. */
#ifndef PDYN_BOUNDARY_H
#define PDYN_BOUNDARY_H

#include "context.h"

struct pdyn_sim;

struct boundary_model {
    const char *name, *summary;
    /* all lengths in spacings of the fluid's particles */
    double grid, outside, beyond; /* of points of a box, see face_grid */
    double layer;                 /* of points of a box: volume per area; 0: 1 / sum W */
    double spots;                 /* between points of a mesh, as sample_triangles says */
    double support;               /* of the kernel of meshes */
    bool volumes; /* points of meshes have volumes 1 / sum W (Akinci et al. 2012) and the
                     kernel of particles; otherwise areas, and the surface kernel (kernel.h) */
};

extern const struct boundary_model boundary_models[]; /* the first is the default */
extern const int boundary_model_count;

/* What the points of a surface count in SPH sums, m^3, from their areas, m^2: area times spacing,
 * or a volume. thickness: m, of a sheet; its two sides lie half of that from the points, up to 0.3
 * spacings. spacing: m, of the particles. */
pdyn_status boundary_volumes(pdyn_context *context, const struct boundary_model *model, int count,
                             const double *x, const double *area, double thickness, double spacing,
                             double *volume);

/* Points on the scene's solids: first of those that rest, then of those that move. */
pdyn_status boundary_sample(struct pdyn_sim *sim, double spacing);

/* The volumes of these points, and which have the kernel of particles. */
pdyn_status boundary_fill(struct pdyn_sim *sim, double spacing, double *volume, bool *is_wall);

#endif
