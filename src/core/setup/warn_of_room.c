/* The warning "too-close": a fluid that leaves no room for the thickness of a sheet or a rigid body
 * (docs/theory/interface.md#thickness) is compressed at the start, and the surface throws it off.
 *
 *     o   o   o   o         start: half a spacing from the surface
 *    ================ sheet
 *                           rest: half a spacing and boundary_farther() from it
 */
#include "geometry/mesh_query.h"
#include "sim/extent.h"
#include "sim/live_particles.h"
#include "sim/sim.h"
#include "sph/boundary.h"
#include "warn.h"

/* Distance by which particles may start closer than they rest, in particle spacings. 32 kg of water
 * that fill a pinned trough exactly have 0.1 J at most within 0.1 s if they start closer by 0 or
 * 0.05, 1.4 J at 0.1, 5.5 J at 0.15 and 25 J at 0.3. */
static const double max_missing = 0.12;
/* Share of the particles beside a surface that may be too close. A ball or a tilted box in a
 * lattice has particles at all distances from half a spacing on: few are too close, and have room
 * to move away. */
static const double max_share = 0.5;

struct layer {   /* particles of a fluid beside a surface */
    int count;   /* closer to it than a spacing */
    int pressed; /* of these: closer than they rest, by more than max_missing */
    const char *surface;
};

/* farther: distance between surface and particles at rest beyond half a spacing, in spacings. */
static pdyn_status find_layer(const struct pdyn_sim *sim, const pdyn_body *fluid,
                              const struct scene_body *surface, double farther, struct layer *out) {
    double spacing = 2.0 * fluid->radius, close = (0.5 + farther - max_missing) * spacing;
    struct mesh_query query;
    pdyn_status status = mesh_query_create(sim->context, &surface->mesh, &query);
    if (status != PDYN_OK) return status;
    *out = (struct layer){.surface = surface->name};
    for (int i = fluid->first; i < fluid->first + fluid->count; i++) {
        const double *x = sim->x + 3 * (size_t)i;
        if (!particle_is_live(sim, i) || !mesh_query_is_close(&query, x, spacing)) continue;
        out->count++;
        out->pressed += mesh_query_is_close(&query, x, close);
    }
    mesh_query_free(sim->context, &query);
    return PDYN_OK;
}

/* Whether the body keeps a fluid away by its thickness, and reaches into the box of the fluid. */
static bool presses(const struct pdyn_sim *sim, int b, const struct box *water) {
    const pdyn_body *body = &sim->body[b];
    if (!body_is_thick(body) || body->permeability > 0.0) return false;
    struct box box = extent_of_body(sim, body);
    return box_overlaps(water, &box);
}

pdyn_status warn_of_room(struct pdyn_sim *sim, int body) {
    const pdyn_body *fluid = &sim->body[body];
    double spacing = 2.0 * fluid->radius;
    double farther = boundary_farther(sim->scene.contact.thickness, spacing);
    struct box water = extent_of_body(sim, fluid);
    struct layer worst = {0};
    pdyn_status status = PDYN_OK;
    if (farther <= max_missing || sim->scene.settings.boundary->volumes) return PDYN_OK;
    if (sim->scene.body[body].keep_overlap) return PDYN_OK;
    box_grow(&water, spacing);
    for (int b = 0; b < sim->bodies && status == PDYN_OK; b++) {
        struct layer layer = {0};
        if (presses(sim, b, &water))
            status = find_layer(sim, fluid, &sim->scene.body[b], farther, &layer);
        if (layer.pressed > max_share * layer.count && layer.pressed > worst.pressed) worst = layer;
    }
    if (worst.pressed)
        WARN(sim, TOO_CLOSE, fluid->name,
             "%d of %d particles beside \"%s\" start closer to it than they rest: with \"contact\" "
             "it has a thickness, and pushes them off; leave %.3g m between the surface and the "
             "volumes of `fill`",
             worst.pressed, worst.count, worst.surface, farther * spacing);
    return status;
}
