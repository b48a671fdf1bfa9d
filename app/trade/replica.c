/* Overrides that turn a scene into a coarser replica (formulas: replica.h). */
#include "replica.h"
#include "scene_json.h"

#include <math.h>

/* ---- bodies that cannot be coarsened --------------------------------------------------------- */

/* Whether particle positions come from a file: their spacing cannot be changed. */
static bool has_files(const json_t *particles) {
    size_t k;
    json_t *entry;
    json_array_foreach(json_object_get(particles, "fill"), k, entry) {
        if (json_object_get(entry, "file")) return true;
    }
    return false;
}

/* Whether a pin selects vertices by number, which would select others on a coarser grid.
 * vertices: the "vertices" of a pin, or a part of it. */
static bool selects_by_number(const json_t *vertices) {
    size_t k;
    json_t *part;
    if (json_is_array(json_object_get(vertices, "vertices"))) return true;
    json_array_foreach(vertices, k, part) {
        if (json_is_integer(part) || selects_by_number(part)) return true;
    }
    return false;
}

/* Whether a constraint of the body selects vertices by number. */
static bool has_numbered_pins(const json_t *body) {
    size_t k;
    json_t *constraint;
    json_array_foreach(json_object_get(body, "constraints"), k, constraint) {
        if (selects_by_number(json_object_get(constraint, "vertices"))) return true;
    }
    return false;
}

/* ---- overrides ------------------------------------------------------------------------------- */

/* Overrides of stiffness and viscosity, if body b is a fluid. */
static void coarsen_fluid(const json_t *scene, size_t b, double factor, struct setting *replica) {
    size_t k;
    const json_t *fluid = scene_fluid(scene, b, &k);
    if (!fluid) return;
    if (json_object_get(fluid, "stiffness"))
        setting_add(replica, "bodies.%zu.constraints.%zu.stiffness=%.9g", b, k,
                    factor * scene_number(fluid, "stiffness", 0.0));
    setting_add(replica, "bodies.%zu.constraints.%zu.viscosity=%.9g", b, k,
                scene_viscosity(fluid) / (factor * factor));
}

static void coarsen_particles(const json_t *scene, const json_t *body, size_t b, double factor,
                              struct setting *replica) {
    const json_t *particles = json_object_get(body, "particles");
    if (!particles || has_files(particles)) return;
    setting_add(replica, "bodies.%zu.particles.radius=%.9g", b,
                factor * scene_number(particles, "radius", 0.0));
    coarsen_fluid(scene, b, factor, replica);
}

/* Vertices along a side of a grid with 1/factor as many edges, at least one edge. */
static int coarse_vertices(const json_t *vertices, size_t side, double factor) {
    double edges = json_number_value(json_array_get(vertices, side)) - 1.0;
    return 1 + (int)fmax(1.0, round(edges / factor));
}

static void coarsen_grid(const json_t *body, size_t b, double factor, struct setting *replica) {
    const json_t *grid = json_object_get(json_object_get(body, "surface"), "grid");
    const json_t *vertices = json_object_get(grid, "vertices");
    if (!vertices || has_numbered_pins(body)) return;
    setting_add(replica, "bodies.%zu.surface.grid.vertices=[%d, %d]", b,
                coarse_vertices(vertices, 0, factor), coarse_vertices(vertices, 1, factor));
}

static void coarsen_cells(const json_t *body, size_t b, double factor, struct setting *replica) {
    const json_t *volume = json_object_get(body, "volume");
    if (json_object_get(volume, "cell") && !has_numbered_pins(body))
        setting_add(replica, "bodies.%zu.volume.cell=%.9g", b,
                    factor * scene_number(volume, "cell", 0.0));
}

void replica_make(const json_t *scene, double factor, struct setting *replica) {
    const json_t *step = json_object_get(scene, "time_step");
    size_t b;
    json_t *body;
    json_array_foreach(json_object_get(scene, "bodies"), b, body) {
        coarsen_particles(scene, body, b, factor, replica);
        coarsen_grid(body, b, factor, replica);
        coarsen_cells(body, b, factor, replica);
    }
    if (replica->sets && !json_object_get(step, "fixed"))
        setting_add(replica, "time_step.cfl=%.9g", scene_number(step, "cfl", 1.0) / factor);
}
