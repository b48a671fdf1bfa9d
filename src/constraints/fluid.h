/* What the two forms of the density constraint share: rows (fluid.c) and operator
 * (fluid_operator.c). */
#ifndef PDYN_FLUID_H
#define PDYN_FLUID_H

#include "projdyn/module.h"
#include "sph/kernel.h"

#include <math.h>

#define FLUID_STIFFEST 1e15 /* N/m */

struct fluid_params {
    double stiffness;                /* N/m */
    double compression, sound_speed; /* 1, m/s; 0 where the scene gives none, until resolved */
    double viscosity;
};

/* Computes two of stiffness, compression and sound_speed from the third (fluid_stiffness.c). */
pdyn_param_fault fluid_resolve(void *params, const pdyn_scene_info *scene);

extern const pdyn_operator fluid_operator;

static inline double fluid_particle_volume(const pdyn_body *body) {
    return 8.0 * body->radius * body->radius * body->radius;
}

/* The kernel times the volume of a particle: C is then a sum of numbers around one, with volumes
 * relative to that of a particle, whatever the scale of the scene. */
static inline struct kernel fluid_kernel(const pdyn_body *body) {
    struct kernel kernel = kernel_make(4.0 * body->radius);
    kernel.value *= fluid_particle_volume(body), kernel.slope *= fluid_particle_volume(body);
    return kernel;
}

static inline struct surface_kernel fluid_surface_kernel(const pdyn_body *body) {
    struct surface_kernel kernel = surface_kernel_make(2.0 * body->radius);
    kernel.value *= fluid_particle_volume(body);
    return kernel;
}

/* |grad C|^2 d^2 inside a cubic lattice of spacing d: the cubic spline of support 2 d over
 * neighbours at d, sqrt(2) d and sqrt(3) d,
 * (6 * 1.5^2 + 12 * 36 (1 - sqrt(1/2))^4 + 8 * 36 (1 - sqrt(3/4))^4) / (2 pi)^2 */
static const double fluid_lattice_squares = 0.42484;

/* k in the energy k / 2 C^2 of a constraint with |grad C|^2 = squares, in N m: the weight w over
 * squares, which makes k / 2 C^2 = w / 2 |u - p|^2 to first order. Squares count from once to
 * `most` times what they are inside the liquid: a particle with few neighbours is not stiffer than
 * others, and one that is crushed is not much softer. */
static inline double fluid_energy_stiffness(double w, double squares, double spacing) {
    const double inside = fluid_lattice_squares / (spacing * spacing), most = 4.0;
    return w / fmin(fmax(squares, inside), most * inside);
}

#endif
