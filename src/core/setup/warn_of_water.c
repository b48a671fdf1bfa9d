/* Warnings about surfaces in a fluid: meshes that it does not see well, bodies that do not sink. */
#include "geometry/bvh.h"
#include "sim/extent.h"
#include "sim/live_particles.h"
#include "sim/sim.h"
#include "sph/boundary.h"
#include "warn.h"

#include "projdyn/vec3.h"

/* Mean edge lengths of meshes in fluid, in particle spacings (docs/results/interface.md). */
static const double min_edge = 0.25, max_edge = 8.0;
/* Shares of the mass of a layer of particles: a sheet below the first stays on the water; a flat
 * body, whose shortest side is at most half of the middle one, that exceeds its water by the second
 * or less is not let down by it, and another body, a rod among them, by the third or less. */
static const double light_share = 0.02, flat_share = 0.5, thick_share = 1.0;
static const double flatness = 0.5;
static const double rounding = 1e-9; /* relative error of lengths and densities of a scene */
/* Width of a strip that flows around, in particle spacings. */
static const double narrow = 2.0;

const pdyn_body *warn_lightest_fluid(const struct pdyn_sim *sim) {
    const pdyn_body *lightest = NULL;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        if (!lightest || body->rest_density < lightest->rest_density) lightest = body;
    }
    return lightest;
}

/* Whether the surface has no border, as that of a bag or of a volume. */
static bool is_closed(const pdyn_body *body) { return 2 * body->edges == 3 * body->triangles; }

/* Whether particles of the fluid are in a box or within a particle radius of it. */
static bool is_wet(const struct pdyn_sim *sim, struct box box, const pdyn_body *fluid) {
    bool wet = false;
    box_grow(&box, fluid->radius);
    for (int i = fluid->first; i < fluid->first + fluid->count && !wet; i++)
        wet = particle_is_live(sim, i) && box_contains(&box, sim->x + 3 * (size_t)i);
    return wet;
}

/* Whether no particle of the fluid is near it at the start. */
static bool is_dry(const struct pdyn_sim *sim, int b, const pdyn_body *fluid) {
    return !is_wet(sim, extent_of_body(sim, &sim->body[b]), fluid);
}

/* Whether a key of the path moves the box into the fluid. Most keys of a long path are told from
 * the box of the fluid. */
static bool leads_into(const struct pdyn_sim *sim, const pdyn_path *path, const struct box *box,
                       const pdyn_body *fluid) {
    struct box liquid = extent_of_body(sim, fluid);
    bool into = false;
    box_grow(&liquid, fluid->radius);
    for (int k = 0; k < path->count && !into; k++) {
        const double *by = path->key + 4 * (size_t)k + 1;
        struct box moved = *box;
        for (int a = 0; a < 3; a++) moved.min[a] += by[a], moved.max[a] += by[a];
        into = box_overlaps(&moved, &liquid) && is_wet(sim, moved, fluid);
    }
    return into;
}

/* Whether pins draw a dry sheet, which is no narrow strip, along a path into the fluid. */
static bool is_drawn(const struct pdyn_sim *sim, int b, const pdyn_body *fluid) {
    const struct scene_body *body = &sim->scene.body[b];
    struct box box = extent_of_body(sim, &sim->body[b]);
    bool strip = mesh_area(&body->mesh) <= narrow * 2.0 * fluid->radius * box_extent(&box);
    if (strip || !is_dry(sim, b, fluid)) return false;
    for (int k = 0; k < body->constraints; k++) {
        const pdyn_path *path = warn_path(&body->constraint[k]);
        if (path && leads_into(sim, path, &box, fluid)) return true;
    }
    return false;
}

/* Thickness of sheets and rigid bodies in the fluid, m. */
static double thickness_in(const struct pdyn_sim *sim, const pdyn_body *fluid) {
    double spacing = 2.0 * fluid->radius;
    return sim->scene.has_contact
               ? 2.0 * spacing * boundary_farther(sim->scene.contact.thickness, spacing)
               : 0.0;
}

static double shortest_side(const struct box *box) {
    double shortest = INFINITY;
    for (int a = 0; a < 3; a++) shortest = fmin(shortest, box->max[a] - box->min[a]);
    return shortest;
}

static double middle_side(const struct box *box) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) sum += box->max[a] - box->min[a];
    return sum - shortest_side(box) - box_extent(box);
}

/* Part of the section across the shortest side that a body fills. Particles make way for it over a
 * section that is at least a spacing, m, long and wide. */
static double filled_section(const struct box *box, double spacing) {
    return fmin(1.0, middle_side(box) / spacing) * fmin(1.0, box_extent(box) / spacing);
}

/* Mass that a body exceeds its water by, kg/m^2: of a sheet per area, of a closed body along its
 * shortest side. Half of the thickness lies around a rigid body. */
static double excess_of(const struct pdyn_sim *sim, int b, const pdyn_body *fluid,
                        const struct box *box) {
    const struct scene_body *body = &sim->scene.body[b];
    double thickness = thickness_in(sim, fluid), displaced = fluid->rest_density;
    double height = shortest_side(box) * filled_section(box, 2.0 * fluid->radius);
    if (!(body->density > 0.0)) return body->area_density - displaced * thickness;
    if (body->is_rigid)
        displaced *= 1.0 + 0.5 * thickness * mesh_area(&body->mesh) * body->density / body->mass;
    return (body->density - displaced) * height;
}

/* A sheet, or a body that is denser than the fluid. */
static void check_sinking(struct pdyn_sim *sim, int b, const pdyn_body *fluid, bool sheet) {
    const char *name = sim->scene.body[b].name, *wet = sheet ? ", or `permeability`" : "";
    struct box box = extent_of_body(sim, &sim->body[b]);
    double shortest = shortest_side(&box), excess = excess_of(sim, b, fluid, &box);
    bool flat = sheet || shortest <= (1.0 + rounding) * flatness * middle_side(&box);
    double most = (flat ? flat_share : thick_share) * 2.0 * fluid->radius * fluid->rest_density;
    if (excess < 0.0)
        WARN(
            sim, LIGHT, name,
            "with the contact thickness of %.3g m it displaces %.3g kg/m^2 more of the \"%s\" than "
            "it weighs: it floats; a smaller `thickness`%s",
            thickness_in(sim, fluid), -excess, fluid->name, wet);
    else if (excess > 0.0 && excess <= (1.0 + rounding) * most && (!sheet || is_dry(sim, b, fluid)))
        WARN(sim, LIGHT, name,
             "it is %.3g kg/m^2 heavier than the \"%s\" that it displaces, at most %s of particles "
             "(%.3g kg/m^2): it floats or sinks too slowly; smaller particles%s",
             excess, fluid->name, flat ? "half a layer" : "one layer", most, wet);
}

/* Sheets that do not get wet, and bodies that are heavier than water, but do not sink in one of
 * particles (docs/results/interface.md). */
static void check_weight(struct pdyn_sim *sim, int b, const pdyn_body *fluid) {
    const struct scene_body *body = &sim->scene.body[b];
    double spacing = 2.0 * fluid->radius, layer = fluid->rest_density * spacing;
    bool sheet = body_is_sheet(&sim->body[b]);
    if (body_is_particles(&sim->body[b]) || sim->body[b].permeability > 0.0) return;
    if (sheet && is_closed(&sim->body[b])) return;
    if (warn_is_held(body) && !is_drawn(sim, b, fluid)) return;
    if (sheet && body->area_density < light_share * layer)
        WARN(sim, LIGHT, body->name,
             "its %.3g kg/m^2 are %.2g of a layer of particles %.3g m apart: it stays on the "
             "\"%s\", and its steps need many iterations; with `permeability` it sinks",
             body->area_density, body->area_density / layer, spacing, fluid->name);
    else if (sheet || body->density > (1.0 + rounding) * fluid->rest_density)
        check_sinking(sim, b, fluid, sheet);
}

static void check_edges(struct pdyn_sim *sim, int b, const pdyn_body *fluid) {
    const pdyn_body *body = &sim->body[b];
    double ratio = warn_mean_edge(body) / (2.0 * fluid->radius);
    if (sim->scene.body[b].is_rigid) return; /* its steps cost the same, its faces are sampled */
    if (body_is_particles(body) || (ratio >= min_edge && ratio <= max_edge)) return;
    WARN(sim, EDGE_LENGTH, body->name,
         "its mean edge length is %.3g particle spacings; expected %g to %g", ratio, min_edge,
         max_edge);
}

/* Whether the fluid is there at the start: on what inlets pour over a body it does not float. */
static bool is_there(const struct pdyn_sim *sim, const pdyn_body *fluid) {
    return fluid->count > sim->scene.body[fluid - sim->body].budget;
}

void warn_of_water(struct pdyn_sim *sim) {
    const struct scene_settings *settings = &sim->scene.settings;
    const pdyn_body *fluid = warn_lightest_fluid(sim);
    bool falls = vec3_length(settings->gravity) > 0.0 || settings->gravity_keys.path.count;
    bool sinks = fluid && falls && is_there(sim, fluid);
    for (int b = 0; b < sim->bodies && fluid; b++) {
        if (sinks) check_weight(sim, b, fluid);
        check_edges(sim, b, fluid);
    }
}
