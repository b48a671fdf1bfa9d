/* Neighbour lists by uniform grids: build, validity, moving boundary points. */
#include "neighbour_lists.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { CHECK_GRAIN = 8192 }; /* particles per block when displacements are checked */
enum { INITIAL_ROOM = 64 * NEIGHBOURS_GRAIN }; /* neighbours per block at first */

struct call {
    struct neighbours *n;
    const double *x;
};

static bool resize_arrays(struct neighbours *n, enum array_action action) {
    size_t particles = (size_t)n->view.particles, points = (size_t)n->view.points;
    size_t boundary = points - particles;
    const struct array_entry table[] = {
        ARRAY(n->centre, particles),
        ARRAY(n->id, particles),
        ARRAY(n->volume, points),
        ARRAY(n->boundary_x, 3 * boundary),
        ARRAY(n->boundary_id, boundary),
        ARRAY(n->built_x, 3 * particles),
        ARRAY(n->built_moving_x, 3 * (size_t)n->moving),
        ARRAY(n->lists.start, particles),
        ARRAY(n->lists.surface_start, particles),
        ARRAY(n->lists.boundary_start, particles),
        ARRAY(n->lists.patch_start, particles),
        ARRAY(n->lists.end, particles),
        ARRAY(n->used, pool_blocks(n->view.particles, NEIGHBOURS_GRAIN)),
        ARRAY(n->displaced, pool_blocks(n->view.particles, CHECK_GRAIN)),
    };
    return context_arrays(n->context, table, ARRAY_ROWS(table), action);
}

/* Positions of the boundary points that may move. */
static double *moving_x(const struct neighbours *n) {
    return n->boundary_x + 3 * (size_t)(n->view.points - n->view.particles - n->moving);
}

static pdyn_status sort_part(struct neighbours *n, int part) {
    int first = n->part[part], count = n->part[part + 1] - first;
    if (!count) return PDYN_OK;
    return grid_sort(&n->boundary[part], count, n->boundary_id + first, n->boundary_x);
}

static pdyn_status sort_moving(struct neighbours *n) {
    if (!n->moving) return PDYN_OK;
    memcpy(n->built_moving_x, moving_x(n), 3 * (size_t)n->moving * sizeof(double));
    n->boundary_shift = 0.0;
    pdyn_status status = sort_part(n, MOVING_WALLS);
    return status == PDYN_OK ? sort_part(n, MOVING_PATCHES) : status;
}

static pdyn_status sort_boundary(struct neighbours *n) {
    pdyn_status status = sort_part(n, WALLS);
    if (status == PDYN_OK) status = sort_part(n, PATCHES);
    return status == PDYN_OK ? sort_moving(n) : status;
}

/* Copies the points and initialises the public view. */
static void fill_points(struct neighbours *n, const struct neighbours_def *def) {
    const struct surface_samples *samples = def->samples;
    size_t particles = (size_t)def->particles, boundary = (size_t)def->boundary;
    memcpy(n->centre, def->centre, particles * sizeof *n->centre);
    memcpy(n->volume, def->volume, (particles + boundary) * sizeof *n->volume);
    if (boundary) memcpy(n->boundary_x, def->boundary_x, 3 * boundary * sizeof *n->boundary_x);
    for (int i = 0; i < def->particles; i++)
        if (n->centre[i]) n->centre_volume = n->volume[i];
    neighbour_points_count(n, def);
    n->room = INITIAL_ROOM, n->view.volume_revision = 1;
    n->view.volume = n->volume, n->view.boundary_x = n->boundary_x;
    n->view.start = n->lists.start, n->view.surface_start = n->lists.surface_start;
    n->view.boundary_start = n->lists.boundary_start, n->view.patch_start = n->lists.patch_start;
    n->view.end = n->lists.end;
    if (!samples) return;
    n->view.samples = samples->count;
    n->view.sample_vertex = samples->vertex, n->view.sample_weight = samples->weight;
    n->view.sample_share = samples->share;
    n->far_volume = samples->rest_volume;
}

static pdyn_status create_grids(struct neighbours *n) {
    pdyn_status status = grid_create(n->context, n->max_centres, n->reach, &n->fluid);
    if (status == PDYN_OK)
        status = grid_create(n->context, n->surface_points, n->surface_reach, &n->surface);
    for (int part = 0; part < BOUNDARY_PARTS && status == PDYN_OK; part++)
        status = grid_create(n->context, n->part[part + 1] - n->part[part],
                             part < PATCHES ? n->reach : n->surface_reach, &n->boundary[part]);
    return status;
}

pdyn_status neighbours_create(pdyn_context *context, const struct neighbours_def *def,
                              struct neighbours **out) {
    struct neighbours *n = *out = NEW_ARRAY(context, 1, struct neighbours);
    if (!n) return PDYN_NO_MEMORY;
    n->context = context;
    n->moving = def->moving;
    n->system = def->particles - (def->samples ? def->samples->count : 0);
    n->skin = def->skin, n->reach = def->support + n->skin;
    n->surface_reach = def->surface_support + n->skin;
    n->view = (pdyn_neighbours){.support = def->support,
                                .surface_support = def->surface_support,
                                .has_volumes = def->has_volumes,
                                .kernel = def->kernel,
                                .particles = def->particles,
                                .moving = def->moving,
                                .layer_x = def->layer_x,
                                .points = def->particles + def->boundary};
    pdyn_status status = resize_arrays(n, ARRAYS_ALLOCATE) ? PDYN_OK : PDYN_NO_MEMORY;
    if (status == PDYN_OK) status = visibility_create(n, def);
    if (status == PDYN_OK) {
        fill_points(n, def);
        status = create_grids(n);
    }
    if (status == PDYN_OK) status = sort_boundary(n);
    if (status == PDYN_OK) return status;
    neighbours_free(n);
    *out = NULL;
    return status;
}

void neighbours_free(struct neighbours *n) {
    if (!n) return;
    pdyn_context *c = n->context;
    grid_free(c, &n->fluid);
    grid_free(c, &n->surface);
    for (int part = 0; part < BOUNDARY_PARTS; part++) grid_free(c, &n->boundary[part]);
    resize_arrays(n, ARRAYS_FREE);
    FREE_ARRAY(c, n->lists.index, n->lists.capacity);
    visibility_free(n);
    FREE_ARRAY(c, n, 1);
}

const pdyn_neighbours *neighbours_view(const struct neighbours *n) { return &n->view; }

/* Inactive particles get an empty list. */
void neighbours_set_live(struct neighbours *n, const bool *live, const int *apart) {
    n->apart = apart;
    for (int i = 0; i < n->view.particles; i++) {
        if (n->centre[i]) n->volume[i] = live[i] ? n->centre_volume : 0.0;
        if (!(n->volume[i] > 0.0)) neighbour_points_clear(n, i);
    }
    n->built = n->visibility.complete = false;
    n->view.volume_revision++;
}

const int *neighbours_near(const struct neighbours *n, int *count) {
    *count = n->active - n->centres;
    return n->id + n->centres;
}

void neighbours_set_sample_volumes(struct neighbours *n, const struct surface_samples *samples) {
    for (int k = n->centres; k < n->active; k++)
        n->volume[n->id[k]] = samples->volume[n->id[k] - n->system];
    n->view.volume_revision++;
}

/* ---- validity -------------------------------------------------------------------------------- */

void neighbours_move_boundary(struct neighbours *n, const double *x) {
    double *moving = moving_x(n);
    n->boundary_shift = 0.0;
    memcpy(moving, x, 3 * (size_t)n->moving * sizeof *x);
    for (size_t k = 0; k < 3 * (size_t)n->moving; k += 3)
        n->boundary_shift =
            fmax(n->boundary_shift, vec3_distance(moving + k, n->built_moving_x + k));
    n->view.boundary_revision++;
}

/* How far a particle may have moved, m, such that two particles, or a particle and a moving
 * boundary point, have not approached by more than the skin. */
static double slack(const struct neighbours *n) {
    return fmax(0.0, fmin(0.5 * n->skin, n->skin - n->boundary_shift));
}

static bool has_moved(const struct call *c, int i, double limit) {
    const double *a = c->x + 3 * (size_t)i, *b = c->n->built_x + 3 * (size_t)i;
    double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return !(vec3_dot(d, d) < limit * limit); /* true for NaN, too */
}

static void find_moved(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    double limit = slack(c->n);
    bool moved = false;
    for (int k = first; k < last; k++) moved |= has_moved(c, c->n->id[k], limit);
    c->n->displaced[block] = moved;
}

/* A sample moves no farther than the corners of its triangle. One that is not near may come closer
 * by one more skin. */
static void find_far_moved(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    double limit = slack(c->n) + c->n->skin;
    bool moved = false;
    for (int i = first; i < last; i++) moved |= !c->n->centre[i] && has_moved(c, i, limit);
    c->n->displaced[block] = moved;
}

static bool none_moved(struct neighbours *n, int count, pdyn_range_fn *find, const double *x) {
    bool moved = false;
    pool_for(n->context->pool, count, CHECK_GRAIN, find, &(struct call){n, x});
    for (int b = 0; b < pool_blocks(count, CHECK_GRAIN); b++) moved |= n->displaced[b];
    return !moved;
}

bool neighbours_are_valid(struct neighbours *n, const double *x) {
    if (!n->built || !none_moved(n, n->active, find_moved, x)) return false;
    bool all_near = n->active - n->centres == n->surface_points;
    return all_near || none_moved(n, n->system, find_far_moved, x);
}

/* ---- build ----------------------------------------------------------------------------------- */

struct source { /* the points of a grid */
    const struct grid *grid;
    int first; /* is added to their ids */
    /* around the last particle; the particles of a cell come one after the other, so that its
     * neighbourhood is computed once */
    struct grid_cells cells;
};

struct search { /* of the neighbours of a block of slots */
    struct source fluid, surface, boundary[BOUNDARY_PARTS];
    int *list, room; /* the block's part of `index` */
    int used;        /* number of entries */
};

static struct search begin_search(const struct neighbours *n, int *list) {
    struct search w = {.list = list, .room = n->room};
    w.fluid.grid = &n->fluid, w.surface.grid = &n->surface;
    for (int part = 0; part < BOUNDARY_PARTS; part++)
        w.boundary[part].grid = &n->boundary[part], w.boundary[part].first = n->view.particles;
    return w;
}

/* Appends the points of a source closer than `reach`, m, to `at`, except i. Entries beyond the room
 * of the block are counted, not written. */
static void append(struct search *w, struct source *from, const double *at, double reach, int i) {
    int written = w->used < w->room ? w->used : w->room, room = w->room - written;
    int *list = w->list + written;
    if (!from->grid->points) return;
    grid_update_cells(from->grid, at, &from->cells);
    int found = grid_query(from->grid, &from->cells, at, reach, i, list, room);
    for (int k = 0; from->first && k < found && k < room; k++) list[k] += from->first;
    w->used += found;
}

/* The particle of a slot: slots are particles in the order of their cells, centres first. */
static int point_in_slot(const struct neighbours *n, int slot) {
    return slot < n->centres ? n->fluid.id[slot] : n->surface.id[slot - n->centres];
}

/* Builds the lists of a block of slots, contiguous in the block's part of `index`. */
static void fill_lists(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct neighbours *n = c->n;
    int begin = block * (n->room + 1);
    struct search w = begin_search(n, n->lists.index + begin);
    for (int k = first; k < last; k++) {
        int i = point_in_slot(n, k);
        const double *at = c->x + 3 * (size_t)i;
        bool centre = n->centre[i], near_surfaces = centre && !(n->apart && n->apart[i]);
        n->lists.start[i] = begin + w.used;
        append(&w, &w.fluid, at, centre ? n->reach : n->surface_reach, i);
        n->lists.surface_start[i] = begin + w.used;
        if (near_surfaces) append(&w, &w.surface, at, n->surface_reach, -1);
        n->lists.boundary_start[i] = begin + w.used;
        for (int part = WALLS; near_surfaces && part < PATCHES; part++)
            append(&w, &w.boundary[part], at, n->reach, -1);
        n->lists.patch_start[i] = begin + w.used;
        for (int part = PATCHES; near_surfaces && part < BOUNDARY_PARTS; part++)
            append(&w, &w.boundary[part], at, n->surface_reach, -1);
        n->lists.end[i] = begin + w.used;
    }
    n->used[block] = w.used;
}

/* Allocates `index` with `room` entries per block, for more samples than are near. PDYN_DIVERGED:
 * more than 2^31 neighbours. */
static pdyn_status reserve(struct neighbours *n) {
    int near = n->active - n->centres;
    if (near > n->surface_room)
        n->surface_room = near < n->surface_points - near / 4 ? near + near / 4 : n->surface_points;
    int points = n->max_centres + n->surface_room;
    size_t capacity = (size_t)pool_blocks(points, NEIGHBOURS_GRAIN) * ((size_t)n->room + 1);
    if (capacity <= n->lists.capacity) return PDYN_OK;
    if (capacity > INT32_MAX)
        return set_error(PDYN_DIVERGED,
                         "more than 2^31 neighbours, room for %d of each of %d particles: "
                         "larger particles, inlets with a smaller \"budget\", or the fluid has "
                         "collapsed",
                         n->room / NEIGHBOURS_GRAIN, points);
    FREE_ARRAY(n->context, n->lists.index, n->lists.capacity);
    n->lists.capacity = capacity;
    n->lists.index = NEW_ARRAY(n->context, capacity, int);
    if (n->lists.index) return PDYN_OK;
    n->lists.capacity = 0;
    return PDYN_NO_MEMORY;
}

/* Builds all lists. If a block has too little room, allocates 25 % more than needed and builds them
 * again; so a step in a warmed-up simulation allocates nothing. */
static pdyn_status fill(struct neighbours *n, const double *x) {
    struct call call = {n, x};
    pdyn_status status = reserve(n);
    while (status == PDYN_OK) {
        int max_used = 0;
        pool_for(n->context->pool, n->active, NEIGHBOURS_GRAIN, fill_lists, &call);
        for (int b = 0; b < pool_blocks(n->active, NEIGHBOURS_GRAIN); b++)
            if (n->used[b] > max_used) max_used = n->used[b];
        if (max_used <= n->room) break;
        n->room = max_used + max_used / 4;
        status = reserve(n);
    }
    return status;
}

pdyn_status neighbours_build(struct neighbours *n, const double *x) {
    n->built = false;
    pdyn_status status = n->boundary_shift > 0.0 ? sort_moving(n) : PDYN_OK;
    neighbour_points_list(n, x);
    if (status == PDYN_OK) status = grid_sort(&n->fluid, n->centres, n->id, x);
    if (status == PDYN_OK)
        status = grid_sort(&n->surface, n->active - n->centres, n->id + n->centres, x);
    if (status != PDYN_OK) return status;
    visibility_store_lists(n, x);
    status = fill(n, x);
    if (status != PDYN_OK) return status;
    visibility_filter_lists(n);
    memmove(n->built_x, x, 3 * (size_t)n->view.particles * sizeof *x);
    n->built = true;
    n->view.index = n->lists.index;
    n->view.revision++;
    return PDYN_OK;
}

void neighbours_persist(struct neighbours *n, struct snapshot_file *file) {
    static const char what[] = "a position of its neighbour lists is not finite";
    snapshot_file_flags(file, &n->built, 1, "the flag of its neighbour lists is neither 0 nor 1");
    snapshot_file_numbers(file, n->built_x, 3 * (size_t)n->view.particles, what);
    snapshot_file_numbers(file, n->built_moving_x, 3 * (size_t)n->moving, what);
    visibility_persist(n, file);
    if (!file->view.reading || file->status != PDYN_OK) return;
    if (n->moving) memcpy(moving_x(n), n->built_moving_x, 3 * (size_t)n->moving * sizeof(double));
    file->status = sort_moving(n);
    if (file->status == PDYN_OK && n->built) file->status = neighbours_build(n, n->built_x);
}

const double *neighbours_built_at(const struct neighbours *n) { return n->built_x; }

/* Since the last build no centre has moved by more than half the skin. */
void neighbours_visit(const struct neighbours *n, const double *at, double radius,
                      grid_visit_fn *visit, void *user) {
    grid_visit(&n->fluid, at, radius + 0.5 * n->skin, visit, user);
}
