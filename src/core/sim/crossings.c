#include "crossings.h"

#include "crossing_path.h"
#include "live_particles.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { GRAIN = 512 }; /* particles per parallel block */
enum { BEYOND = 4 };  /* surfaces that a particle can be beyond; further ones are not counted */

struct crossings {
    struct swept_surfaces swept;
    bool fluid;    /* particles are tested */
    bool bodies;   /* vertices of bodies are tested */
    double *slack; /* bodies, m: how far a vertex of a body leaves a surface that it passes */
    long *count;   /* surfaces: number of particles beyond each */
    long total;    /* number of particles beyond any */
    /* 0, or s + 1 for surface s, negative against its normal */
    int *passed; /* particles: the surface that the particle passed in this step */
    int *beyond; /* particles x BEYOND: surfaces that the particle is beyond, then 0 */
};

/* ---- creation -------------------------------------------------------------------------------- */

static bool resize_arrays(struct pdyn_sim *sim, enum array_action action) {
    struct crossings *c = sim->crossings;
    const struct array_entry table[] = {
        ARRAY(c->passed, sim->objective.particles),
        ARRAY(c->beyond, BEYOND * (size_t)sim->objective.particles),
        ARRAY(c->slack, sim->bodies),
        ARRAY(c->count, sim->bodies + sim->scene.solids),
    };
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
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
        if (body_is_particles(&sim->body[b])) fluid = true;
        else surfaces = true;
    bool bodies = solids && surfaces && !sim->scene.has_contact;
    if (!bodies && !(fluid && (solids || surfaces))) return PDYN_OK;
    struct crossings *c = sim->crossings = NEW_ARRAY(sim->context, 1, struct crossings);
    if (!c) return PDYN_NO_MEMORY;
    c->fluid = fluid, c->bodies = bodies;
    if (!resize_arrays(sim, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int b = 0; b < sim->bodies; b++) c->slack[b] = slack_of(&sim->body[b]);
    return swept_surfaces_create(sim, fluid, &c->swept);
}

void crossings_free(struct pdyn_sim *sim) {
    struct crossings *c = sim->crossings;
    if (!c) return;
    swept_surfaces_free(sim->context, &c->swept);
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(sim->context, sim->crossings, 1);
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

static void find_passed(void *arg, int first, int last, int block) {
    const struct search *s = arg;
    struct crossings *c = s->sim->crossings;
    (void)block;
    for (int i = s->body->first + first; i < s->body->first + last; i++) {
        struct crossing_path path = {.swept = &c->swept,
                                     .begin = s->sim->x + 3 * (size_t)i,
                                     .end = s->sim->x_next + 3 * (size_t)i,
                                     .radius = s->body->radius,
                                     .slack = c->slack[s->body - s->sim->body],
                                     .first_surface = s->first_surface};
        c->passed[i] = 0;
        if (!particle_is_live(s->sim, i) || particle_is_pushed(s->sim, i)) continue;
        if (can_pass(s, i, true)) crossing_path_test(&path, &c->swept.resting);
        if (can_pass(s, i, false)) crossing_path_test(&path, &c->swept.moving);
        if (path.direction)
            c->passed[i] = path.direction > 0 ? path.surface + 1 : -path.surface - 1;
    }
}

/* The place of `surface`, or of 0, in a particle's list; BEYOND: none. */
static int find_beyond(const int *beyond, int surface) {
    int k = 0;
    while (k < BEYOND && beyond[k] != surface) k++;
    return k;
}

/* A particle that comes back through a surface that it is beyond is on its side again. */
static void update_beyond(struct crossings *c, int i) {
    int *beyond = c->beyond + BEYOND * (size_t)i, passed = c->passed[i];
    if (!passed || find_beyond(beyond, passed) < BEYOND) return;
    int back = find_beyond(beyond, -passed), end = find_beyond(beyond, 0);
    if (back == BEYOND && end == BEYOND) return;
    long before = end > 0;
    if (back < BEYOND) beyond[back] = beyond[end - 1], beyond[end - 1] = 0;
    else beyond[end] = passed;
    c->count[abs(passed) - 1] += back < BEYOND ? -1 : 1;
    c->total += (beyond[0] != 0) - before;
}

static void step_body(struct pdyn_sim *sim, int b) {
    struct crossings *c = sim->crossings;
    const pdyn_body *body = &sim->body[b];
    struct search s = {.sim = sim, .body = body};
    bool particles = body_is_particles(body);
    if (particles ? !c->fluid : !c->bodies) return;
    if (has_neighbour_lists(sim, b)) s.lists = neighbours_view(sim->objective.neighbours);
    if (!particles) s.first_surface = c->swept.count - c->swept.solids;
    pool_for(sim->context->pool, body->count, GRAIN, find_passed, &s);
    for (int i = body->first; i < body->first + body->count; i++) update_beyond(c, i);
}

void crossings_forget(struct pdyn_sim *sim, int first, int count) {
    struct crossings *c = sim->crossings;
    for (int i = first; c && i < first + count; i++) {
        int *beyond = c->beyond + BEYOND * (size_t)i;
        c->total -= beyond[0] != 0;
        for (int k = 0; k < BEYOND && beyond[k]; k++) c->count[abs(beyond[k]) - 1]--, beyond[k] = 0;
    }
}

void crossings_leave(struct pdyn_sim *sim, int particle) {
    if (sim->crossings)
        memset(sim->crossings->beyond + BEYOND * (size_t)particle, 0, BEYOND * sizeof(int));
}

void crossings_step(struct pdyn_sim *sim, double h) {
    struct crossings *c = sim->crossings;
    if (!c) return;
    swept_surfaces_step(sim, &c->swept, h);
    for (int b = 0; b < sim->bodies; b++) step_body(sim, b);
}

long crossings_total(const struct pdyn_sim *sim) {
    return sim->crossings ? sim->crossings->total : 0;
}

/* The body with most particles beyond a surface; *count: how many. */
static const pdyn_body *passer_of(const struct pdyn_sim *sim, int surface, long *count) {
    const pdyn_body *found = sim->body;
    *count = 0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        long beyond = 0;
        for (int i = body->first; i < body->first + body->count; i++)
            for (int k = 0; k < BEYOND; k++)
                beyond += abs(sim->crossings->beyond[BEYOND * (size_t)i + k]) == surface + 1;
        if (beyond > *count) *count = beyond, found = body;
    }
    return found;
}

void crossings_warn(struct pdyn_sim *sim) {
    const struct crossings *c = sim->crossings;
    for (int s = 0; c && s < c->swept.count; s++) {
        long count = c->count[s];
        if (!count) continue;
        struct warning *w =
            sim_warning(sim, WARNING_LEAK, c->swept.surface[s].name, 0, (double)count);
        if (w->count >= count) continue;
        w->count = count;
        long most;
        const pdyn_body *body = passer_of(sim, s, &most);
        const char *what = body_is_particles(body) ? (count == 1 ? "particle" : "particles")
                                                   : (count == 1 ? "vertex" : "vertices");
        warnings_say(sim->context, w, "%ld %s%s of \"%s\" passed through this %s by %.3g s", count,
                     what, most < count ? ", most" : "", body->name,
                     c->swept.surface[s].is_solid ? "solid" : "body", sim->time);
    }
}

void crossings_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    struct crossings *c = sim->crossings;
    if (!c) return;
    bool valid = true;
    size_t entries = BEYOND * (size_t)sim->objective.particles;
    snapshot_file_long(file, &c->total, LONG_MAX, "a number of passed particles");
    for (int s = 0; s < c->swept.count; s++)
        snapshot_file_long(file, &c->count[s], LONG_MAX, "a number of passed particles");
    snapshot_file_bytes(file, c->beyond, entries * sizeof *c->beyond);
    for (size_t k = 0; k < entries; k++) {
        valid &= c->beyond[k] >= -c->swept.count && c->beyond[k] <= c->swept.count;
        valid &= !c->beyond[k] || k % BEYOND == 0 || c->beyond[k - 1];
    }
    snapshot_file_require(file, valid, "a passed surface is out of range");
}
