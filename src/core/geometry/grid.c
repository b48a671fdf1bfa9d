/* A uniform grid for neighbour searches: sorting points into cells, and queries. */
#include "grid.h"

#include "compress.h"
#include "projdyn/simd.h"

#include <math.h>
#include <string.h>

/* Points of a vector operation: arrays have as many unused elements at their end. */
enum { STRIDE = 8 };

enum { TABLE = 8 }; /* length of the key table per point of capacity */

static bool resize_arrays(pdyn_context *context, struct grid *grid, enum array_action action) {
    size_t capacity = (size_t)grid->capacity;
    const struct array_entry table[] = {
        ARRAY(grid->id, capacity + STRIDE),   ARRAY(grid->order, capacity),
        ARRAY(grid->swapped, capacity),       ARRAY(grid->key, capacity),
        ARRAY(grid->point_key, capacity),     ARRAY(grid->start, capacity + 1),
        ARRAY(grid->table, TABLE * capacity), ARRAY(grid->x[0], capacity + STRIDE),
        ARRAY(grid->x[1], capacity + STRIDE), ARRAY(grid->x[2], capacity + STRIDE),
    };
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

pdyn_status grid_create(pdyn_context *context, int capacity, double reach, struct grid *grid) {
    *grid = (struct grid){.cell = reach, .capacity = capacity};
    if (resize_arrays(context, grid, ARRAYS_ALLOCATE)) return PDYN_OK;
    grid_free(context, grid);
    return PDYN_NO_MEMORY;
}

void grid_free(pdyn_context *context, struct grid *grid) {
    resize_arrays(context, grid, ARRAYS_FREE);
}

static void cell_of(const struct grid *grid, const double *x, int cell[3]) {
    for (int a = 0; a < 3; a++) cell[a] = (int)floor(x[a] / grid->cell);
}

static bool in_range(const struct grid *grid, const double *x) {
    double bound = (double)GRID_RANGE * grid->cell;
    return fabs(x[0]) < bound && fabs(x[1]) < bound && fabs(x[2]) < bound;
}

/* Bound of the number of cells in the bounding box, so that keys fit 64 bits */
static const double max_keys = 0x1p62;

/* Not defined far outside of the bounding box: such cells have no key. */
static int64_t key_of(const struct grid *grid, const int cell[3]) {
    return ((int64_t)cell[0] - grid->low[0]) + grid->pitch[0] * ((int64_t)cell[1] - grid->low[1]) +
           grid->pitch[1] * ((int64_t)cell[2] - grid->low[2]);
}

/* Computes the bounding box of the cells in use, of one cell without points. */
static pdyn_status find_box(const struct grid *grid, const int *id, const double *x, int low[3],
                            int high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = grid->points ? GRID_RANGE : 0;
        high[a] = grid->points ? -GRID_RANGE : 0;
    }
    for (int k = 0; k < grid->points; k++) {
        int cell[3], i = id ? id[k] : k;
        const double *at = x + 3 * (size_t)i;
        if (!in_range(grid, at))
            return set_error(
                PDYN_DIVERGED,
                "point %d is at (%g, %g, %g): the simulation has diverged or something "
                "left the scene",
                i, at[0], at[1], at[2]);
        cell_of(grid, at, cell);
        for (int a = 0; a < 3; a++) {
            if (cell[a] < low[a]) low[a] = cell[a];
            if (cell[a] > high[a]) high[a] = cell[a];
        }
    }
    return PDYN_OK;
}

/* Numbers the cells of the bounding box by their keys; a margin of one cell keeps runs along x from
 * wrapping around its ends. */
static pdyn_status number_cells(struct grid *grid, const int low[3], const int high[3]) {
    int64_t span[3];
    for (int a = 0; a < 3; a++) {
        grid->low[a] = low[a] - 1;
        span[a] = (int64_t)high[a] - low[a] + 3;
    }
    grid->pitch[0] = span[0], grid->pitch[1] = span[0] * span[1];
    if ((double)span[0] * (double)span[1] * (double)span[2] < max_keys) {
        grid->keys = grid->pitch[1] * span[2];
        return PDYN_OK;
    }
    return set_error(PDYN_DIVERGED,
                     "points are %g x %g x %g m apart: the simulation has diverged or something "
                     "left the scene",
                     (double)span[0] * grid->cell, (double)span[1] * grid->cell,
                     (double)span[2] * grid->cell);
}

/* Radix sort of `order` by the keys of the points, eleven bits per pass. */
static void sort_by_key(struct grid *grid) {
    enum { BITS = 11, BINS = 1 << BITS };
    int64_t used_bits = 0;
    for (int k = 0; k < grid->points; k++) used_bits |= grid->point_key[k];
    for (int shift = 0; shift == 0 || used_bits >> shift; shift += BITS) {
        int end[BINS + 1] = {0};
        for (int k = 0; k < grid->points; k++)
            end[1 + (grid->point_key[k] >> shift & (BINS - 1))]++;
        for (int b = 0; b < BINS; b++) end[b + 1] += end[b];
        for (int k = 0; k < grid->points; k++) {
            int point = grid->order[k];
            grid->swapped[end[grid->point_key[point] >> shift & (BINS - 1)]++] = point;
        }
        int *sorted = grid->swapped;
        grid->swapped = grid->order, grid->order = sorted;
    }
}

/* Copies ids and coordinates in the order of the cells and finds the first point of each cell. */
static void fill_cells(struct grid *grid, const int *id, const double *x) {
    grid->cells = 0;
    for (int k = 0; k < grid->points; k++) {
        int point = grid->order[k], i = id ? id[point] : point;
        int64_t key = grid->point_key[point];
        grid->id[k] = i;
        for (int a = 0; a < 3; a++) grid->x[a][k] = x[3 * (size_t)i + a];
        if (grid->cells && grid->key[grid->cells - 1] == key) continue;
        grid->key[grid->cells] = key, grid->start[grid->cells++] = k;
    }
    grid->start[grid->cells] = grid->points;
}

/* Fills the key table, with empty cells included, if there is room for all keys. */
static void fill_table(struct grid *grid) {
    int64_t key = 0;
    grid->tabled = grid->keys <= TABLE * (int64_t)grid->capacity;
    if (!grid->tabled) return;
    for (int c = 0; c < grid->cells; c++)
        while (key <= grid->key[c]) grid->table[key++] = grid->start[c];
    while (key < grid->keys) grid->table[key++] = grid->points;
}

pdyn_status grid_sort(struct grid *grid, int points, const int *id, const double *x) {
    int low[3], high[3];
    grid->points = points;
    pdyn_status status = find_box(grid, id, x, low, high);
    if (status == PDYN_OK) status = number_cells(grid, low, high);
    if (status != PDYN_OK) return status;
    for (int k = 0; k < points; k++) {
        int cell[3];
        cell_of(grid, x + 3 * (size_t)(id ? id[k] : k), cell);
        grid->point_key[k] = key_of(grid, cell), grid->order[k] = k;
    }
    sort_by_key(grid);
    fill_cells(grid, id, x);
    fill_table(grid);
    return PDYN_OK;
}

/* Finds the first cell with a key of at least `key`, by exponential search from cell `c`. */
static int find_cell(const struct grid *grid, int64_t key, int c) {
    int low = -1, high = grid->cells, step = 1; /* invariant: key[low] < key <= key[high] */
    if (c < high && grid->key[c] < key)
        for (low = c; low + step < high; step *= 2) {
            if (grid->key[low + step] >= key) high = low + step;
            else low += step;
        }
    else
        for (high = c < high ? c : high; high - step > low; step *= 2) {
            if (grid->key[high - step] < key) low = high - step;
            else high -= step;
        }
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (grid->key[middle] < key) low = middle;
        else high = middle;
    }
    return high;
}

/* First point of the first cell with a key of at least `key`; `key` may be out of range. */
static int point_from_key(const struct grid *grid, int64_t key) {
    if (key < 0) return 0;
    return key < grid->keys ? grid->table[key] : grid->points;
}

/* Finds the points of the cells with keys in [key, key + width). */
static void find_run(const struct grid *grid, struct grid_cells *cells, int r, int64_t key,
                     int width) {
    if (grid->tabled) {
        cells->first[r] = point_from_key(grid, key);
        cells->last[r] = point_from_key(grid, key + width);
        return;
    }
    int c = cells->cell[r] = find_cell(grid, key, cells->cell[r]);
    cells->first[r] = grid->start[c];
    while (c < grid->cells && grid->key[c] < key + width) c++;
    cells->last[r] = grid->start[c];
}

void grid_update_cells(const struct grid *grid, const double *at, struct grid_cells *cells) {
    int cell[3];
    cell_of(grid, at, cell);
    int64_t middle = key_of(grid, cell);
    if (cells->known && cells->key == middle) return;
    cells->known = true, cells->key = middle;
    for (int r = 0; r < GRID_RUNS; r++)
        find_run(grid, cells, r,
                 middle - 1 + (r % 3 - 1) * grid->pitch[0] + (r / 3 - 1) * grid->pitch[1], 3);
}

/* Candidates of a query: ids and squared distances in contiguous arrays. */
enum { CHUNK = 512 };
struct candidates {
    int count;
    double squared[CHUNK + STRIDE]; /* squared distance, m^2 */
    int id[CHUNK + STRIDE];
};

/* Appends `count` points; rounds up to a multiple of STRIDE and ignores what is beyond `count`. */
INLINE void measure(const struct grid *grid, const double *at, int first, int count,
                    struct candidates *c) {
    const double *x = grid->x[0] + first, *y = grid->x[1] + first, *z = grid->x[2] + first;
    double *squared = c->squared + c->count, ax = at[0], ay = at[1], az = at[2];
    for (int s = 0; s < count; s += STRIDE) {
        double sum[STRIDE];
        for (int k = 0; k < STRIDE; k++) {
            double dx = x[s + k] - ax, dy = y[s + k] - ay, dz = z[s + k] - az;
            sum[k] = dx * dx + dy * dy + dz * dz;
        }
        memcpy(squared + s, sum, sizeof sum);
        memcpy(c->id + c->count + s, grid->id + first + s, STRIDE * sizeof *c->id);
    }
    c->count += count;
}

/* Appends the candidates within the limit to `list`, which has `found` entries, and empties `c`.
 * Returns the new number of entries. */
INLINE int append_near(struct candidates *c, double limit, int self, int *list, int room,
                       int found) {
    int count = c->count;
    c->count = 0;
    if (!count) return found;
    if (found + count <= room)
        return found + compress_ids(c->squared, c->id, count, limit, self, list + found);
    for (int k = 0; k < count; k++) {
        list[found < room ? found : room] = c->id[k];
        found += (c->squared[k] < limit) & (c->id[k] != self);
    }
    return found;
}

WIDE static int query(const struct grid *grid, const struct grid_cells *cells, const double *at,
                      double radius, int self, int *list, int room) {
    struct candidates near;
    double limit = radius * radius;
    int found = 0;
    near.count = 0;
    for (int r = 0; r < GRID_RUNS; r++)
        for (int first = cells->first[r], count; first < cells->last[r]; first += count) {
            count = cells->last[r] - first;
            if (count > CHUNK - near.count) count = CHUNK - near.count;
            measure(grid, at, first, count, &near);
            if (near.count == CHUNK) found = append_near(&near, limit, self, list, room, found);
        }
    return append_near(&near, limit, self, list, room, found);
}

int grid_query(const struct grid *grid, const struct grid_cells *cells, const double *at,
               double radius, int self, int *list, int room) {
    return query(grid, cells, at, radius, self, list, room);
}

/* ---- visits ---------------------------------------------------------------------------------- */

/* First point of the first cell with a key of at least `key`. */
static int first_point(const struct grid *grid, int64_t key) {
    return grid->tabled ? point_from_key(grid, key) : grid->start[find_cell(grid, key, 0)];
}

void grid_visit(const struct grid *grid, const double *at, double radius, grid_visit_fn *visit,
                void *user) {
    if (!grid->points) return;
    const int64_t span[3] = {grid->pitch[0], grid->pitch[1] / grid->pitch[0],
                             grid->keys / grid->pitch[1]};
    int64_t first[3], last[3]; /* cells of the bounding box */
    for (int a = 0; a < 3; a++) {
        double low = floor((at[a] - radius) / grid->cell) - grid->low[a];
        double high = floor((at[a] + radius) / grid->cell) - grid->low[a];
        if (!(low < (double)span[a] && high >= 0.0)) return;
        first[a] = (int64_t)fmax(low, 0.0), last[a] = (int64_t)fmin(high, (double)span[a] - 1.0);
    }
    for (int64_t z = first[2]; z <= last[2]; z++)
        for (int64_t y = first[1]; y <= last[1]; y++) {
            int64_t row = grid->pitch[0] * y + grid->pitch[1] * z;
            int end = first_point(grid, row + last[0] + 1);
            for (int k = first_point(grid, row + first[0]); k < end; k++) visit(user, grid->id[k]);
        }
}
