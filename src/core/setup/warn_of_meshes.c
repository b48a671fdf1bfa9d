/* Warnings about the scale of bodies and solids, and about meshes: thin triangles, oblong cells,
 * coarse tetrahedra, and edges beside the contact thickness. */
#include "sim/extent.h"
#include "sim/live_particles.h"
#include "sim/sim.h"
#include "warn.h"

#include "projdyn/vec3.h"

#include <string.h>

/* Extents that occur in practice. */
static const double min_extent = 2e-3, max_extent = 500.0; /* m */
static const double max_times = 10.0; /* extent of a body over that of all solids */
/* Extent of the mesh of a solid, or of a rigid body, over that of all else: a ground may be large.
 */
static const double max_solid_times = 50.0;
static const double min_filled = 0.85; /* of the volume of a mesh, by tetrahedra */
/* Of a volume of "fill", by particles: a ball of 4.5 particle spacings. */
static const double min_volume = 0.7;
/* Rounding of coordinates in frames, over the spacing of particles or the mean edge. */
static const double max_rounding = 0.01;
/* Height of a triangle over its longest side. */
static const double min_thinness = 0.01;
/* Long over short side of a cell of a grid: at 1.2 springs have 0.77 and 1.26 of their stiffness.
 */
static const double max_oblong = 1.2;
/* Contact thickness of a rigid body, in mean edge lengths; pairs grow with its square. */
static const double max_thickness = 2.5;

/* Extent of all bodies and solids together without one body and one solid, m; -1: without none.
 * INFINITY: nothing, or one particle, is there at the start. */
static double extent_beside(const struct pdyn_sim *sim, int body, int solid) {
    struct box box = extent_of_solids(sim, solid);
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; b != body && k < sim->body[b].count; k++)
            if (particle_is_live(sim, sim->body[b].first + k))
                box_add(&box, sim->x + 3 * (size_t)(sim->body[b].first + k));
    return box.min[0] <= box.max[0] && box_extent(&box) > 0.0 ? box_extent(&box) : INFINITY;
}

/* Extent of all solids together, m; INFINITY: there are none. */
static double length_of_solids(const struct pdyn_sim *sim) {
    struct box box = extent_of_solids(sim, -1);
    return sim->scene.solids ? box_extent(&box) : INFINITY;
}

/* Warns of a length that does not occur in practice. Returns whether it is one. */
static bool warn_of_length(struct pdyn_sim *sim, const char *name, double extent) {
    bool unusual = extent < min_extent || extent > max_extent;
    if (unusual)
        WARN(sim, SCALE, name,
             "it is %.3g m long; lengths are in metres, \"scale\" changes the unit of a mesh",
             extent);
    return unusual;
}

static void warn_of_times(struct pdyn_sim *sim, const char *name, double extent, double times,
                          const char *others) {
    WARN(
        sim, SCALE, name,
        "it is %.3g m long, %.2g times as long as all %s; lengths are in metres, \"scale\" changes "
        "the unit of a mesh",
        extent, times, others);
}

static void check_scale(struct pdyn_sim *sim, int b) {
    const pdyn_body *body = &sim->body[b];
    struct box box = extent_of_body(sim, body);
    double extent = box_extent(&box), times = extent / length_of_solids(sim);
    if (body_is_particles(body)) return;
    if (!warn_of_length(sim, body->name, extent) && times > max_times)
        warn_of_times(sim, body->name, extent, times, "solids");
}

/* Particles of `fill` in another unit than the solids. */
static void check_scale_of_fluid(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    int count = body->fills ? body->fill[body->fills - 1].end : 0;
    if (!count) return;
    struct box box = box_around(sim->x + 3 * (size_t)sim->body[b].first, count);
    double extent = box_extent(&box), times = extent / length_of_solids(sim);
    if (times > max_times)
        WARN(
            sim, SCALE, body->name,
            "its particles take %.3g m, %.2g times the length of all solids; lengths are in metres",
            extent, times);
}

/* Frames hold coordinates as floats, which are rounded by up to 2^-24 of their size. */
static void check_distance(struct pdyn_sim *sim, int b) {
    const pdyn_body *body = &sim->body[b];
    bool particles = body_is_particles(body);
    double distance = 0.0, size = particles ? 2.0 * body->radius : warn_mean_edge(body);
    for (int i = body->first; i < body->first + body->count; i++)
        for (int a = 0; a < 3 && particle_is_live(sim, i); a++)
            distance = fmax(distance, fabs(sim->x[3 * (size_t)i + (size_t)a]));
    if (size == 0.0 || distance * 0x1p-24 <= max_rounding * size) return;
    WARN(sim, SCALE, body->name,
         "frames have coordinates to %.2g m at %.6g m from the origin, its %s %.2g m %s: move the "
         "scene to the origin",
         distance * 0x1p-24, distance, particles ? "particles are" : "edges have", size,
         particles ? "apart" : "on average");
}

/* Warns of the longest body where it is rigid; beside solids, check_scale compares it with them. */
static void check_scale_of_rigid(struct pdyn_sim *sim) {
    int longest = 0;
    double extent = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        struct box box = extent_of_body(sim, &sim->body[b]);
        if (box_extent(&box) > extent) longest = b, extent = box_extent(&box);
    }
    if (sim->scene.solids || !sim->scene.body[longest].is_rigid || extent > max_extent) return;
    double times = extent / extent_beside(sim, longest, -1);
    if (times > max_solid_times)
        warn_of_times(sim, sim->body[longest].name, extent, times, "other bodies");
}

static void check_scale_of_solids(struct pdyn_sim *sim) {
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct scene_solid *solid = &sim->scene.solid[s];
        if (solid->kind != SOLID_MESH) continue;
        struct box box = box_around(solid->mesh.vertex, solid->mesh.vertices);
        double extent = box_extent(&box), times = extent / extent_beside(sim, -1, s);
        if (!warn_of_length(sim, solid->name, extent) && times > max_solid_times)
            warn_of_times(sim, solid->name, extent, times, "bodies and other solids");
    }
}

/* Height of a triangle over its longest side. */
static double thinness(const double *a, const double *b, const double *c) {
    double normal[3],
        side = fmax(vec3_distance(a, b), fmax(vec3_distance(b, c), vec3_distance(c, a)));
    vec3_normal(normal, a, b, c);
    return vec3_length(normal) / (side * side);
}

static void check_slivers(struct pdyn_sim *sim, int b) {
    const pdyn_body *body = &sim->body[b];
    const double *rest = body->rest, *first = NULL;
    int count = 0;
    for (int t = 0; !sim->scene.body[b].is_rigid && t < body->triangles; t++) {
        const int *corner = body->triangle + 3 * (size_t)t;
        const double *x[3];
        for (int k = 0; k < 3; k++) x[k] = rest + 3 * (size_t)corner[k];
        if (thinness(x[0], x[1], x[2]) >= min_thinness) continue;
        if (!count++) first = x[0];
    }
    if (count)
        WARN(sim, SLIVERS, body->name,
             "%d of its triangles %s a hundred times as long as high, or more, the first at (%.4g, "
             "%.4g, %.4g) m: steps need many iterations",
             count, count == 1 ? "is" : "are", first[0], first[1], first[2]);
}

/* Young's modulus along the sides of length a over the given one, of a sheet of springs whose cells
 * are a x b and have both diagonals equally often. */
static double modulus_along(double a, double b) { return 3.0 * a * a / (a * a + 2.0 * b * b); }

/* Warns of springs on a grid whose cells are not square: the sheet has another stiffness in each
 * direction. */
static void check_cells(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    const double *rest = sim->body[b].rest;
    bool springs = false;
    for (int k = 0; k < body->constraints; k++)
        springs |= !strcmp(body->constraint[k].type->name, "spring");
    if (!body->grid[0] || !springs) return;
    double first = vec3_distance(rest, rest + 3);
    double second = vec3_distance(rest, rest + 3 * (size_t)body->grid[0]);
    if (fmax(first, second) <= max_oblong * fmin(first, second)) return;
    WARN(sim, OBLONG, body->name,
         "the cells of its grid are %.3g m x %.3g m: \"spring\" has %.2g times the stiffness that "
         "is given along the first side, and %.2g times along the second",
         first, second, modulus_along(first, second), modulus_along(second, first));
}

/* Warns where "cell" is too large for the mesh that it fills. */
static void check_filled(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    if (body->crumbs && !body->is_rigid)
        WARN(sim, COARSE, body->name,
             "loose pieces smaller than eight cells: %d; beside them the mesh is thinner than "
             "\"cell\"",
             body->crumbs);
    else if (body->filled > 0.0 && body->filled < min_filled)
        WARN(sim, COARSE, body->name,
             "its cells fill %.2g %% of its mesh: parts thinner than \"cell\" are missing",
             100.0 * body->filled);
    else if (body->missed)
        WARN(sim, COARSE, body->name,
             "%d of the %d vertices of its mesh %s more than a cell away from the cells that fill "
             "it: parts thinner than \"cell\" are missing",
             body->missed, body->skin.vertices, body->missed == 1 ? "is" : "are");
}

/* Warns where particles are too large for a volume of "fill": names the one that is filled least.
 */
static void check_volumes(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    int least = -1;
    for (int k = 0; k < body->fills; k++)
        if (body->fill[k].part > 0.0 && body->fill[k].part < min_volume &&
            (least < 0 || body->fill[k].part < body->fill[least].part))
            least = k;
    if (least >= 0)
        WARN(sim, COARSE, body->name,
             "particles of radius %.4g m fill %.2g %% of the volume of fill[%d]", body->radius,
             100.0 * body->fill[least].part, least);
}

static void check_thickness(struct pdyn_sim *sim, int b) {
    const pdyn_body *body = &sim->body[b];
    double thickness = sim->scene.has_contact ? sim->scene.contact.thickness : 0.0;
    double edge = warn_mean_edge(body);
    bool rigid = sim->scene.body[b].is_rigid;
    if (body_is_particles(body) || thickness <= (rigid ? max_thickness : 1.0) * edge) return;
    if (rigid)
        WARN(sim, THICKNESS, body->name,
             "the contact thickness of %.3g m is %.2g times its mean edge length: contact of so "
             "fine a mesh takes long",
             thickness, thickness / edge);
    else
        WARN(sim, THICKNESS, body->name,
             "the contact thickness of %.3g m is above its mean edge length of %.3g m: contact "
             "acts between many neighbours, steps take long, and the surface cannot fold",
             thickness, edge);
}

void warn_of_meshes(struct pdyn_sim *sim) {
    check_scale_of_solids(sim);
    check_scale_of_rigid(sim);
    for (int b = 0; b < sim->bodies; b++) {
        check_scale(sim, b);
        check_scale_of_fluid(sim, b);
        check_distance(sim, b);
        check_slivers(sim, b);
        check_cells(sim, b);
        check_filled(sim, b);
        check_volumes(sim, b);
    }
}

void warn_of_thickness(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++) check_thickness(sim, b);
}
