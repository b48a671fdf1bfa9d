/* Boundary models: where points lie on surfaces and what they add to the density of a fluid. */
#ifndef PDYN_BOUNDARY_H
#define PDYN_BOUNDARY_H

#include <stdbool.h>

struct kernel_model;

struct boundary_model {
    const char *name, *summary;
    /* lengths in units of the particle spacing of the fluid */
    double grid, mesh_spacing; /* spacing of points on a box, see struct face_grid, and on a mesh,
                                * see sample_triangles */
    double outside;            /* distance of points behind the faces of a box */
    double strip;              /* width of the strip beside borders (border.h) */
    bool volumes; /* points have volumes 1 / sum W (Akinci et al. 2012) and the kernel of particles,
                   * with the first of the kernels; false: points on meshes have areas and the
                   * surface kernel, those on boxes the volumes of the kernel (kernel.h) */
};

/* Support of the kernel of points on meshes, in particle spacings. */
double boundary_support(const struct boundary_model *model, const struct kernel_model *kernel);
/* Distance of the points of a vessel behind its faces, in particle spacings. */
double boundary_outside(const struct boundary_model *model, const struct kernel_model *kernel);

/* Distance, in particle spacings, by which a fluid rests farther from a sheet because of its
 * thickness, m: half of it, at most 0.3 spacings (docs/theory/interface.md#thickness). */
double boundary_farther(double thickness, double spacing);

#endif
