#include "grid.h"

#include "base/simd.h"
#include "compress.h"

#include <math.h>
#include <string.h>

enum { STRIDE = 8 }; /* points that are looked at side by side: there are as many beyond the last */

enum { TABLE = 8 }; /* cells for each point that there is room for in the table */

pdyn_status grid_create(pdyn_context *context, int capacity, double reach, struct grid *grid) {
    *grid = (struct grid){.cell = reach, .capacity = capacity};
    grid->id = NEW_ARRAY(context, capacity + STRIDE, int);
    grid->order = NEW_ARRAY(context, capacity, int);
    grid->swapped = NEW_ARRAY(context, capacity, int);
    grid->key = NEW_ARRAY(context, capacity, int64_t);
    grid->point_key = NEW_ARRAY(context, capacity, int64_t);
    grid->start = NEW_ARRAY(context, capacity + 1, int);
    grid->table = NEW_ARRAY(context, TABLE * (size_t)capacity, int);
    bool good = grid->id && grid->order && grid->swapped && grid->key && grid->point_key &&
                (!capacity || grid->table);
    for (int a = 0; a < 3; a++)
        good &= (grid->x[a] = NEW_ARRAY(context, capacity + STRIDE, double)) != NULL;
    if (grid->start && (!capacity || good)) return PDYN_OK;
    grid_free(context, grid);
    return PDYN_NO_MEMORY;
}

void grid_free(pdyn_context *context, struct grid *grid) {
    FREE_ARRAY(context, grid->id, grid->capacity + STRIDE);
    FREE_ARRAY(context, grid->order, grid->capacity);
    FREE_ARRAY(context, grid->swapped, grid->capacity);
    FREE_ARRAY(context, grid->key, grid->capacity);
    FREE_ARRAY(context, grid->point_key, grid->capacity);
    FREE_ARRAY(context, grid->start, grid->capacity + 1);
    FREE_ARRAY(context, grid->table, TABLE * (size_t)grid->capacity);
    for (int a = 0; a < 3; a++) FREE_ARRAY(context, grid->x[a], grid->capacity + STRIDE);
}

static void cell_of(const struct grid *grid, const double *x, int cell[3]) {
    for (int a = 0; a < 3; a++) cell[a] = (int)floor(x[a] / grid->cell);
}

static bool in_range(const struct grid *grid, const double *x) {
    double bound = (double)GRID_RANGE * grid->cell;
    return fabs(x[0]) < bound && fabs(x[1]) < bound && fabs(x[2]) < bound;
}

/* Of the box around all points: they must be numbers of 64 bits. */
static const double most_keys = 0x1p62;

/* Far outside there is no cell, and so no key. */
static int64_t key_of(const struct grid *grid, const int cell[3]) {
    return ((int64_t)cell[0] - grid->low[0]) + grid->pitch[0] * ((int64_t)cell[1] - grid->low[1]) +
           grid->pitch[1] * ((int64_t)cell[2] - grid->low[2]);
}

/* The box of cells in use gives the keys; a margin keeps runs along x from going round its ends. */
static pdyn_status find_box(pdyn_context *context, struct grid *grid, const int *id,
                            const double *x) {
    int low[3] = {GRID_RANGE, GRID_RANGE, GRID_RANGE},
        high[3] = {-GRID_RANGE, -GRID_RANGE, -GRID_RANGE};
    for (int k = 0; k < grid->points; k++) {
        int cell[3], i = id ? id[k] : k;
        const double *at = x + 3 * (size_t)i;
        if (!in_range(grid, at))
            return context_fail(
                context, PDYN_DIVERGED,
                "point %d is at (%g, %g, %g): the simulation has diverged or something "
                "left the scene",
                i, at[0], at[1], at[2]);
        cell_of(grid, at, cell);
        for (int a = 0; a < 3; a++) {
            if (cell[a] < low[a]) low[a] = cell[a];
            if (cell[a] > high[a]) high[a] = cell[a];
        }
    }
    int64_t span[3];
    for (int a = 0; a < 3; a++) {
        if (!grid->points) low[a] = high[a] = 0; /* some cell: nothing is in any */
        grid->low[a] = low[a] - 1;
        span[a] = (int64_t)high[a] - low[a] + 3;
    }
    grid->pitch[0] = span[0], grid->pitch[1] = span[0] * span[1];
    if ((double)span[0] * (double)span[1] * (double)span[2] < most_keys) {
        grid->keys = grid->pitch[1] * span[2];
        return PDYN_OK;
    }
    return context_fail(context, PDYN_DIVERGED,
                        "points are %g x %g x %g m apart: the simulation has diverged or something "
                        "left the scene",
                        (double)span[0] * grid->cell, (double)span[1] * grid->cell,
                        (double)span[2] * grid->cell);
}

/* Sorts `order` by the keys of the points that it names, eleven bits at a time, from the lowest. */
static void sort_by_key(struct grid *grid) {
    enum { BITS = 11, BINS = 1 << BITS };
    int64_t all = 0;
    for (int k = 0; k < grid->points; k++) all |= grid->point_key[k];
    for (int shift = 0; shift == 0 || all >> shift; shift += BITS) {
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

/* The points in the order of their cells, and where each cell begins. */
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

/* Of every key in the box, those of empty cells, too. */
static void fill_table(struct grid *grid) {
    int64_t key = 0;
    grid->tabled = grid->keys <= TABLE * (int64_t)grid->capacity;
    if (!grid->tabled) return;
    for (int c = 0; c < grid->cells; c++)
        while (key <= grid->key[c]) grid->table[key++] = grid->start[c];
    while (key < grid->keys) grid->table[key++] = grid->points;
}

pdyn_status grid_sort(pdyn_context *context, struct grid *grid, int points, const int *id,
                      const double *x) {
    grid->points = points;
    pdyn_status status = find_box(context, grid, id, x);
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

/* The first cell whose key is at least `key`, looked for from cell `c` on in growing steps. */
static int find_cell(const struct grid *grid, int64_t key, int c) {
    int low = -1, high = grid->cells, step = 1; /* key[low] < key <= key[high] */
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

/* The first point of a cell whose key is at least `key`, also of one outside. */
static int look_up(const struct grid *grid, int64_t key) {
    if (key < 0) return 0;
    return key < grid->keys ? grid->table[key] : grid->points;
}

/* Points of the cells with keys in [key, key + width). */
static void find_run(const struct grid *grid, struct grid_cells *cells, int r, int64_t key,
                     int width) {
    if (grid->tabled) {
        cells->first[r] = look_up(grid, key), cells->last[r] = look_up(grid, key + width);
        return;
    }
    int c = cells->cell[r] = find_cell(grid, key, cells->cell[r]);
    cells->first[r] = grid->start[c];
    while (c < grid->cells && grid->key[c] < key + width) c++;
    cells->last[r] = grid->start[c];
}

void grid_around(const struct grid *grid, const double *at, struct grid_cells *cells) {
    int cell[3];
    cell_of(grid, at, cell);
    int64_t middle = key_of(grid, cell);
    if (cells->known && cells->key == middle) return;
    cells->known = true, cells->key = middle;
    for (int r = 0; r < GRID_RUNS; r++)
        find_run(grid, cells, r,
                 middle - 1 + (r % 3 - 1) * grid->pitch[0] + (r / 3 - 1) * grid->pitch[1], 3);
}

/* Candidates, side by side. */
enum { CHUNK = 512 };
struct candidates {
    int count;
    double squared[CHUNK + STRIDE]; /* m^2, of the distance */
    int id[CHUNK + STRIDE];
};

/* Appends `count` points, and what then follows up to a whole stride. */
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

/* Writes the good ones behind the `found` that are there; returns how many are there then. */
INLINE int take(struct candidates *c, double limit, int self, const bool *keep, int *list, int room,
                int found) {
    int count = c->count;
    c->count = 0;
    if (!keep && found + count <= room)
        return found + compact(c->squared, c->id, count, limit, self, list + found);
    for (int k = 0; k < count; k++) {
        list[found < room ? found : room] = c->id[k];
        found += (c->squared[k] < limit) & (c->id[k] != self) & (!keep || keep[c->id[k]]);
    }
    return found;
}

WIDE static int query(const struct grid *grid, const struct grid_cells *cells, const double *at,
                      double radius, int self, const bool *keep, int *list, int room) {
    struct candidates near;
    double limit = radius * radius;
    int found = 0;
    near.count = 0;
    for (int r = 0; r < GRID_RUNS; r++)
        for (int first = cells->first[r], count; first < cells->last[r]; first += count) {
            count = cells->last[r] - first;
            if (count > CHUNK - near.count) count = CHUNK - near.count;
            measure(grid, at, first, count, &near);
            if (near.count == CHUNK) found = take(&near, limit, self, keep, list, room, found);
        }
    return take(&near, limit, self, keep, list, room, found);
}

int grid_query(const struct grid *grid, const struct grid_cells *cells, const double *at,
               double radius, int self, const bool *keep, int *list, int room) {
    return query(grid, cells, at, radius, self, keep, list, room);
}
