/* Filling a body with particles: one function per shape of an entry of "fill". */
#include "fill.h"

#include "file_ref.h"
#include "geometry/sampling.h"
#include "params.h"
#include "transform.h"

#include <math.h>
#include <stdio.h>

/* an entry of "fill" while it is read */
struct fill {
    struct reader *reader;
    const struct json_at *entry;
    struct scene_body *body;
    bool has_velocity; /* the entry has its own "velocity" */
    double volume;     /* m^3, of the shape; INFINITY: not known */
};

/* ---- shapes: each appends particles to the body ---------------------------------------------- */

/* The part of a box that a lattice of whole cells fills. */
static double filled_part(const struct box *box, double spacing) {
    double part = 1.0;
    for (int a = 0; a < 3; a++) {
        double edge = box->max[a] - box->min[a];
        part *= spacing * sample_cells(edge, spacing) / edge;
    }
    return part;
}

/* The radius nearest to the given one, within a factor of two, whose cells divide the shortest edge
 * and fill 99 % of the box; 0: there is none. Rounded down to 5 digits, so that it fits as printed.
 */
static double fitting_radius(const struct box *box, double radius) {
    double shortest = INFINITY, best = 0.0;
    for (int a = 0; a < 3; a++) shortest = fmin(shortest, box->max[a] - box->min[a]);
    for (double cells = ceil(0.25 * shortest / radius); cells <= shortest / radius; cells++) {
        double fitting = 0.5 * shortest / cells, unit = pow(10.0, floor(log10(fitting)) - 4.0);
        fitting = unit * floor(fitting / unit * (1.0 + 1e-12));
        if (filled_part(box, 2.0 * fitting) < 0.99) continue;
        if (fabs(log(fitting / radius)) < fabs(log(best / radius))) best = fitting;
    }
    return best;
}

/* Says how much of a box particles fill where it is less than 95 %. */
static void note_filled_part(const struct json_at *at, const struct fill *fill,
                             const struct box *box) {
    double radius = fill->body->radius, part = filled_part(box, 2.0 * radius);
    double fitting = part < 0.95 ? fitting_radius(box, radius) : 0.0;
    char advice[64] = "";
    if (fitting > 0.0)
        snprintf(advice, sizeof advice, "; particles of radius %.5g m fill %.3g %%", fitting,
                 100.0 * filled_part(box, 2.0 * fitting));
    if (part < 0.95)
        context_log(
            at->file->context, PDYN_LOG_INFO,
            "body \"%s\": particles of radius %g m fill %.3g %% of a box of %g x %g x %g m%s",
            fill->body->name, radius, 100.0 * part, box->max[0] - box->min[0],
            box->max[1] - box->min[1], box->max[2] - box->min[2], advice);
}

/* Computes the number of particles as sample_box_volume does, before allocating them. */
static pdyn_status fill_box(const struct json_at *at, struct fill *fill) {
    double count = 1.0, volume = 1.0, radius = fill->body->radius;
    struct box box;
    pdyn_status status = params_box(at, &box);
    for (int a = 0; a < 3 && status == PDYN_OK; a++) {
        double edge = box.max[a] - box.min[a];
        double along = sample_cells(edge, 2.0 * radius);
        count *= along, volume *= edge;
        if (along < 1.0)
            status = json_fail(
                at, "expected edges of at least %.10g m (twice the radius), found %.10g m along %c",
                2.0 * radius, edge, "xyz"[a]);
    }
    if (status == PDYN_OK) status = reader_add_particles(fill->reader, at, count);
    if (status != PDYN_OK) return status;
    note_filled_part(at, fill, &box);
    fill->volume = volume;
    return json_wrap(at, sample_box_volume(at->file->context, &box, radius, &fill->body->start));
}

/* Adds the particles of a shape to the count; the body had `before` particles. */
static pdyn_status count_added(const struct json_at *at, struct fill *fill, int before) {
    int added = fill->body->start.count - before;
    if (added) return reader_add_particles(fill->reader, at, added);
    return json_fail(at, "no particle of radius %.10g m fits into the shape", fill->body->radius);
}

static pdyn_status fill_sphere(const struct json_at *at, struct fill *fill) {
    struct point_list *start = &fill->body->start;
    struct sphere sphere;
    int before = start->count;
    pdyn_status status = params_sphere(at, &sphere);
    if (status == PDYN_OK)
        status = json_wrap(
            at, sample_sphere_volume(at->file->context, &sphere, fill->body->radius, start));
    fill->volume = 4.0 / 3.0 * acos(-1.0) * sphere.radius * sphere.radius * sphere.radius;
    return status == PDYN_OK ? count_added(at, fill, before) : status;
}

/* Of the inside as particles see it, whichever way the triangles face. INFINITY: pieces cross, and
 * particles fill only places inside an odd number of them. */
static pdyn_status measure_mesh(pdyn_context *context, struct mesh *mesh, double *volume) {
    struct mesh_turned turned;
    pdyn_status status = mesh_orient_pieces(context, mesh, &turned);
    *volume = turned.crossing ? INFINITY
                              : fabs(mesh_volume(mesh->triangles, mesh->triangle, mesh->vertex));
    return status;
}

static pdyn_status fill_placed_mesh(const struct json_at *at, struct fill *fill,
                                    struct mesh *mesh) {
    pdyn_context *context = at->file->context;
    struct point_list *start = &fill->body->start;
    int before = start->count;
    pdyn_status status = mesh_check(mesh, "as placed");
    if (status == PDYN_OK) status = mesh_check_closed(context, mesh, json_string_value(at->value));
    if (status == PDYN_OK) status = sample_mesh_volume(context, mesh, fill->body->radius, start);
    if (status == PDYN_OK) status = measure_mesh(context, mesh, &fill->volume);
    status = json_wrap(at, status);
    return status == PDYN_OK ? count_added(at, fill, before) : status;
}

static pdyn_status fill_mesh(const struct json_at *at, struct fill *fill) {
    struct mesh mesh = {0};
    struct transform transform;
    pdyn_status status = transform_read(fill->entry, -1e6, &transform);
    if (status == PDYN_OK) status = file_ref_mesh(at, &mesh, NULL);
    if (status != PDYN_OK) return status;
    transform_points(&transform, mesh.vertex, mesh.vertices);
    status = fill_placed_mesh(at, fill, &mesh);
    mesh_free(at->file->context, &mesh);
    return status;
}

static pdyn_status fill_placed_file(const struct json_at *at, struct fill *fill,
                                    const struct particles *particles) {
    pdyn_context *context = at->file->context;
    struct scene_body *body = fill->body;
    pdyn_status status = reader_add_particles(fill->reader, at, particles->count);
    if (status == PDYN_OK)
        status = point_list_append(context, &body->start, particles->x, particles->count);
    body->keep_overlap = true; /* a fluid in motion comes closer to walls than a lattice */
    if (status == PDYN_OK && particles->v && !fill->has_velocity)
        status = point_list_append(context, &body->start_v, particles->v, particles->count);
    return status;
}

static pdyn_status fill_file(const struct json_at *at, struct fill *fill) {
    struct particles particles = {0};
    struct transform transform;
    pdyn_status status = transform_read(fill->entry, -1e6, &transform);
    if (status == PDYN_OK) status = file_ref_particles(at, &particles);
    if (status != PDYN_OK) return status;
    transform_points(&transform, particles.x, particles.count);
    if (particles.v) transform_directions(&transform, particles.v, particles.count);
    status = fill_placed_file(at, fill, &particles);
    particles_free(at->file->context, &particles);
    return status;
}

enum { SHAPES = 4 };
static const char *const shape_names[SHAPES] = {"box", "sphere", "mesh", "file"};
static const struct {
    pdyn_status (*fill)(const struct json_at *at, struct fill *fill);
    bool transformed; /* may have "scale", "rotate" and "translate" */
} shapes[SHAPES] = {{fill_box, false}, {fill_sphere, false}, {fill_mesh, true}, {fill_file, true}};

/* ---- entries --------------------------------------------------------------------------------- */

pdyn_status fill_check_range(const struct json_at *at, const struct point_list *points, int first) {
    const double *x = points->x;
    for (size_t i = 3 * (size_t)first; i < 3 * (size_t)points->count; i++)
        if (!(fabs(x[i]) <= SCENE_MAX_POSITION))
            return json_fail(at,
                             "expected particles at most %g m from the origin, found %c = %.10g m",
                             SCENE_MAX_POSITION, "xyz"[i % 3], x[i]);
    return PDYN_OK;
}

pdyn_status fill_read(struct reader *r, const struct json_at *at, struct scene_fill *out) {
    static const char *const keys[] = {"box",    "sphere",    "mesh",     "file", "scale",
                                       "rotate", "translate", "velocity", NULL};
    struct json_at velocity_at = json_member(at, "velocity");
    struct scene_body *body = r->body;
    struct fill fill = {r, at, body, velocity_at.value != NULL, INFINITY};
    double velocity[3];
    int shape = 0, first = body->start.count;
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = reader_one_of(at, shape_names, SHAPES, &shape);
    if (status == PDYN_OK && !shapes[shape].transformed)
        status = transform_refuse(at, "a \"mesh\" or a \"file\"");
    if (status == PDYN_OK && fill.has_velocity)
        status = params_reals(&velocity_at, 3, -1e6, 1e6, "m/s", velocity);
    if (status != PDYN_OK) return status;
    struct json_at inner = json_member(at, shape_names[shape]);
    status = shapes[shape].fill(&inner, &fill);
    if (status == PDYN_OK) status = fill_check_range(&inner, &body->start, first);
    double spacing = 2.0 * body->radius;
    out->end = body->start.count;
    out->part = (out->end - first) * spacing * spacing * spacing / fill.volume;
    while (status == PDYN_OK && body->start_v.count < body->start.count)
        status = point_list_add(at->file->context, &body->start_v,
                                fill.has_velocity ? velocity : body->velocity);
    return status;
}
