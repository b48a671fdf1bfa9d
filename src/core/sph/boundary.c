#include "boundary.h"

#include "kernel.h"
#include "neighbours.h"
#include "scene/choices.h"

/* Walls of a box have water on one side. Points that lie behind them push ever harder as a particle
 * comes closer, and go on where it is behind the face. As far away as this, and with this volume, a
 * plane adds 0.150 half a spacing in front of the face, and -1.15 per spacing: the lowest layer of
 * water at rest then has the pressure of its depth. A lattice of particles that touches the faces
 * is at rest (1.00 at walls, edges and in corners): for that, grids go on beyond the edges. A
 * plane's sum varies by 3 % over the grid, that of the surface kernel by 3 % over a mesh
 * (test_interface.c). As published, so far outside, such a lattice has 0.999, 1.000 and 1.004. */
static const struct boundary_model boundary_models[] = {
    {.name = "surface",
     .summary = "a surface acts from where it is",
     .grid = 1.0,
     .outside = 1.01,
     .beyond = 0.35,
     .layer = 12.95,
     .mesh_spacing = 0.5,
     .support = 0.99498743710662}, /* q = d */
    {.name = "points",
     .summary = "boundary particles (Akinci et al. 2012), which hold fluid off by 0.7 spacings",
     .grid = 1.0,
     .outside = 0.6,
     .beyond = 0.6,
     .mesh_spacing = 0.9,
     .support = 2.0,
     .volumes = true},
};
const struct choices boundary_choices = {boundary_models, sizeof *boundary_models,
                                         sizeof boundary_models / sizeof *boundary_models};

pdyn_status boundary_volumes(pdyn_context *context, const struct boundary_model *model, int count,
                             const double *x, const double *area, double thickness, double spacing,
                             double *volume) {
    double factor = surface_kernel_farther(fmin(0.5 * thickness / spacing, 0.3));
    if (model->volumes)
        return neighbours_surface_volumes(context, count, x, model->support * spacing, volume);
    for (int k = 0; k < count; k++) volume[k] = factor * area[k] * spacing;
    return PDYN_OK;
}
