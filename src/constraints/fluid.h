/* What the two forms of the density constraint share: rows (fluid.c) and operator
 * (fluid_operator.c). */
#ifndef PDYN_FLUID_H
#define PDYN_FLUID_H

#include "../core/kernel.h"
#include "projdyn/module.h"

#include <math.h>

#define FLUID_STIFFEST 1e15 /* N/m */

struct fluid_params {
    double stiffness;                /* N/m */
    double compression, sound_speed; /* 1, m/s; 0 where the scene gives none, until resolved */
    double viscosity, projection_tolerance;
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

/* The length t > 0 at which a constraint of value c > 0 is met on the line p = u - t grad C(u):
 * Newton's first step c / |grad C|^2, then secant steps until |C| < tolerance. `value` gives C at
 * t. It need not be asked where c is small: Newton's step leaves an error of -0.6 to 1.0 c^2
 * (measured in collapsing and in resting water). Where particles all but coincide there is hardly a
 * gradient and Newton's step leads far away; the bracket finds back. */
static inline double fluid_root(double (*value)(const void *line, double t), const void *line,
                                double c, double squares, double tolerance) {
    double t = c / squares, t_before = 0.0, low = 0.0, high = INFINITY;
    if (2.0 * c * c < tolerance) return t;
    for (int k = 0; k < 50; k++) {
        double next = value(line, t), slope = (next - c) / (t - t_before);
        if (fabs(next) < tolerance || (!(slope < 0.0) && high == INFINITY)) break;
        *(next > 0.0 ? &low : &high) = t;
        t_before = t, c = next;
        t -= next / slope;
        if (high == INFINITY || (t > low && t < high)) continue;
        t = low > 0.0 ? sqrt(low) * sqrt(high) : 1e-3 * high;
    }
    return t;
}

#endif
