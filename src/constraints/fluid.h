/* Parameters, kernels and stiffness of the density constraint, for its rows (fluid.c) and its
 * matrix-free operator (fluid_operator.c). */
#ifndef PDYN_FLUID_H
#define PDYN_FLUID_H

#include "projdyn/kernel.h"
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <math.h>

#define FLUID_MAX_STIFFNESS 1e15 /* N/m */

struct fluid_params {
    double stiffness;                /* w, N/m; -1 before fluid_resolve if the scene gives none */
    double compression, sound_speed; /* 1, m/s; 0 before fluid_resolve if the scene gives none */
    double viscosity;                /* XSPH factor per step, 1 */
    double damping;                  /* s; -1 before fluid_resolve if the scene gives none */
};

/* Computes two of stiffness, compression and sound_speed from the third, and damping if it is not
 * given (fluid_stiffness.c). */
pdyn_param_fault fluid_resolve(void *params, const pdyn_scene_info *scene);

extern const pdyn_operator fluid_operator;

/* Rest volume of a particle: a cube of edge 2 r, m^3. */
static inline double fluid_particle_volume(const pdyn_body *body) {
    return 8.0 * body->radius * body->radius * body->radius;
}

/* The kernel W and the surface kernel times the volume of a particle. With volumes relative to that
 * volume, C is a sum of numbers near 1 at any length scale of the scene. */
static inline struct kernel fluid_kernel(const struct kernel_model *model, double spacing) {
    double volume = spacing * spacing * spacing;
    struct kernel kernel = kernel_make(model, model->support * spacing);
    kernel.value *= volume, kernel.slope *= volume;
    return kernel;
}

static inline struct surface_kernel fluid_surface_kernel(const struct kernel_model *model,
                                                         double spacing) {
    struct surface_kernel kernel = surface_kernel_make(model, spacing);
    kernel.value *= spacing * spacing * spacing;
    return kernel;
}

/* The volume share * A of a sample, A the area of the triangle of its corners, and its gradient
 * with respect to them (3 x 3): dA/dx_m = n x (x_(m+2) - x_(m+1)) / 2, n: unit normal. With the
 * volume of the beginning of the step instead, water would gain energy from a sheet that it
 * stretches (docs/theory/interface.md#samples). */
static inline double fluid_sample_volume(double share, const double *const corner[3],
                                         double *gradient) {
    double n[3], edge[3];
    vec3_normal(n, corner[0], corner[1], corner[2]);
    double area = 0.5 * vec3_length(n);
    for (int m = 0; m < 3; m++) {
        vec3_subtract(edge, corner[(m + 2) % 3], corner[(m + 1) % 3]);
        vec3_cross(gradient + 3 * m, n, edge);
        for (int a = 0; a < 3; a++) gradient[3 * m + a] *= area > 0.0 ? 0.25 * share / area : 0.0;
    }
    return share * area;
}

/* k of the energy k/2 C^2, N m: w / |grad C|^2, so that k/2 C^2 = w/2 |u - p|^2 to first order.
 * squares = |grad C|^2 is clamped to 1 to 4 times its value inside the liquid: a particle with few
 * neighbours is not stiffer than others, and a compressed particle not much softer. */
static inline double fluid_energy_stiffness(const struct kernel_model *model, double w,
                                            double squares, double spacing) {
    const double inside = model->squares / (spacing * spacing), upper = 4.0;
    return w / fmin(fmax(squares, inside), upper * inside);
}

#endif
