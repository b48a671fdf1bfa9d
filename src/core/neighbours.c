#include "neighbours.h"

#include "grid.h"
#include "kernel.h"

#include <string.h>

enum { PARTICLES = 128, MOVES = 8192 };

struct neighbours {
    pdyn_context *context;
    pdyn_neighbours view;
    double reach;                          /* m: support and skin */
    double skin;                           /* m */
    bool *centre;                          /* particles */
    int active;                            /* particles that take part, */
    int *id;                               /* active: these */
    double *volume, *boundary_x, *built_x; /* built_x: particles x 3, where the lists were built */
    struct grid moving, fixed;
    int *start, *boundary_start, *index, *mirror;
    size_t capacity; /* of index and mirror */
    bool *moved;     /* a flag for each parallel block of `active` */
    bool built;
};

struct call {
    struct neighbours *n;
    const double *x;
};

static pdyn_status allocate(struct neighbours *n, int particles, int boundary) {
    pdyn_context *c = n->context;
    n->centre = NEW_ARRAY(c, particles, bool);
    n->id = NEW_ARRAY(c, particles, int);
    n->volume = NEW_ARRAY(c, particles + boundary, double);
    n->boundary_x = NEW_ARRAY(c, 3 * (size_t)boundary, double);
    n->built_x = NEW_ARRAY(c, 3 * (size_t)particles, double);
    n->start = NEW_ARRAY(c, particles + 1, int);
    n->boundary_start = NEW_ARRAY(c, particles, int);
    n->moved = NEW_ARRAY(c, pool_blocks(particles, MOVES), bool);
    bool good = n->centre && n->id && n->volume && (!boundary || n->boundary_x) && n->built_x &&
                n->start && n->boundary_start && n->moved;
    if (!good) return PDYN_NO_MEMORY;
    return grid_create(c, particles, n->reach, &n->moving);
}

pdyn_status neighbours_create(pdyn_context *context, int particles, const bool *centre,
                              int boundary, const double *boundary_x, const double *volume,
                              double support, double skin, struct neighbours **out) {
    struct neighbours *n = *out = NEW_ARRAY(context, 1, struct neighbours);
    if (!n) return PDYN_NO_MEMORY;
    n->context = context;
    n->skin = skin * support, n->reach = support + n->skin;
    n->view = (pdyn_neighbours){
        .support = support, .particles = particles, .points = particles + boundary};
    pdyn_status status = allocate(n, particles, boundary);
    if (status == PDYN_OK) {
        memcpy(n->centre, centre, (size_t)particles * sizeof *centre);
        memcpy(n->volume, volume, (size_t)(particles + boundary) * sizeof *volume);
        if (boundary) memcpy(n->boundary_x, boundary_x, 3 * (size_t)boundary * sizeof *boundary_x);
        for (int i = 0; i < particles; i++)
            if (volume[i] > 0.0) n->id[n->active++] = i;
        n->view.volume = n->volume, n->view.boundary_x = n->boundary_x;
        n->view.start = n->start, n->view.boundary_start = n->boundary_start;
        status = grid_create(context, boundary, n->reach, &n->fixed);
    }
    if (status == PDYN_OK) status = grid_sort(context, &n->fixed, boundary, NULL, boundary_x);
    if (status == PDYN_OK) return status;
    neighbours_free(n);
    *out = NULL;
    return status;
}

void neighbours_free(struct neighbours *n) {
    if (!n) return;
    pdyn_context *c = n->context;
    int particles = n->view.particles, boundary = n->view.points - particles;
    grid_free(c, &n->moving);
    grid_free(c, &n->fixed);
    FREE_ARRAY(c, n->centre, particles);
    FREE_ARRAY(c, n->id, particles);
    FREE_ARRAY(c, n->volume, particles + boundary);
    FREE_ARRAY(c, n->boundary_x, 3 * (size_t)boundary);
    FREE_ARRAY(c, n->built_x, 3 * (size_t)particles);
    FREE_ARRAY(c, n->start, particles + 1);
    FREE_ARRAY(c, n->boundary_start, particles);
    FREE_ARRAY(c, n->moved, pool_blocks(particles, MOVES));
    FREE_ARRAY(c, n->index, n->capacity);
    FREE_ARRAY(c, n->mirror, n->capacity);
    FREE_ARRAY(c, n, 1);
}

const pdyn_neighbours *neighbours_view(const struct neighbours *n) { return &n->view; }

/* ---- do the lists still hold? ---------------------------------------------------------------- */

static void find_moved(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    double limit = 0.25 * c->n->skin * c->n->skin;
    bool moved = false;
    for (int k = first; k < last; k++) {
        const double *a = c->x + 3 * c->n->id[k], *b = c->n->built_x + 3 * c->n->id[k];
        double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        moved |= !(vec3_dot(d, d) < limit); /* also where it is not a number */
    }
    c->n->moved[block] = moved;
}

static bool still_complete(struct neighbours *n, const double *x) {
    if (!n->built) return false;
    struct call call = {n, x};
    pool_for(n->context->pool, n->active, MOVES, find_moved, &call);
    bool moved = false;
    for (int b = 0; b < pool_blocks(n->active, MOVES); b++) moved |= n->moved[b];
    return !moved;
}

/* ---- building -------------------------------------------------------------------------------- */

/* The particle neighbours of i: everything for a centre, centres for the others. */
static int query_particles(const struct neighbours *n, const double *x, int i, int *list) {
    return grid_query(&n->moving, x + 3 * i, n->reach, i, n->centre[i] ? NULL : n->centre, list);
}

static int query_boundary(const struct neighbours *n, const double *x, int i, int *list) {
    return n->centre[i] ? grid_query(&n->fixed, x + 3 * i, n->reach, -1, NULL, list) : 0;
}

static void count_lists(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct neighbours *n = c->n;
    for (int k = first; k < last; k++) {
        int i = n->id[k];
        n->start[i + 1] = query_particles(n, c->x, i, NULL) + query_boundary(n, c->x, i, NULL);
    }
}

/* By insertion: lists are short and made of ascending runs. */
static void sort_ascending(int *list, int count) {
    for (int k = 1; k < count; k++) {
        int value = list[k], m = k;
        for (; m > 0 && list[m - 1] > value; m--) list[m] = list[m - 1];
        list[m] = value;
    }
}

static void fill_lists(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct neighbours *n = c->n;
    for (int k = first; k < last; k++) {
        int i = n->id[k], *list = n->index + n->start[i];
        int particles = query_particles(n, c->x, i, list);
        int boundary = query_boundary(n, c->x, i, list + particles);
        sort_ascending(list, particles);
        sort_ascending(list + particles, boundary);
        for (int b = 0; b < boundary; b++) list[particles + b] += n->view.particles;
        n->boundary_start[i] = n->start[i] + particles;
    }
}

static void fill_mirror(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct neighbours *n = c->n;
    for (int k = first; k < last; k++) {
        int i = n->id[k];
        for (int s = n->start[i]; s < n->boundary_start[i]; s++) {
            int low = n->start[n->index[s]], high = n->boundary_start[n->index[s]];
            while (high - low > 1) {
                int middle = low + (high - low) / 2;
                if (n->index[middle] <= i) low = middle;
                else high = middle;
            }
            n->mirror[s] = low;
        }
    }
}

static pdyn_status reserve(struct neighbours *n, size_t pairs) {
    if (pairs > INT32_MAX)
        return context_fail(n->context, PDYN_DIVERGED, "%zu neighbours: the fluid has collapsed",
                            pairs);
    if (pairs <= n->capacity) return PDYN_OK;
    FREE_ARRAY(n->context, n->index, n->capacity);
    FREE_ARRAY(n->context, n->mirror, n->capacity);
    n->capacity = pairs + pairs / 4; /* room, so that a warmed-up step allocates nothing */
    n->view.index = n->index = NEW_ARRAY(n->context, n->capacity, int);
    n->view.mirror = n->mirror = NEW_ARRAY(n->context, n->capacity, int);
    return n->index && n->mirror ? PDYN_OK : PDYN_NO_MEMORY;
}

static pdyn_status build(struct neighbours *n, const double *x) {
    struct pool *pool = n->context->pool;
    struct call call = {n, x};
    n->built = false;
    pdyn_status status = grid_sort(n->context, &n->moving, n->active, n->id, x);
    if (status != PDYN_OK) return status;
    memset(n->start, 0, (size_t)(n->view.particles + 1) * sizeof *n->start);
    pool_for(pool, n->active, PARTICLES, count_lists, &call);
    size_t pairs = 0;
    for (int i = 0; i < n->view.particles; i++) {
        pairs += (size_t)n->start[i + 1];
        n->start[i + 1] = n->boundary_start[i] = (int)(pairs < INT32_MAX ? pairs : INT32_MAX);
    }
    status = reserve(n, pairs);
    if (status != PDYN_OK) return status;
    pool_for(pool, n->active, PARTICLES, fill_lists, &call);
    pool_for(pool, n->active, PARTICLES, fill_mirror, &call);
    memcpy(n->built_x, x, 3 * (size_t)n->view.particles * sizeof *x);
    n->built = true;
    n->view.revision++;
    return PDYN_OK;
}

pdyn_status neighbours_update(struct neighbours *n, const double *x) {
    return still_complete(n, x) ? PDYN_OK : build(n, x);
}

/* ---- volumes of surface samples -------------------------------------------------------------- */

/* Makes room for `count` numbers in a scratch list. */
static pdyn_status grow(pdyn_context *context, int **list, int *capacity, int count) {
    if (count <= *capacity) return PDYN_OK;
    FREE_ARRAY(context, *list, *capacity);
    *capacity = 2 * count;
    *list = NEW_ARRAY(context, *capacity, int);
    return *list ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status neighbours_surface_volumes(pdyn_context *context, int points, const double *x,
                                       double support, double *volume) {
    struct grid grid;
    struct kernel kernel = kernel_make(support);
    pdyn_status status = grid_create(context, points, support, &grid);
    if (status != PDYN_OK) return status;
    status = grid_sort(context, &grid, points, NULL, x);
    int capacity = 0, *list = NULL;
    for (int i = 0; status == PDYN_OK && i < points; i++) {
        int found = grid_query(&grid, x + 3 * (size_t)i, support, -1, NULL, NULL);
        status = grow(context, &list, &capacity, found);
        if (status != PDYN_OK) break;
        grid_query(&grid, x + 3 * (size_t)i, support, -1, NULL, list);
        double sum = 0.0;
        for (int k = 0; k < found; k++)
            sum += kernel_value(&kernel, vec3_distance(x + 3 * (size_t)i, x + 3 * (size_t)list[k]));
        volume[i] = 1.0 / sum;
    }
    FREE_ARRAY(context, list, capacity);
    grid_free(context, &grid);
    return status;
}
