/* The stiffness w of a fluid, from the speed of sound or from the compression
 * (docs/theory/fluid.md):
 *
 *     bulk modulus     K = w / (c d)              d: particle spacing
 *     speed of sound   sqrt(K / rho)
 *     compression      rho g D / K                D: head of the fluid
 *
 * c = |grad C|^2 d^2 on a cubic lattice. Settled particles away from walls have the same value
 * within 1 % (cubic spline, measured in a tank of 20 x 20 x 20 particles).
 *
 * Damping: water would bounce where steps resolve the time in which sound crosses it
 * (docs/theory/time-integration.md#water-that-lands). */
#include "fluid.h"

#include "projdyn/vec3.h"

/* Where the scene gives none of the three: compression under pdyn_scene_info.pressure; without
 * gravity a stiffness, N/m. */
static const double default_compression = 1e-3, default_stiffness = 1e6;

/* The time in which sound crosses the fluid, less the longest step, which damps sound itself; 0
 * where fewer than two steps fit into that time: it would cost iterations for nothing. */
static double default_damping(const pdyn_scene_info *scene, double sound_speed) {
    double time = scene->size / sound_speed;
    return time > 2.0 * scene->step ? time - scene->step : 0.0;
}

pdyn_param_fault fluid_resolve(void *params, const pdyn_scene_info *scene) {
    struct fluid_params *p = params;
    double length = scene->kernel->squares * 2.0 * scene->radius, rho = scene->rest_density;
    double pressure = rho * vec3_length(scene->gravity) * scene->head;
    const char *given = p->compression > 0.0 ? "compression" : "sound_speed";
    if (p->compression > 0.0 && !(pressure > 0.0))
        return (pdyn_param_fault){"without gravity no pressure compresses the fluid; give "
                                  "\"sound_speed\" or \"stiffness\"",
                                  given};
    if (p->compression > 0.0) p->stiffness = length * pressure / p->compression;
    else if (p->sound_speed > 0.0) p->stiffness = length * rho * p->sound_speed * p->sound_speed;
    else if (p->stiffness < 0.0)
        p->stiffness = scene->pressure > 0.0 ? fmin(length * scene->pressure / default_compression,
                                                    FLUID_MAX_STIFFNESS)
                                             : default_stiffness;
    if (p->stiffness > FLUID_MAX_STIFFNESS)
        return (pdyn_param_fault){"expected a value that gives a stiffness of at most 1e+15 N/m",
                                  given};
    p->compression = length * pressure / p->stiffness;
    p->sound_speed = sqrt(p->stiffness / (length * rho));
    if (p->damping < 0.0) p->damping = default_damping(scene, p->sound_speed);
    return (pdyn_param_fault){0};
}
