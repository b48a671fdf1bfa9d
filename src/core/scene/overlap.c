#include "overlap.h"

#include "geometry/mesh_query.h"
#include "poses.h"
#include "vessel.h"

enum { GRAIN = 1024 }; /* particles per parallel block */

static const double max_overlap = 1e-3; /* share of a body's particles that may overlap when kept */

struct obstacle { /* a solid or a body with triangles */
    const char *kind, *name;
    struct mesh mesh;                 /* at the start of the scene; vertices may be a copy */
    bool sheet;                       /* water may be meant to stretch it */
    const struct scene_solid *vessel; /* NULL: no vessel */
};

/* Flags of a particle. */
enum { CLOSE = 1, INSIDE = 2 };

struct search {
    const struct mesh_query *query;
    const double *x;
    double distance;
    bool closed;
    const struct scene_solid *vessel;
    double behind; /* m: distance within which the walls of a vessel push fluid outside of it */
    unsigned char *flag;
};

/* Whether a point of the world is behind a wall at the start of the scene. */
static bool is_behind_wall(const struct scene_solid *vessel, const double x[3], double distance) {
    double rest[3];
    pose_to_rest(&vessel->motion, 0.0, x, rest);
    return vessel_is_behind_wall(vessel, rest, distance);
}

static void flag_particles(void *arg, int first, int last, int block) {
    (void)block;
    const struct search *s = arg;
    for (int i = first; i < last; i++) {
        const double *x = s->x + 3 * (size_t)i;
        s->flag[i] = mesh_query_is_close(s->query, x, s->distance) ? CLOSE : 0;
        if (s->closed && mesh_query_contains(s->query, x)) s->flag[i] |= INSIDE;
        if (s->vessel && is_behind_wall(s->vessel, x, s->behind)) s->flag[i] |= CLOSE;
    }
}

/* Drops the flag INSIDE where most particles have it: the obstacle is a vessel. */
static void exempt_vessel(unsigned char *flag, int count) {
    int inside = 0;
    for (int i = 0; i < count; i++) inside += (flag[i] & INSIDE) != 0;
    for (int i = 0; 2 * inside > count && i < count; i++) flag[i] &= (unsigned char)~INSIDE;
}

/* Removes flagged particles. Returns how many. */
static int remove_flagged(struct scene_body *body, const unsigned char *flag) {
    int kept = 0, fill = 0, count = body->start.count;
    for (int i = 0; i < count; i++) {
        while (i == body->fill[fill].end) body->fill[fill++].end = kept;
        if (flag[i]) continue;
        for (int a = 0; a < 3; a++) {
            body->start.x[3 * kept + a] = body->start.x[3 * i + a];
            body->start_v.x[3 * kept + a] = body->start_v.x[3 * i + a];
        }
        kept++;
    }
    while (fill < body->fills) body->fill[fill++].end = kept;
    body->start.count = body->start_v.count = kept;
    return count - kept;
}

static pdyn_status check_kept(const struct json_at *at, const struct scene_body *body,
                              const struct obstacle *o, const unsigned char *flag) {
    int count = 0, first = -1;
    for (int i = 0; i < body->start.count; i++) {
        if (flag[i] && first < 0) first = i;
        count += flag[i] != 0;
    }
    if (o->sheet || count <= max_overlap * body->start.count) return PDYN_OK;
    const double *x = body->start.x + 3 * (size_t)first;
    return json_fail(at,
                     "%d of %d particles overlap %s \"%s\", the first at (%.6g, %.6g, %.6g) m; "
                     "expected at most %g %%; with \"overlap\": \"remove\" they are left out",
                     count, body->start.count, o->kind, o->name, x[0], x[1], x[2],
                     1e2 * max_overlap);
}

static pdyn_status resolve_flagged(const struct json_at *at, struct scene_body *body,
                                   const struct obstacle *o, const unsigned char *flag) {
    if (body->keep_overlap) return check_kept(at, body, o, flag);
    int count = body->start.count, removed = remove_flagged(body, flag);
    body->overlapping += removed;
    if (removed)
        context_log(at->file->context, PDYN_LOG_INFO,
                    "body \"%s\": %d of %d particles overlap %s \"%s\" and are left out",
                    body->name, removed, count, o->kind, o->name);
    if (body->start.count || body->inlets) return PDYN_OK;
    return json_fail(at, "all %d particles overlap %s \"%s\", none is left", count, o->kind,
                     o->name);
}

/* Whether some particle may be inside the obstacle or so close to it that it is left out. */
static bool is_near(const struct scene_body *body, const struct obstacle *o) {
    struct box water = box_around(body->start.x, body->start.count);
    struct box obstacle = box_around(o->mesh.vertex, o->mesh.vertices);
    box_grow(&water, body->radius * (o->vessel ? VESSEL_WALL_REACH : 1.0));
    return box_overlaps(&water, &obstacle);
}

static pdyn_status resolve_near(const struct json_at *at, struct scene_body *body,
                                const struct obstacle *o, unsigned char *flag) {
    pdyn_context *context = at->file->context;
    struct mesh_query query;
    pdyn_status closed = o->vessel ? PDYN_BAD_INPUT : mesh_check_closed(context, &o->mesh, o->name);
    if (closed == PDYN_NO_MEMORY) return closed;
    pdyn_status status = mesh_query_create(context, &o->mesh, &query);
    if (status != PDYN_OK) return status;
    /* lattices that touch a surface have rounding errors */
    double distance = body->keep_overlap ? 0.5 * body->radius : (1.0 - 1e-3) * body->radius;
    struct search search = {.query = &query,
                            .x = body->start.x,
                            .distance = distance,
                            .closed = closed == PDYN_OK,
                            .vessel = body->keep_overlap ? NULL : o->vessel,
                            .behind = VESSEL_WALL_REACH * body->radius,
                            .flag = flag};
    pool_for(context->pool, body->start.count, GRAIN, flag_particles, &search);
    mesh_query_free(context, &query);
    exempt_vessel(flag, body->start.count);
    return resolve_flagged(at, body, o, flag);
}

static pdyn_status resolve_obstacle(const struct json_at *at, struct scene_body *body,
                                    const struct obstacle *o) {
    pdyn_context *context = at->file->context;
    int count = body->start.count;
    if (!is_near(body, o)) return PDYN_OK;
    unsigned char *flag = NEW_ARRAY(context, count, unsigned char);
    if (!flag) return PDYN_NO_MEMORY;
    pdyn_status status = resolve_near(at, body, o, flag);
    FREE_ARRAY(context, flag, count);
    return status;
}

/* The solid as it stands at time 0. */
static pdyn_status resolve_solid(const struct json_at *at, struct scene_body *body,
                                 const struct scene_solid *solid) {
    pdyn_context *context = at->file->context;
    struct obstacle o = {"solid", solid->name, solid->mesh, false, solid->is_vessel ? solid : NULL};
    size_t size = 3 * (size_t)solid->mesh.vertices;
    if (!solid->motion.keys) return resolve_obstacle(at, body, &o);
    o.mesh.vertex = NEW_ARRAY(context, size, double);
    if (!o.mesh.vertex) return PDYN_NO_MEMORY;
    pose_place(&solid->motion, solid->mesh.vertex, solid->mesh.vertices, 0.0, o.mesh.vertex);
    pdyn_status status = resolve_obstacle(at, body, &o);
    FREE_ARRAY(context, o.mesh.vertex, size);
    return status;
}

pdyn_status overlap_resolve(const struct json_at *at, const struct scene *scene,
                            struct scene_body *body) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < scene->solids && status == PDYN_OK && body->start.count; k++)
        status = resolve_solid(at, body, &scene->solid[k]);
    for (int k = 0; k < scene->bodies && status == PDYN_OK && body->start.count; k++) {
        const struct scene_body *other = &scene->body[k];
        bool sheet = other->area_density > 0.0;
        const struct obstacle o = {"body", other->name, other->mesh, sheet, NULL};
        bool holds_water = other->has_mesh && other->permeability == 0.0;
        if (holds_water) status = resolve_obstacle(at, body, &o);
    }
    return status;
}
