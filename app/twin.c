#include "twin.h"
#include "scene_json.h"

#include <math.h>

/* ---- what cannot be coarser ------------------------------------------------------------------ */

/* Particles from a file are as large as they are. */
static bool has_files(const json_t *particles) {
    size_t k;
    json_t *entry;
    json_array_foreach(json_object_get(particles, "fill"), k, entry) {
        if (json_object_get(entry, "file")) return true;
    }
    return false;
}

/* Is one of the pins for vertices by their number? `vertices`: what a pin holds, or a part of it.
 */
static bool has_numbers(const json_t *vertices) {
    size_t k;
    json_t *part;
    if (json_is_array(json_object_get(vertices, "vertices"))) return true;
    json_array_foreach(vertices, k, part) {
        if (json_is_integer(part) || has_numbers(part)) return true;
    }
    return false;
}

static bool pins_numbers(const json_t *body) {
    size_t k;
    json_t *constraint;
    json_array_foreach(json_object_get(body, "constraints"), k, constraint) {
        if (has_numbers(json_object_get(constraint, "vertices"))) return true;
    }
    return false;
}

/* ---- what can -------------------------------------------------------------------------------- */

/* w / d and viscosity d^2 / h stay what they are (docs/scene.md, fluid). A stiffness that is given
 * as a compression or a speed of sound follows the radius by itself. */
static void coarsen_fluid(const json_t *scene, size_t b, double factor, struct setting *twin) {
    size_t body, k;
    const json_t *fluid = scene_fluid(scene, &body, &k);
    if (!fluid || body != b) return;
    if (!json_object_get(fluid, "compression") && !json_object_get(fluid, "sound_speed"))
        setting_add(twin, "bodies.%zu.constraints.%zu.stiffness=%.9g", b, k,
                    factor * scene_stiffness(fluid));
    setting_add(twin, "bodies.%zu.constraints.%zu.viscosity=%.9g", b, k,
                scene_viscosity(fluid) / (factor * factor));
}

static void coarsen_particles(const json_t *scene, const json_t *body, size_t b, double factor,
                              struct setting *twin) {
    const json_t *particles = json_object_get(body, "particles");
    if (!particles || has_files(particles)) return;
    setting_add(twin, "bodies.%zu.particles.radius=%.9g", b,
                factor * scene_number(particles, "radius", 0.0));
    coarsen_fluid(scene, b, factor, twin);
}

static int fewer(const json_t *vertices, size_t side, double factor) {
    double edges = json_number_value(json_array_get(vertices, side)) - 1.0;
    return 1 + (int)fmax(1.0, round(edges / factor));
}

static void coarsen_grid(const json_t *body, size_t b, double factor, struct setting *twin) {
    const json_t *grid = json_object_get(json_object_get(body, "surface"), "grid");
    const json_t *vertices = json_object_get(grid, "vertices");
    if (!vertices || pins_numbers(body)) return;
    setting_add(twin, "bodies.%zu.surface.grid.vertices=[%d, %d]", b, fewer(vertices, 0, factor),
                fewer(vertices, 1, factor));
}

void twin_make(const json_t *scene, double factor, struct setting *twin) {
    const json_t *step = json_object_get(scene, "time_step");
    size_t b;
    json_t *body;
    json_array_foreach(json_object_get(scene, "bodies"), b, body) {
        coarsen_particles(scene, body, b, factor, twin);
        coarsen_grid(body, b, factor, twin);
    }
    if (twin->sets && !json_object_get(step, "fixed"))
        setting_add(twin, "time_step.cfl=%.9g", scene_number(step, "cfl", 1.0) / factor);
}
