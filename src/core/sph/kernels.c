/* The density kernels that a scene can choose (projdyn/kernel.h).
 *
 * Walls of a box: a plane of points at the distance `outside`, with the volume per area `layer`,
 * adds what a lattice lacks at half a spacing in front of the face. The slope of that sum is 2.26
 * (cubic spline) or 2.7 times the slope of what the lattice lacks, which gives the lowest layer of
 * water at rest its hydrostatic pressure. Grids extend past the edges by `beyond`, so that a
 * lattice that touches the faces is at rest (density ratio 0.99 to 1.001 at walls, edges and
 * corners). The sum of a plane varies by 3 % over the grid, the sum of the surface kernel by 2 %
 * over a mesh (test_interface.c). */
#include "projdyn/kernel.h"
#include "scene/choices.h"

static const struct kernel_model kernel_models[] = {
    {.name = "cubic_spline",
     .summary = "support of 2 particle spacings, 32 neighbours",
     .support = 2.0,
     .value = 8.0,
     .slope = 6.0,
     /* (6 * 1.5^2 + 12 * 36 (1 - sqrt(1/2))^4 + 8 * 36 (1 - sqrt(3/4))^4) / (2 pi)^2 */
     .squares = 0.42484,
     .tension = 1.6,
     .wetting_offset = 0.5,
     .surface = 2.2,
     .reach = 1.0,
     .half_areas = 0.127,
     .half_volumes = 0.150,
     .outside = 1.01,
     .beyond = 0.35,
     .layer = 12.95,
     .memory = 2300.0},
    {.name = "wendland",
     .summary = "Wendland C2, 2.5 particle spacings, 64 neighbours: water resists shear less",
     .wendland = true,
     .support = 2.5,
     .value = 10.361515119291825, /* 21 / 2 over 1.01337, its density in a cubic lattice */
     .slope = 20.0,
     .squares = 0.21119094462937396,
     .tension = 1.15,
     .wetting_offset = 0.45,
     .surface = 2.0,
     .reach = 1.2,
     .half_areas = 0.213,
     .half_volumes = 0.200,
     .outside = 1.29,
     .beyond = 0.37,
     .layer = 21.1,
     .memory = 3200.0},
};
const struct choices kernel_choices = {kernel_models, sizeof *kernel_models,
                                       sizeof kernel_models / sizeof *kernel_models};
