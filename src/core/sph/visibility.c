/* Who sees whom: fluid on one side of a surface feels neither fluid nor walls on the other.
 *
 * It is decided where a step begins, for all local steps of it: the minimised function must not
 * change on the way. From step to step, pairs near the border of a surface come into sight and go
 * out of it, at distances at which water would be compressed by 10 % at once. So a particle is
 * granted what came into sight, and loses what is granted in some ten steps. */
#include "neighbour_lists.h"

#include "kernel.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- memory ---------------------------------------------------------------------------------- */

pdyn_status visibility_create(struct neighbours *n, struct occlusion *sides) {
    struct visibility *v = &n->sight;
    pdyn_context *c = n->context;
    int particles = n->view.particles;
    if (!sides) return PDYN_OK;
    v->sides = sides;
    v->decided_at = NEW_ARRAY(c, 3 * (size_t)n->system, double);
    v->before.start = NEW_ARRAY(c, particles, int);
    v->before.surface_start = NEW_ARRAY(c, particles, int);
    v->granted = NEW_ARRAY(c, particles, double);
    n->view.granted = v->granted;
    return v->decided_at && v->before.start && v->before.surface_start && v->granted
               ? PDYN_OK
               : PDYN_NO_MEMORY;
}

void visibility_free(struct neighbours *n) {
    struct visibility *v = &n->sight;
    pdyn_context *c = n->context;
    int particles = n->view.particles;
    FREE_ARRAY(c, v->decided_at, 3 * (size_t)n->system);
    FREE_ARRAY(c, v->before.start, particles);
    FREE_ARRAY(c, v->before.surface_start, particles);
    FREE_ARRAY(c, v->before.index, v->before.capacity);
    FREE_ARRAY(c, v->granted, particles);
}

void visibility_persist(struct neighbours *n, pdyn_snapshot *snapshot) {
    struct visibility *v = &n->sight;
    if (!v->sides) return;
    snapshot->bytes(snapshot, &v->decided, sizeof v->decided);
    snapshot->bytes(snapshot, v->decided_at, 3 * (size_t)n->system * sizeof *v->decided_at);
    snapshot->bytes(snapshot, v->granted, (size_t)n->view.particles * sizeof *v->granted);
}

/* ---- steps ----------------------------------------------------------------------------------- */

void neighbours_begin(struct neighbours *n, const double *x) { n->sight.state = x; }

void neighbours_decided(struct neighbours *n) { n->sight.state = NULL; }

/* Of what is granted, a step leaves so much. */
static const double kept_grant = 0.9;

void neighbours_settle(struct neighbours *n) {
    double *granted = n->sight.granted;
    for (int k = 0; granted && k < n->centres; k++) granted[n->id[k]] *= kept_grant;
}

void visibility_keep(struct neighbours *n, const double *x) {
    struct visibility *v = &n->sight;
    size_t particles = (size_t)n->view.particles;
    if (!v->sides) return;
    memcpy(v->before.start, n->lists.start, particles * sizeof(int));
    memcpy(v->before.surface_start, n->lists.surface_start, particles * sizeof(int));
    int *index = v->before.index;
    size_t capacity = v->before.capacity;
    v->before.index = n->lists.index, v->before.capacity = n->lists.capacity;
    n->lists.index = index, n->lists.capacity = capacity;
    const double *at = v->state ? v->state : v->decided ? NULL : x;
    if (at) memcpy(v->decided_at, at, 3 * (size_t)n->system * sizeof *at);
    v->known = v->complete, v->complete = false;
}

/* ---- what came into sight -------------------------------------------------------------------- */

/* Where a fluid particle or a boundary point was when it was decided. */
static const double *place_of(const struct neighbours *n, int i) {
    int particles = n->view.particles;
    return i < particles ? n->sight.decided_at + 3 * (size_t)i
                         : n->boundary_x + 3 * (size_t)(i - particles);
}

static bool is_hidden(const struct neighbours *n, int i, int j) {
    return occlusion_blocks(n->sight.sides, i, place_of(n, i), j, place_of(n, j));
}

/* Was fluid particle j in the list of i? */
static bool was_listed(const struct neighbours *n, int i, int j) {
    const struct lists *before = &n->sight.before;
    for (int s = before->start[i]; s < before->surface_start[i]; s++)
        if (before->index[s] == j) return true;
    return false;
}

/* Were the lists before complete for particle i where it is now? Not after an attempt at a step
 * that was taken back. */
static bool was_covered(const struct neighbours *n, int i) {
    return vec3_distance(n->built_x + 3 * (size_t)i, place_of(n, i)) < 0.5 * n->skin;
}

/* What the density of particle i changes by where j, which is in sight now or not, was not before,
 * or was. */
static double change_of(const struct neighbours *n, int i, int j, bool now) {
    double r = vec3_distance(place_of(n, i), place_of(n, j));
    if (r >= n->view.support || !was_covered(n, j) || now == was_listed(n, i, j)) return 0.0;
    struct kernel kernel = kernel_make(n->view.support);
    return (now ? 1.0 : -1.0) * n->centre_volume * kernel_value(&kernel, r);
}

/* ---- hiding ---------------------------------------------------------------------------------- */

/* Samples are what a surface is felt by: nothing hides them. */
static bool can_hide(const struct neighbours *n, int i) {
    return i >= n->view.particles || n->centre[i];
}

static void find_clearances(void *arg, int first, int last, int block) {
    (void)block;
    const struct neighbours *n = arg;
    for (int k = first; k < last; k++) {
        int i = k < n->active ? n->id[k] : n->view.particles + k - n->active;
        if (can_hide(n, i)) occlusion_measure(n->sight.sides, i, place_of(n, i));
    }
}

/* Takes hidden fluid particles out of the list of i; returns where the others end. */
static int hide_fluid(struct neighbours *n, int i) {
    struct visibility *v = &n->sight;
    struct lists *l = &n->lists;
    bool grants = v->state && v->known && occlusion_is_near(v->sides, i) && was_covered(n, i);
    int to = l->start[i];
    for (int s = l->start[i]; s < l->surface_start[i]; s++) {
        int j = l->index[s];
        bool now = !is_hidden(n, i, j);
        if (grants) v->granted[i] += change_of(n, i, j, now);
        if (now) l->index[to++] = j;
    }
    return to;
}

/* Moves a part of the list of i to `to`, without hidden boundary points; returns where it ends. */
static int hide_points(struct neighbours *n, int i, int from, int last, int to) {
    struct lists *l = &n->lists;
    for (int s = from; s < last; s++)
        if (!can_hide(n, l->index[s]) || !is_hidden(n, i, l->index[s]))
            l->index[to++] = l->index[s];
    return to;
}

/* In the lists of centres; closes the gaps. */
static void hide(void *arg, int first, int last, int block) {
    (void)block;
    struct neighbours *n = arg;
    struct lists *l = &n->lists;
    for (int k = first; k < last; k++) {
        int i = n->id[k], surface = l->surface_start[i], boundary = l->boundary_start[i];
        int patches = l->patch_start[i];
        l->surface_start[i] = hide_fluid(n, i);
        l->boundary_start[i] = hide_points(n, i, surface, boundary, l->surface_start[i]);
        l->patch_start[i] = hide_points(n, i, boundary, patches, l->boundary_start[i]);
        l->end[i] = hide_points(n, i, patches, l->end[i], l->patch_start[i]);
    }
}

void visibility_hide(struct neighbours *n) {
    struct visibility *v = &n->sight;
    struct box centres = box_empty;
    int boundary = n->view.points - n->view.particles;
    if (!v->sides) return;
    for (int k = 0; k < n->centres; k++) box_add(&centres, place_of(n, n->id[k]));
    occlusion_update(v->sides, v->decided_at, &centres);
    pool_for(n->context->pool, n->active + boundary, NEIGHBOURS_GRAIN, find_clearances, n);
    pool_for(n->context->pool, n->centres, NEIGHBOURS_GRAIN, hide, n);
    v->decided = v->complete = true;
}
