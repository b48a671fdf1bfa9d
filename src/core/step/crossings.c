#include "crossings.h"

#include "geometry/distance.h"
#include "live_particles.h"
#include "scene/poses.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <limits.h>
#include <stdlib.h>

enum { GRAIN = 512 }; /* particles per parallel block */

struct surface { /* of a body or a solid */
    const char *name;
    const int *triangle; /* triangles x 3 */
    const int *across;   /* triangles x 3: -1 for a side on the border; NULL for a solid */
    int triangles, vertices;
    const double *begin, *end;       /* vertices x 3, m: at the two ends of the step */
    const struct scene_solid *moves; /* the solid with prescribed motion, or NULL */
    double *placed, *pose[2]; /* its vertices relative to the pivot; at both ends of the step */
    long beyond;              /* number of particles beyond the surface */
};

struct triangle_set { /* triangles of some surfaces and their hierarchy */
    int count, capacity;
    int *surface, *triangle; /* capacity: of each triangle */
    struct box *box;         /* capacity, m: from the beginning to the end of the step */
    struct bvh tree;
};

struct crossings {
    int surfaces, solids; /* the last surfaces are solids */
    struct surface *surface;
    struct triangle_set resting, moving;
    bool fluid;    /* particles are tested */
    bool bodies;   /* vertices of bodies are tested */
    double *slack; /* bodies, m: how far a vertex of a body leaves a surface that it passes */
    /* particles: 0, or s + 1 for surface s, negative against its normal */
    int *passed; /* the surface that the particle passed in this step */
    int *beyond; /* the surface that the particle is beyond */
};

/* ---- creation -------------------------------------------------------------------------------- */

static bool resize_arrays(struct pdyn_sim *sim, enum array_action action) {
    struct crossings *c = sim->crossings;
    const struct array_entry table[] = {
        ARRAY(c->surface, sim->bodies + sim->scene.solids),
        ARRAY(c->passed, sim->objective.particles),
        ARRAY(c->beyond, sim->objective.particles),
        ARRAY(c->slack, sim->bodies),
    };
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
}

static bool resize_set(pdyn_context *context, struct triangle_set *set, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(set->surface, set->capacity),
        ARRAY(set->triangle, set->capacity),
        ARRAY(set->box, set->capacity),
    };
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

static bool resize_solid(pdyn_context *context, struct surface *s, enum array_action action) {
    const size_t count = s->moves ? 3 * (size_t)s->vertices : 0;
    const struct array_entry table[] = {ARRAY(s->placed, count), ARRAY(s->pose[0], count),
                                        ARRAY(s->pose[1], count)};
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

static pdyn_status add_solid(struct pdyn_sim *sim, struct surface *s,
                             const struct scene_solid *solid) {
    const struct mesh *mesh = &solid->mesh;
    *s = (struct surface){.name = solid->name,
                          .triangle = mesh->triangle,
                          .triangles = mesh->triangles,
                          .vertices = mesh->vertices,
                          .begin = mesh->vertex,
                          .end = mesh->vertex,
                          .moves = solid->keys ? solid : NULL};
    if (!resize_solid(sim->context, s, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int k = 0; s->moves && k < 3 * s->vertices; k++)
        s->placed[k] = mesh->vertex[k] - solid->pivot[k % 3];
    if (s->moves) s->begin = s->pose[0], s->end = s->pose[1];
    return PDYN_OK;
}

/* Surfaces of bodies, if there is fluid, then solids. */
static pdyn_status list_surfaces(struct pdyn_sim *sim) {
    struct crossings *c = sim->crossings;
    for (int b = 0; b < sim->bodies && c->fluid; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body->triangles || body->permeability > 0.0) continue;
        c->surface[c->surfaces++] = (struct surface){.name = body->name,
                                                     .triangle = body->triangle,
                                                     .across = body->across,
                                                     .triangles = body->triangles,
                                                     .begin = sim->x + 3 * (size_t)body->first,
                                                     .end = sim->x_next + 3 * (size_t)body->first};
    }
    for (; c->solids < sim->scene.solids; c->solids++) {
        const struct scene_solid *solid = &sim->scene.solid[c->solids];
        pdyn_status status = add_solid(sim, &c->surface[c->surfaces++], solid);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
}

static bool is_at_rest(const struct surface *s) { return s->begin == s->end; }

static pdyn_status fill_set(struct pdyn_sim *sim, struct triangle_set *set, bool resting) {
    const struct crossings *c = sim->crossings;
    for (int s = 0; s < c->surfaces; s++)
        if (is_at_rest(&c->surface[s]) == resting) set->capacity += c->surface[s].triangles;
    if (!resize_set(sim->context, set, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int s = 0; s < c->surfaces; s++)
        for (int t = 0; is_at_rest(&c->surface[s]) == resting && t < c->surface[s].triangles; t++)
            set->surface[set->count] = s, set->triangle[set->count++] = t;
    return bvh_create(sim->context, set->capacity, &set->tree);
}

/* The box around the path of each triangle. */
static void build_tree(const struct crossings *c, struct triangle_set *set) {
    for (int k = 0; k < set->count; k++) {
        const struct surface *s = &c->surface[set->surface[k]];
        const int *corner = s->triangle + 3 * (size_t)set->triangle[k];
        set->box[k] = box_empty;
        for (int i = 0; i < 3; i++) {
            box_add(&set->box[k], s->begin + 3 * (size_t)corner[i]);
            box_add(&set->box[k], s->end + 3 * (size_t)corner[i]);
        }
    }
    bvh_build(&set->tree, set->box, set->count, NULL);
}

/* A vertex may lie on a solid, as those of a sheet that is held at a wall, and move a little there.
 * It passes by this part of the size of a triangle. */
static const double slack_part = 0.01;

static double slack_of(const pdyn_body *body) {
    double area = 0.0;
    for (int t = 0; t < body->triangles; t++) area += body->triangle_area[t];
    return slack_part * sqrt(area / fmax(1.0, body->triangles));
}

pdyn_status crossings_create(struct pdyn_sim *sim) {
    bool fluid = false, surfaces = false, solids = sim->scene.solids;
    for (int b = 0; b < sim->bodies; b++)
        fluid |= sim->body[b].radius > 0.0, surfaces |= sim->body[b].triangles > 0;
    bool bodies = solids && surfaces && !sim->scene.has_contact;
    if (!bodies && !(fluid && (solids || surfaces))) return PDYN_OK;
    struct crossings *c = sim->crossings = NEW_ARRAY(sim->context, 1, struct crossings);
    if (!c) return PDYN_NO_MEMORY;
    c->fluid = fluid, c->bodies = bodies;
    if (!resize_arrays(sim, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int b = 0; b < sim->bodies; b++) c->slack[b] = slack_of(&sim->body[b]);
    pdyn_status status = list_surfaces(sim);
    if (status == PDYN_OK) status = fill_set(sim, &c->resting, true);
    if (status == PDYN_OK) status = fill_set(sim, &c->moving, false);
    if (status == PDYN_OK) build_tree(c, &c->resting);
    return status;
}

void crossings_free(struct pdyn_sim *sim) {
    struct crossings *c = sim->crossings;
    pdyn_context *context = sim->context;
    if (!c) return;
    for (int s = 0; s < c->surfaces; s++) resize_solid(context, &c->surface[s], ARRAYS_FREE);
    struct triangle_set *sets[] = {&c->resting, &c->moving};
    for (int k = 0; k < 2; k++) {
        resize_set(context, sets[k], ARRAYS_FREE);
        bvh_free(context, &sets[k]->tree);
    }
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(context, sim->crossings, 1);
}

/* ---- one particle and one triangle ----------------------------------------------------------- */

struct path { /* of a particle in the step */
    const struct crossings *crossings;
    const struct triangle_set *set;
    const double *begin, *end;
    double radius, slack;   /* of the particle, m */
    int first_surface;      /* surfaces before this one do not count */
    int surface, direction; /* the first one passed; sum of the directions, +1 along the normal */
};

/* The plane's corners and normal at time t of the step, 0 to 1; returns the distance of the
 * particle, times the length of the normal. */
static double plane_at(const struct path *path, int k, double t, double corner[3][3], double n[3]) {
    const struct surface *s = &path->crossings->surface[path->set->surface[k]];
    const int *vertex = s->triangle + 3 * (size_t)path->set->triangle[k];
    double r[3];
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) {
            size_t at = 3 * (size_t)vertex[i] + (size_t)a;
            corner[i][a] = (1.0 - t) * s->begin[at] + t * s->end[at];
        }
    vec3_normal(n, corner[0], corner[1], corner[2]);
    for (int a = 0; a < 3; a++) r[a] = (1.0 - t) * path->begin[a] + t * path->end[a] - corner[0][a];
    return vec3_dot(r, n);
}

/* Width of the border of a triangle, relative to its size. The plane turns within a step, so the
 * time at which a particle meets it is not exact. */
static const double border = 1e-3;

/* Inside or on the border: a particle that passes through the common edge of two
 * triangles passes both in the same direction, which counts once. */
static bool is_inside(const double x[3], double corner[3][3], const double n[3]) {
    for (int i = 0; i < 3; i++) {
        double side[3];
        vec3_normal(side, corner[i], corner[(i + 1) % 3], x);
        if (vec3_dot(side, n) < -border * vec3_dot(n, n)) return false;
    }
    return true;
}

struct border_search { /* for a border edge close to a point */
    const struct path *path;
    int surface;
    double t, x[3];
    bool found;
};

static void test_border(void *user, int k) {
    struct border_search *s = user;
    const struct triangle_set *set = s->path->set;
    const int *across = s->path->crossings->surface[s->surface].across;
    double corner[3][3], n[3], weight[4];
    if (s->found || set->surface[k] != s->surface) return;
    plane_at(s->path, k, s->t, corner, n);
    for (int i = 0; i < 3; i++) {
        const double *side[4] = {s->x, s->x, corner[(i + 1) % 3], corner[(i + 2) % 3]};
        if (across[3 * (size_t)set->triangle[k] + (size_t)i] < 0 &&
            closest_edge_edge(side, weight) < s->path->radius * s->path->radius)
            s->found = true;
    }
}

/* Closer to the border of the surface than the particle's radius: the particle goes around. The
 * border edge may belong to another triangle than k. */
static bool is_on_border(const struct path *path, int k, double t, const double x[3]) {
    struct border_search s = {.path = path, .surface = path->set->surface[k], .t = t};
    struct box box;
    if (!path->crossings->surface[s.surface].across) return false;
    for (int a = 0; a < 3; a++)
        s.x[a] = x[a], box.min[a] = x[a] - path->radius, box.max[a] = x[a] + path->radius;
    bvh_visit(&path->set->tree, &box, 0, test_border, &s);
    return s.found;
}

/* The direction in which a particle passes a plane, +1 along its normal; 0: it does not. slack and
 * distances at the two ends of the step: times the length of the normal. */
static int direction_of(double begin, double end, double slack) {
    if (begin > -slack && end <= -slack) return -1;
    return begin <= slack && end > slack;
}

static void test_triangle(void *user, int k) {
    struct path *path = user;
    double corner[3][3], n[3], x[3];
    int surface = path->set->surface[k];
    if (surface < path->first_surface) return;
    double begin = plane_at(path, k, 0.0, corner, n), end = plane_at(path, k, 1.0, corner, n);
    double slack = path->slack * vec3_length(n);
    int direction = direction_of(begin, end, slack);
    if (!direction) return;
    double t = (begin - direction * slack) / (begin - end);
    plane_at(path, k, t, corner, n);
    for (int a = 0; a < 3; a++) x[a] = (1.0 - t) * path->begin[a] + t * path->end[a];
    if (!is_inside(x, corner, n) || is_on_border(path, k, t, x)) return;
    if (!path->direction) path->surface = surface;
    if (surface == path->surface) path->direction += direction;
}

/* ---- all particles --------------------------------------------------------------------------- */

struct search {
    struct pdyn_sim *sim;
    const pdyn_body *body;
    const pdyn_neighbours *lists; /* of the fluid; NULL: a body without lists */
    int first_surface;            /* solids alone can be passed by vertices of bodies */
};

/* A particle that moves less than half of its radius is near a surface if a sample or a boundary
 * point is in its list. */
static bool can_pass(const struct search *s, int i, bool solid) {
    const pdyn_neighbours *l = s->lists;
    const double *x = s->sim->x + 3 * (size_t)i, *x_next = s->sim->x_next + 3 * (size_t)i;
    if (!l || vec3_distance(x, x_next) > 0.5 * s->body->radius) return true;
    return l->boundary_start[i] < l->end[i] ||
           (!solid && l->surface_start[i] < l->boundary_start[i]);
}

static void visit_set(struct path *path, const struct triangle_set *set) {
    struct box box = box_empty;
    box_add(&box, path->begin), box_add(&box, path->end);
    path->set = set;
    bvh_visit(&set->tree, &box, 0, test_triangle, path);
}

static void find_passed(void *arg, int first, int last, int block) {
    const struct search *s = arg;
    struct crossings *c = s->sim->crossings;
    (void)block;
    for (int i = s->body->first + first; i < s->body->first + last; i++) {
        struct path path = {.crossings = c,
                            .begin = s->sim->x + 3 * (size_t)i,
                            .end = s->sim->x_next + 3 * (size_t)i,
                            .radius = s->body->radius,
                            .slack = c->slack[s->body - s->sim->body],
                            .first_surface = s->first_surface};
        c->passed[i] = 0;
        if (!particle_is_live(s->sim, i)) continue;
        if (can_pass(s, i, true)) visit_set(&path, &c->resting);
        if (can_pass(s, i, false)) visit_set(&path, &c->moving);
        if (path.direction)
            c->passed[i] = path.direction > 0 ? path.surface + 1 : -path.surface - 1;
    }
}

/* A particle that comes back through the surface that it is beyond is on its side again. */
static void update_beyond(struct pdyn_sim *sim, int i) {
    struct crossings *c = sim->crossings;
    int *beyond = &c->beyond[i], passed = c->passed[i];
    if (!particle_is_live(sim, i)) *beyond = 0;
    if (!passed || *beyond == passed) return;
    bool back = *beyond == -passed;
    *beyond = back ? 0 : passed;
    c->surface[abs(passed) - 1].beyond += back ? -1 : 1;
}

static void step_body(struct pdyn_sim *sim, int b) {
    const struct crossings *c = sim->crossings;
    const pdyn_body *body = &sim->body[b];
    struct search s = {.sim = sim, .body = body};
    if (body->triangles ? !c->bodies : !c->fluid) return;
    if (has_neighbour_lists(sim, b)) s.lists = neighbours_view(sim->neighbours);
    if (body->triangles) s.first_surface = c->surfaces - c->solids;
    pool_for(sim->context->pool, body->count, GRAIN, find_passed, &s);
    for (int i = body->first; i < body->first + body->count; i++) update_beyond(sim, i);
}

void crossings_forget(struct pdyn_sim *sim, int first, int count) {
    struct crossings *c = sim->crossings;
    for (int i = first; c && i < first + count; i++) {
        if (c->beyond[i]) c->surface[abs(c->beyond[i]) - 1].beyond--;
        c->beyond[i] = 0;
    }
}

void crossings_step(struct pdyn_sim *sim, double h) {
    struct crossings *c = sim->crossings;
    if (!c) return;
    for (int k = 0; k < c->surfaces; k++) {
        const struct surface *s = &c->surface[k];
        for (int end = 0; s->moves && end < 2; end++)
            pose_place(s->moves, s->placed, s->vertices, sim->time + end * h, s->pose[end]);
    }
    build_tree(c, &c->moving);
    for (int b = 0; b < sim->bodies; b++) step_body(sim, b);
}

long crossings_total(const struct pdyn_sim *sim) {
    const struct crossings *c = sim->crossings;
    long total = 0;
    for (int s = 0; c && s < c->surfaces; s++) total += c->surface[s].beyond;
    return total;
}

void crossings_warn(struct pdyn_sim *sim) {
    const struct crossings *c = sim->crossings;
    for (int s = 0; c && s < c->surfaces; s++) {
        const struct surface *at = &c->surface[s];
        if (!at->beyond) continue;
        bool solid = s >= c->surfaces - c->solids;
        struct warning *w = warnings_count(&sim->warnings, WARNING_LEAK, at->name, sim->time, 0,
                                           (double)at->beyond);
        if (w->count == at->beyond) continue;
        w->count = at->beyond;
        warnings_say(sim->context, w, "%ld particle%s passed through this %s", at->beyond,
                     at->beyond == 1 ? "" : "s", solid ? "solid" : "body");
    }
}

void crossings_persist(struct pdyn_sim *sim, struct snapshot_file *a) {
    struct crossings *c = sim->crossings;
    if (!c) return;
    bool valid = true;
    for (int s = 0; s < c->surfaces; s++)
        snapshot_file_long(a, &c->surface[s].beyond, LONG_MAX, "a number of passed particles");
    snapshot_file_bytes(a, c->beyond, (size_t)sim->objective.particles * sizeof *c->beyond);
    for (int i = 0; i < sim->objective.particles; i++)
        valid &= c->beyond[i] >= -c->surfaces && c->beyond[i] <= c->surfaces;
    snapshot_file_require(a, valid, "a passed surface is out of range");
}
