#include "neighbours.h"

#include "grid.h"
#include "kernel.h"

#include <string.h>

enum { PARTICLES = 128, MOVES = 8192 }; /* grains */
enum { USUAL = 64 * PARTICLES };        /* neighbours of a block, to begin with */

struct neighbours {
    pdyn_context *context;
    pdyn_neighbours view;
    double reach;                          /* m: support and skin */
    double skin;                           /* m */
    bool *centre;                          /* particles */
    double centre_volume;                  /* m^3 */
    int most;                              /* particles that may take part */
    int active;                            /* particles that take part, */
    int *id;                               /* active: these */
    double *volume, *boundary_x, *built_x; /* built_x: particles x 3, where the lists were built */
    struct grid moving, fixed;
    int carried;                       /* the last boundary points, which may move */
    double *built_carried;             /* carried x 3, where the lists were built */
    double carried_by;                 /* m, the farthest of them since then */
    int *start, *boundary_start, *end; /* particles */
    int *index;                        /* for each block of slots `room` and one */
    int room;                          /* neighbours of a block */
    int *used;                         /* a count for each block */
    size_t capacity;                   /* of index */
    bool *moved;                       /* a flag for each parallel block of `active` */
    struct sides *sides;               /* NULL where there is no surface */
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
    n->built_carried = NEW_ARRAY(c, 3 * (size_t)n->carried, double);
    n->start = NEW_ARRAY(c, particles, int);
    n->boundary_start = NEW_ARRAY(c, particles, int);
    n->end = NEW_ARRAY(c, particles, int);
    n->used = NEW_ARRAY(c, pool_blocks(particles, PARTICLES), int);
    n->moved = NEW_ARRAY(c, pool_blocks(particles, MOVES), bool);
    bool good = n->centre && n->id && n->volume && (!boundary || n->boundary_x) && n->built_x &&
                (!n->carried || n->built_carried) && n->start && n->boundary_start && n->end &&
                n->used && n->moved;
    if (!good) return PDYN_NO_MEMORY;
    return grid_create(c, particles, n->reach, &n->moving);
}

/* The part of the boundary that may move. */
static double *carried_x(const struct neighbours *n) {
    return n->boundary_x + 3 * (size_t)(n->view.points - n->view.particles - n->carried);
}

static pdyn_status sort_boundary(struct neighbours *n) {
    if (n->carried) memcpy(n->built_carried, carried_x(n), 3 * (size_t)n->carried * sizeof(double));
    n->carried_by = 0.0;
    return grid_sort(n->context, &n->fixed, n->view.points - n->view.particles, NULL,
                     n->boundary_x);
}

/* Copies the points, and shows them. */
static void fill_points(struct neighbours *n, const struct neighbours_points *points,
                        const struct samples *samples) {
    size_t particles = (size_t)points->particles, boundary = (size_t)points->boundary;
    memcpy(n->centre, points->centre, particles * sizeof *n->centre);
    memcpy(n->volume, points->volume, (particles + boundary) * sizeof *n->volume);
    if (boundary) memcpy(n->boundary_x, points->boundary_x, 3 * boundary * sizeof *n->boundary_x);
    for (int i = 0; i < points->particles; i++) {
        if (n->volume[i] > 0.0) n->id[n->active++] = i;
        if (n->centre[i]) n->centre_volume = n->volume[i];
    }
    n->most = n->active, n->view.volume_revision = 1;
    n->view.volume = n->volume, n->view.boundary_x = n->boundary_x;
    n->view.start = n->start, n->view.boundary_start = n->boundary_start, n->view.end = n->end;
    if (!samples) return;
    n->view.samples = samples->count;
    n->view.sample_vertex = samples->vertex, n->view.sample_weight = samples->weight;
}

pdyn_status neighbours_create(pdyn_context *context, const struct neighbours_points *points,
                              const struct samples *samples, double support, double skin,
                              struct neighbours **out) {
    struct neighbours *n = *out = NEW_ARRAY(context, 1, struct neighbours);
    if (!n) return PDYN_NO_MEMORY;
    n->context = context;
    n->carried = points->moving, n->sides = points->sides;
    n->skin = skin * support, n->reach = support + n->skin;
    n->view = (pdyn_neighbours){.support = support,
                                .particles = points->particles,
                                .points = points->particles + points->boundary};
    pdyn_status status = allocate(n, points->particles, points->boundary);
    if (status == PDYN_OK) {
        fill_points(n, points, samples);
        status = grid_create(context, points->boundary, n->reach, &n->fixed);
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
    int particles = n->view.particles, boundary = n->view.points - particles;
    grid_free(c, &n->moving);
    grid_free(c, &n->fixed);
    FREE_ARRAY(c, n->centre, particles);
    FREE_ARRAY(c, n->id, particles);
    FREE_ARRAY(c, n->volume, particles + boundary);
    FREE_ARRAY(c, n->boundary_x, 3 * (size_t)boundary);
    FREE_ARRAY(c, n->built_x, 3 * (size_t)particles);
    FREE_ARRAY(c, n->built_carried, 3 * (size_t)n->carried);
    FREE_ARRAY(c, n->start, particles);
    FREE_ARRAY(c, n->boundary_start, particles);
    FREE_ARRAY(c, n->end, particles);
    FREE_ARRAY(c, n->used, pool_blocks(particles, PARTICLES));
    FREE_ARRAY(c, n->moved, pool_blocks(particles, MOVES));
    FREE_ARRAY(c, n->index, n->capacity);
    FREE_ARRAY(c, n, 1);
}

const pdyn_neighbours *neighbours_view(const struct neighbours *n) { return &n->view; }

/* Who takes no part has an empty list. */
void neighbours_change(struct neighbours *n, const bool *live) {
    n->active = 0;
    for (int i = 0; i < n->view.particles; i++) {
        if (n->centre[i]) n->volume[i] = live[i] ? n->centre_volume : 0.0;
        if (n->volume[i] > 0.0) n->id[n->active++] = i;
        else n->start[i] = n->boundary_start[i] = n->end[i] = 0;
    }
    n->built = false;
    n->view.volume_revision++;
}

void neighbours_stretch(struct neighbours *n, const struct samples *samples) {
    int first = n->view.particles - samples->count;
    memcpy(n->volume + first, samples->volume, (size_t)samples->count * sizeof *n->volume);
    n->view.volume_revision++;
}

/* ---- do the lists still hold? ---------------------------------------------------------------- */

void neighbours_move(struct neighbours *n, const double *x) {
    double *carried = carried_x(n);
    n->carried_by = 0.0;
    memcpy(carried, x, 3 * (size_t)n->carried * sizeof *x);
    for (size_t k = 0; k < 3 * (size_t)n->carried; k += 3)
        n->carried_by = fmax(n->carried_by, vec3_distance(carried + k, n->built_carried + k));
    n->view.boundary_revision++;
}

/* How far a particle may have moved: towards another one that has too, or a boundary point. */
static double slack(const struct neighbours *n) {
    return fmax(0.0, fmin(0.5 * n->skin, n->skin - n->carried_by));
}

static void find_moved(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    double limit = slack(c->n) * slack(c->n);
    bool moved = false;
    for (int k = first; k < last; k++) {
        const double *a = c->x + 3 * c->n->id[k], *b = c->n->built_x + 3 * c->n->id[k];
        double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        moved |= !(vec3_dot(d, d) < limit); /* also where it is not a number */
    }
    c->n->moved[block] = moved;
}

bool neighbours_hold(struct neighbours *n, const double *x) {
    if (!n->built) return false;
    struct call call = {n, x};
    pool_for(n->context->pool, n->active, MOVES, find_moved, &call);
    bool moved = false;
    for (int b = 0; b < pool_blocks(n->active, MOVES); b++) moved |= n->moved[b];
    return !moved;
}

/* ---- building -------------------------------------------------------------------------------- */

/* The surroundings of the last cell: points are taken in the order of their cells, so that these
 * are looked up once for all points of a cell. */
struct walk {
    struct grid_cells moving, fixed;
};

/* Neighbours of i among the particles: everything for a centre, centres for the others. */
static int query_particles(const struct neighbours *n, struct walk *w, const double *at, int i,
                           int *list, int room) {
    grid_around(&n->moving, at, &w->moving);
    return grid_query(&n->moving, &w->moving, at, n->reach, i, n->centre[i] ? NULL : n->centre,
                      list, room);
}

static int query_boundary(const struct neighbours *n, struct walk *w, const double *at, int i,
                          int *list, int room) {
    if (!n->centre[i]) return 0;
    grid_around(&n->fixed, at, &w->fixed);
    return grid_query(&n->fixed, &w->fixed, at, n->reach, -1, NULL, list, room);
}

/* The lists of a block of slots, one after the other in the block's part of `index`. What does not
 * fit is counted only. */
static void fill_lists(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct neighbours *n = c->n;
    struct walk walk = {0};
    int begin = block * (n->room + 1), used = 0;
    for (int k = first; k < last; k++) {
        int i = n->moving.id[k], room = used < n->room ? n->room - used : 0;
        int *list = n->index + begin + n->room - room;
        const double *at = c->x + 3 * i;
        int particles = query_particles(n, &walk, at, i, list, room);
        room = particles < room ? room - particles : 0;
        list = n->index + begin + n->room - room;
        int boundary = query_boundary(n, &walk, at, i, list, room);
        for (int b = 0; b < boundary && b < room; b++) list[b] += n->view.particles;
        n->start[i] = begin + used, n->boundary_start[i] = begin + used + particles;
        used += particles + boundary;
        n->end[i] = begin + used;
    }
    n->used[block] = used;
}

/* Makes room for the fullest block, and some more, so that a warmed-up step allocates nothing. */
static pdyn_status reserve(struct neighbours *n, int most) {
    size_t blocks = (size_t)pool_blocks(n->most, PARTICLES);
    size_t capacity = blocks * ((size_t)most + (size_t)most / 4 + 1);
    if (capacity > INT32_MAX)
        return context_fail(n->context, PDYN_DIVERGED,
                            "more than 2^31 neighbours: the fluid has collapsed");
    FREE_ARRAY(n->context, n->index, n->capacity);
    n->room = most + most / 4, n->capacity = capacity;
    n->view.index = n->index = NEW_ARRAY(n->context, capacity, int);
    return n->index ? PDYN_OK : PDYN_NO_MEMORY;
}

/* Fills all lists, once more where some block had not room enough. */
static pdyn_status fill(struct neighbours *n, const double *x) {
    struct call call = {n, x};
    pdyn_status status = n->index ? PDYN_OK : reserve(n, USUAL);
    for (int most = 0; status == PDYN_OK; status = reserve(n, most)) {
        pool_for(n->context->pool, n->active, PARTICLES, fill_lists, &call);
        for (int b = 0; b < pool_blocks(n->active, PARTICLES); b++)
            if (n->used[b] > most) most = n->used[b];
        if (most <= n->room) break;
    }
    return status;
}

static const double *position(const struct neighbours *n, const double *x, int i) {
    int particles = n->view.particles;
    return i < particles ? x + 3 * (size_t)i : n->boundary_x + 3 * (size_t)(i - particles);
}

/* Samples are what a surface is felt by. */
static bool hides(const struct neighbours *n, int i) {
    return i >= n->view.particles || n->centre[i];
}

static void find_clearances(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct neighbours *n = c->n;
    for (int k = first; k < last; k++) {
        int i = k < n->active ? n->id[k] : n->view.particles + k - n->active;
        if (hides(n, i)) sides_approach(n->sides, i, position(n, c->x, i));
    }
}

/* Takes other centres and boundary points that a surface hides from the lists of centres, and
 * closes the gaps. */
static void hide(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct neighbours *n = c->n;
    for (int k = first; k < last; k++) {
        int i = n->id[k], to = n->start[i], boundary = n->boundary_start[i];
        if (!n->centre[i]) continue;
        for (int s = n->start[i]; s < n->end[i]; s++) {
            int j = n->index[s];
            if (s == boundary) n->boundary_start[i] = to;
            if (hides(n, j) &&
                sides_between(n->sides, i, position(n, c->x, i), j, position(n, c->x, j)))
                continue;
            n->index[to++] = j;
        }
        if (boundary == n->end[i]) n->boundary_start[i] = to;
        n->end[i] = to;
    }
}

static void separate(struct neighbours *n, const double *x) {
    struct call call = {n, x};
    struct box centres = box_empty;
    int boundary = n->view.points - n->view.particles;
    for (int k = 0; k < n->active; k++)
        if (n->centre[n->id[k]]) box_add(&centres, x + 3 * (size_t)n->id[k]);
    sides_plant(n->sides, x, &centres);
    pool_for(n->context->pool, n->active + boundary, PARTICLES, find_clearances, &call);
    pool_for(n->context->pool, n->active, PARTICLES, hide, &call);
}

pdyn_status neighbours_build(struct neighbours *n, const double *x) {
    n->built = false;
    pdyn_status status = n->carried_by > 0.0 ? sort_boundary(n) : PDYN_OK;
    if (status == PDYN_OK) status = grid_sort(n->context, &n->moving, n->active, n->id, x);
    if (status == PDYN_OK) status = fill(n, x);
    if (status != PDYN_OK) return status;
    if (n->sides) separate(n, x);
    memmove(n->built_x, x, 3 * (size_t)n->view.particles * sizeof *x);
    n->built = true;
    n->view.revision++;
    return PDYN_OK;
}

pdyn_status neighbours_persist(struct neighbours *n, pdyn_archive *archive) {
    bool built = n->built;
    archive->bytes(archive, &built, sizeof built);
    archive->bytes(archive, n->built_x, 3 * (size_t)n->view.particles * sizeof *n->built_x);
    if (n->carried)
        archive->bytes(archive, n->built_carried, 3 * (size_t)n->carried * sizeof(double));
    if (!archive->reading || !built) return PDYN_OK;
    if (n->carried) memcpy(carried_x(n), n->built_carried, 3 * (size_t)n->carried * sizeof(double));
    pdyn_status status = sort_boundary(n);
    return status == PDYN_OK ? neighbours_build(n, n->built_x) : status;
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
    int capacity = 0, *list = NULL;
    struct grid_cells cells = {0};
    status = grow(context, &list, &capacity, 64);
    if (status == PDYN_OK) status = grid_sort(context, &grid, points, NULL, x);
    for (int i = 0; status == PDYN_OK && i < points; i++) {
        const double *at = x + 3 * (size_t)i;
        grid_around(&grid, at, &cells);
        int found = grid_query(&grid, &cells, at, support, -1, NULL, list, capacity - 1);
        if (found >= capacity) {
            status = grow(context, &list, &capacity, found + 1);
            if (status != PDYN_OK) break;
            grid_query(&grid, &cells, at, support, -1, NULL, list, capacity - 1);
        }
        double sum = 0.0;
        for (int k = 0; k < found; k++)
            sum += kernel_value(&kernel, vec3_distance(at, x + 3 * (size_t)list[k]));
        volume[i] = 1.0 / sum;
    }
    FREE_ARRAY(context, list, capacity);
    grid_free(context, &grid);
    return status;
}
