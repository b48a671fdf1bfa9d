/* The boundary models "surface" and "points". */
#include "boundary.h"

#include "projdyn/kernel.h"
#include "scene/choices.h"

/* Walls of a box have fluid on one side only, so their points lie behind the faces: the force then
 * grows monotonically while a particle approaches, and continues to grow behind the face.
 * "surface": distance and volumes of the points depend on the kernel (kernels.c). "points": with
 * the published distance, a lattice that touches the faces has density ratios 0.999 at walls, 1.000
 * at edges and 1.004 in corners. */
static const struct boundary_model boundary_models[] = {
    {.name = "surface",
     .summary = "surface integral: fluid rests at half a spacing from the surface",
     .grid = 1.0,
     .mesh_spacing = 0.43,
     .strip = 0.5},
    {.name = "points",
     .summary = "boundary particles (Akinci et al. 2012): fluid rests at 0.7 spacings",
     .grid = 1.0,
     .outside = 0.6,
     .mesh_spacing = 0.9,
     .volumes = true},
};
const struct choices boundary_choices = {boundary_models, sizeof *boundary_models,
                                         sizeof boundary_models / sizeof *boundary_models};

double boundary_support(const struct boundary_model *model, const struct kernel_model *kernel) {
    const double zero = sqrt(1.0 - SURFACE_KERNEL_SOFT); /* r / s where S becomes 0: q = s */
    return model->volumes ? kernel->support : zero * kernel->reach;
}

double boundary_outside(const struct boundary_model *model, const struct kernel_model *kernel) {
    return model->volumes ? model->outside : kernel->outside;
}

double boundary_farther(double thickness, double spacing) {
    return fmin(0.5 * thickness / spacing, 0.3);
}
