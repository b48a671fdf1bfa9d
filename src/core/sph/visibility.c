/* Visibility of pairs: fluid on one side of a surface interacts neither with fluid nor with walls
 * on the other side. */
#include "neighbour_lists.h"

#include "projdyn/kernel.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* Visibility is decided at the start of a step and is the same in all its local steps, because the
 * minimised function must not change within a step. Between steps, pairs near the border of a
 * surface become visible or hidden at distances at which they change the density by 10 % at once. A
 * particle is therefore granted the change: its density may exceed the rest density by that much,
 * and the grant decays over about ten steps. */

/* ---- memory ---------------------------------------------------------------------------------- */

static bool resize_arrays(struct neighbours *n, enum array_action action) {
    struct visibility *v = &n->visibility;
    const struct array_entry table[] = {
        ARRAY(v->frozen_x, 3 * (size_t)(n->system + v->wall_vertices)),
        ARRAY(v->previous.start, n->view.particles),
        ARRAY(v->previous.surface_start, n->view.particles),
        ARRAY(v->granted, n->view.particles),
        ARRAY(v->doubtful, n->view.points - n->view.particles),
    };
    return context_arrays(n->context, table, ARRAY_ROWS(table), action);
}

pdyn_status visibility_create(struct neighbours *n, const struct neighbours_def *def) {
    struct visibility *v = &n->visibility;
    if (!def->occlusion && !def->walls) return PDYN_OK;
    v->occlusion = def->occlusion, v->face_x = def->face_x, v->samples = def->samples;
    v->walls = def->walls, v->wall_x = def->wall_x, v->wall_vertices = def->wall_vertices;
    bool complete = resize_arrays(n, ARRAYS_ALLOCATE);
    n->view.granted = v->granted;
    return complete ? PDYN_OK : PDYN_NO_MEMORY;
}

void visibility_free(struct neighbours *n) {
    struct lists *previous = &n->visibility.previous;
    resize_arrays(n, ARRAYS_FREE);
    FREE_ARRAY(n->context, previous->index, previous->capacity);
}

void visibility_persist(struct neighbours *n, struct snapshot_file *file) {
    struct visibility *v = &n->visibility;
    if (!v->frozen_x) return;
    snapshot_file_flags(file, &v->frozen, 1, "the flag of its visibility is neither 0 nor 1");
    snapshot_file_numbers(file, v->frozen_x, 3 * (size_t)(n->system + v->wall_vertices),
                          "a position of its visibility is not finite");
    snapshot_file_numbers(file, v->granted, (size_t)n->view.particles,
                          "a granted density is not finite");
}

/* ---- steps ----------------------------------------------------------------------------------- */

void neighbours_begin_step(struct neighbours *n, const double *x) { n->visibility.step_x = x; }

void neighbours_freeze_visibility(struct neighbours *n) { n->visibility.step_x = NULL; }

/* factor of the grants per step */
static const double grant_decay = 0.9;

void neighbours_end_step(struct neighbours *n) {
    double *granted = n->visibility.granted;
    for (int k = 0; granted && k < n->centres; k++) granted[n->id[k]] *= grant_decay;
}

void visibility_store_lists(struct neighbours *n, const double *x) {
    struct visibility *v = &n->visibility;
    size_t particles = (size_t)n->view.particles, system = 3 * (size_t)n->system;
    if (!v->frozen_x) return;
    memcpy(v->previous.start, n->lists.start, particles * sizeof(int));
    memcpy(v->previous.surface_start, n->lists.surface_start, particles * sizeof(int));
    int *index = v->previous.index;
    size_t capacity = v->previous.capacity;
    v->previous.index = n->lists.index, v->previous.capacity = n->lists.capacity;
    n->lists.index = index, n->lists.capacity = capacity;
    const double *at = v->step_x ? v->step_x : v->frozen ? NULL : x;
    if (at) memcpy(v->frozen_x, at, system * sizeof *at);
    if (at && v->walls)
        memcpy(v->frozen_x + system, v->wall_x, 3 * (size_t)v->wall_vertices * sizeof *at);
    v->previous_complete = v->complete, v->complete = false;
}

/* ---- grants ---------------------------------------------------------------------------------- */

/* Position of a fluid particle or a boundary point at which visibility is decided, m. */
static const double *frozen_position(const struct neighbours *n, int i) {
    int particles = n->view.particles;
    return i < particles ? n->visibility.frozen_x + 3 * (size_t)i
                         : n->boundary_x + 3 * (size_t)(i - particles);
}

/* A point this close to a triangle of a solid, a volume or a rigid body, in particle spacings, lies
 * on it, and the triangle does not hide it. No wall hides the samples of a sheet that is held
 * there.
 */
static const double touch = 0.01;

static double touch_distance(const struct neighbours *n) { return touch * cbrt(n->centre_volume); }

static bool is_hidden(const struct neighbours *n, int i, int j) {
    return occlusion_blocks(n->visibility.occlusion, i, frozen_position(n, i), j,
                            frozen_position(n, j));
}

/* Computes where the segment from a to a point of a vessel, which lies behind its face, meets the
 * face. face: the foot of the point. False: a is behind the face, too, or the point is on it. */
static bool find_on_face(const double *a, const double *point, const double *face, double *at) {
    double normal[3], to_point[3];
    vec3_subtract(normal, face, point);
    vec3_subtract(to_point, point, a);
    double behind = vec3_dot(normal, normal), before = -behind - vec3_dot(normal, to_point);
    if (!(behind > 0.0 && before > 0.0)) return false;
    memcpy(at, a, 3 * sizeof *at);
    vec3_add(at, before / (before + behind), to_point);
    return true;
}

/* Whether a surface hides boundary point j from particle i. Behind the face of a vessel are things
 * outside of it, as a crate beside a tank: they hide nothing from the fluid inside, even if they
 * touch the face. A sheet on the face hides it. */
static bool is_point_hidden(const struct neighbours *n, int i, int j) {
    const struct visibility *v = &n->visibility;
    const double *a = frozen_position(n, i), *point = frozen_position(n, j),
                 *face = v->face_x + 3 * (size_t)(j - n->view.particles);
    double at[3];
    if (!is_hidden(n, i, j)) return false;
    return occlusion_separates(v->occlusion, a, find_on_face(a, point, face, at) ? at : point,
                               touch_distance(n));
}

/* Whether fluid particle j was in the previous list of i. */
static bool was_listed(const struct neighbours *n, int i, int j) {
    const struct lists *previous = &n->visibility.previous;
    for (int s = previous->start[i]; s < previous->surface_start[i]; s++)
        if (previous->index[s] == j) return true;
    return false;
}

/* Whether the previous list of particle i was complete at its current position. It is not after an
 * attempt at a step that was rejected. */
static bool was_covered(const struct neighbours *n, int i) {
    return vec3_distance(n->built_x + 3 * (size_t)i, frozen_position(n, i)) < 0.5 * n->skin;
}

/* Change of the density ratio of particle i due to particle j: positive if the pair became visible,
 * negative if it became hidden, 0 if nothing changed. */
static double density_change(const struct neighbours *n, int i, int j, bool visible) {
    double r = vec3_distance(frozen_position(n, i), frozen_position(n, j));
    if (r >= n->view.support || !was_covered(n, j) || visible == was_listed(n, i, j)) return 0.0;
    struct kernel kernel = kernel_make(n->view.kernel, n->view.support);
    return (visible ? 1.0 : -1.0) * n->centre_volume * kernel_value(&kernel, r);
}

/* ---- removal of hidden pairs ----------------------------------------------------------------- */

static void find_clearances(void *arg, int first, int last, int block) {
    (void)block;
    const struct neighbours *n = arg;
    for (int k = first; k < last; k++) {
        int i = n->id[k];
        occlusion_compute_clearance(n->visibility.occlusion, i, frozen_position(n, i), n->reach);
    }
}

/* Marks the boundary points that a surface may hide from a centre: few of those of a large room. */
static void mark_doubtful(void *arg, int first, int last, int block) {
    (void)block;
    struct neighbours *n = arg;
    for (int k = first; k < last; k++) {
        int i = n->id[k];
        for (int s = n->lists.boundary_start[i]; s < n->lists.end[i]; s++) {
            int j = n->lists.index[s];
            double r = vec3_distance(frozen_position(n, i), frozen_position(n, j));
            if (!occlusion_is_clear(n->visibility.occlusion, i, r))
                atomic_store_explicit(&n->visibility.doubtful[j - n->view.particles], true,
                                      memory_order_relaxed);
        }
    }
}

static void find_doubtful_clearances(void *arg, int first, int last, int block) {
    (void)block;
    const struct neighbours *n = arg;
    for (int b = first; b < last; b++) {
        int j = n->view.particles + b;
        if (!n->visibility.doubtful[b]) continue;
        occlusion_compute_clearance(n->visibility.occlusion, j, frozen_position(n, j),
                                    0.5 * n->reach);
        n->visibility.doubtful[b] = false;
    }
}

/* Removes hidden fluid particles from the list of i; returns the end of the remaining ones. */
static int hide_fluid(struct neighbours *n, int i) {
    struct visibility *v = &n->visibility;
    struct lists *l = &n->lists;
    bool grants = v->step_x && v->previous_complete && occlusion_is_near(v->occlusion, i) &&
                  was_covered(n, i);
    int to = l->start[i];
    for (int s = l->start[i]; s < l->surface_start[i]; s++) {
        int j = l->index[s];
        bool visible = !is_hidden(n, i, j);
        if (grants) v->granted[i] += density_change(n, i, j, visible);
        if (visible) l->index[to++] = j;
    }
    return to;
}

/* Moves the samples in a list to `to`; returns their end. No surface hides them: through them it
 * acts on the fluid. */
static int move_samples(struct lists *l, int from, int last, int to) {
    memmove(l->index + to, l->index + from, (size_t)(last - from) * sizeof *l->index);
    return to + last - from;
}

/* Moves boundary points in the list of i to `to`, without hidden ones; returns their end. */
static int hide_points(struct neighbours *n, int i, int from, int last, int to) {
    struct lists *l = &n->lists;
    for (int s = from; s < last; s++)
        if (!is_point_hidden(n, i, l->index[s])) l->index[to++] = l->index[s];
    return to;
}

/* Removes hidden points from the lists of centres and closes the gaps; where no surface is within
 * reach, nothing is hidden. */
static void hide(void *arg, int first, int last, int block) {
    (void)block;
    struct neighbours *n = arg;
    struct lists *l = &n->lists;
    for (int k = first; k < last; k++) {
        int i = n->id[k], surface = l->surface_start[i], boundary = l->boundary_start[i];
        int patches = l->patch_start[i];
        if (occlusion_is_clear(n->visibility.occlusion, i, n->reach)) continue;
        l->surface_start[i] = hide_fluid(n, i);
        l->boundary_start[i] = move_samples(l, surface, boundary, l->surface_start[i]);
        l->patch_start[i] = hide_points(n, i, boundary, patches, l->boundary_start[i]);
        l->end[i] = hide_points(n, i, patches, l->end[i], l->patch_start[i]);
    }
}

/* ---- walls ----------------------------------------------------------------------------------- */

/* Position of sample j when visibility is decided, m. */
static void frozen_sample(const struct neighbours *n, int j, double at[3]) {
    samples_at(n->visibility.samples, j - n->system, n->visibility.frozen_x, at);
}

/* A body with an inside that touches a wall is on the side of the wall on which this point is: as
 * far behind the triangle of sample j and from the sides of the triangle, m. */
static void find_inside(const struct neighbours *n, int j, double depth, double at[3]) {
    const struct surface_samples *s = n->visibility.samples;
    int sample = j - n->system;
    double normal[3], weight[3], sum = 0.0;
    const double *x[3];
    samples_normal(s, sample, n->visibility.frozen_x, normal);
    double twice_area = vec3_normalise(normal);
    for (int k = 0; k < 3; k++)
        x[k] = n->visibility.frozen_x + 3 * (size_t)s->vertex[3 * sample + k];
    for (int k = 0; k < 3; k++) {
        double side = vec3_distance(x[(k + 1) % 3], x[(k + 2) % 3]);
        weight[k] = fmax(s->weight[3 * sample + k], fmin(depth * side / twice_area, 1.0 / 3.0));
        sum += weight[k];
    }
    for (int a = 0; a < 3; a++) at[a] = -depth * normal[a];
    for (int k = 0; k < 3; k++) vec3_add(at, weight[k] / sum, x[k]);
}

static void find_sample_clearances(void *arg, int first, int last, int block) {
    (void)block;
    const struct neighbours *n = arg;
    double at[3];
    for (int k = n->centres + first; k < n->centres + last; k++) {
        frozen_sample(n, n->id[k], at);
        occlusion_compute_clearance(n->visibility.walls, n->id[k] - n->system, at,
                                    n->surface_reach);
    }
}

/* Whether a wall lies between fluid particle i and sample j. */
static bool is_behind_wall(const struct neighbours *n, int i, int j) {
    const struct occlusion *walls = n->visibility.walls;
    int sample = j - n->system;
    double at[3];
    if (occlusion_is_clear(walls, sample, n->surface_reach)) return false;
    if (n->visibility.samples->has_inside[sample]) find_inside(n, j, 2.0 * touch_distance(n), at);
    else frozen_sample(n, j, at);
    return occlusion_separates(walls, frozen_position(n, i), at, touch_distance(n));
}

/* Removes samples behind walls from the lists of centres, and centres from those of samples. */
static void hide_behind_walls(void *arg, int first, int last, int block) {
    (void)block;
    struct neighbours *n = arg;
    struct lists *l = &n->lists;
    for (int k = first; k < last; k++) {
        bool centre = k < n->centres;
        int i = n->id[k], end = l->boundary_start[i];
        int to = centre ? l->surface_start[i] : l->start[i];
        for (int s = to; s < end; s++) {
            int j = l->index[s];
            if (!is_behind_wall(n, centre ? i : j, centre ? j : i)) l->index[to++] = j;
        }
        if (to == end) continue;
        memmove(l->index + to, l->index + end, (size_t)(l->end[i] - end) * sizeof *l->index);
        if (!centre) l->surface_start[i] = to;
        l->boundary_start[i] = to, l->patch_start[i] -= end - to, l->end[i] -= end - to;
    }
}

/* ---- all pairs ------------------------------------------------------------------------------- */

static void filter_by_surfaces(struct neighbours *n) {
    struct visibility *v = &n->visibility;
    struct box centres = box_empty;
    int boundary = n->view.points - n->view.particles;
    for (int k = 0; k < n->centres; k++) box_add(&centres, frozen_position(n, n->id[k]));
    occlusion_update(v->occlusion, v->frozen_x, &centres);
    pool_for(n->context->pool, n->centres, NEIGHBOURS_GRAIN, find_clearances, n);
    pool_for(n->context->pool, n->centres, NEIGHBOURS_GRAIN, mark_doubtful, n);
    pool_for(n->context->pool, boundary, BOUNDARY_GRAIN, find_doubtful_clearances, n);
    pool_for(n->context->pool, n->centres, NEIGHBOURS_GRAIN, hide, n);
}

static void filter_by_walls(struct neighbours *n) {
    struct visibility *v = &n->visibility;
    struct box samples = box_empty;
    double at[3];
    for (int k = n->centres; k < n->active; k++) {
        frozen_sample(n, n->id[k], at);
        box_add(&samples, at);
    }
    occlusion_update(v->walls, v->frozen_x, &samples);
    pool_for(n->context->pool, n->active - n->centres, NEIGHBOURS_GRAIN, find_sample_clearances, n);
    pool_for(n->context->pool, n->active, NEIGHBOURS_GRAIN, hide_behind_walls, n);
}

void visibility_filter_lists(struct neighbours *n) {
    struct visibility *v = &n->visibility;
    if (!v->frozen_x) return;
    if (v->occlusion) filter_by_surfaces(n);
    if (v->walls) filter_by_walls(n);
    v->frozen = v->complete = true;
}
