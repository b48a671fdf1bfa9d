#include "grid.h"

#include "simd.h"

#include <math.h>
#include <string.h>

pdyn_status grid_create(pdyn_context *context, int capacity, double cell, struct grid *grid) {
    *grid = (struct grid){.cell = cell, .capacity = capacity, .buckets = 1};
    while (grid->buckets < capacity) grid->buckets *= 2;
    grid->start = NEW_ARRAY(context, grid->buckets + 1, int);
    grid->id = NEW_ARRAY(context, capacity, int);
    bool good = true;
    for (int a = 0; a < 3; a++) good &= (grid->x[a] = NEW_ARRAY(context, capacity, double)) != NULL;
    grid->bucket = NEW_ARRAY(context, capacity, int);
    if (grid->start && (!capacity || (grid->id && good && grid->bucket))) return PDYN_OK;
    grid_free(context, grid);
    return PDYN_NO_MEMORY;
}

void grid_free(pdyn_context *context, struct grid *grid) {
    FREE_ARRAY(context, grid->start, grid->buckets + 1);
    FREE_ARRAY(context, grid->id, grid->capacity);
    for (int a = 0; a < 3; a++) FREE_ARRAY(context, grid->x[a], grid->capacity);
    FREE_ARRAY(context, grid->bucket, grid->capacity);
}

static void cell_of(const struct grid *grid, const double *x, int cell[3]) {
    for (int a = 0; a < 3; a++) cell[a] = (int)floor(x[a] / grid->cell);
}

static bool in_range(const struct grid *grid, const double *x) {
    double bound = (double)GRID_RANGE * grid->cell;
    return fabs(x[0]) < bound && fabs(x[1]) < bound && fabs(x[2]) < bound;
}

pdyn_status grid_sort(pdyn_context *context, struct grid *grid, int points, const int *id,
                      const double *x) {
    grid->points = points;
    int *end = grid->start + 1; /* shifted by one, so that filling turns starts into ends */
    memset(grid->start, 0, (size_t)(grid->buckets + 1) * sizeof *grid->start);
    for (int k = 0; k < points; k++) {
        const double *at = x + 3 * (size_t)(id ? id[k] : k);
        if (!in_range(grid, at))
            return context_fail(
                context, PDYN_DIVERGED,
                "point %d is at (%g, %g, %g): the simulation has diverged or something "
                "left the scene",
                id ? id[k] : k, at[0], at[1], at[2]);
        int cell[3];
        cell_of(grid, at, cell);
        grid->bucket[k] = grid_bucket(grid, grid_key(cell[0], cell[1], cell[2]));
        if (grid->bucket[k] + 1 < grid->buckets) end[grid->bucket[k] + 1]++;
    }
    for (int b = 1; b < grid->buckets; b++) end[b] += end[b - 1];
    for (int k = 0; k < points; k++) {
        int source = id ? id[k] : k, slot = end[grid->bucket[k]]++;
        grid->id[slot] = source;
        for (int a = 0; a < 3; a++) grid->x[a][slot] = x[3 * (size_t)source + a];
    }
    return PDYN_OK;
}

void grid_around(const struct grid *grid, const double *at, struct grid_cells *cells) {
    int cell[3];
    cell_of(grid, at, cell);
    uint64_t middle = grid_key(cell[0], cell[1], cell[2]);
    if (cells->key == middle) return;
    cells->key = middle, cells->count = 0;
    for (int n = 0; n < 27; n++) {
        int bucket = grid_bucket(
            grid, grid_key(cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1));
        int first = grid->start[bucket], last = grid->start[bucket + 1];
        bool known = first == last;
        for (int k = 0; k < cells->count; k++) known |= cells->first[k] == first;
        if (known) continue;
        cells->first[cells->count] = first, cells->last[cells->count++] = last;
    }
}

/* Every candidate is written and only the good ones stay: no branch to guess wrong. */
WIDE static int query(const struct grid *grid, const struct grid_cells *cells, const double *at,
                      double radius, int self, const bool *keep, int *list, int room) {
    enum { CHUNK = 32 };
    double squared[CHUNK], x = at[0], y = at[1], z = at[2];
    int found = 0;
    for (int c = 0; c < cells->count; c++)
        for (int first = cells->first[c]; first < cells->last[c]; first += CHUNK) {
            int count = cells->last[c] - first < CHUNK ? cells->last[c] - first : CHUNK;
            for (int k = 0; k < count; k++) {
                double dx = grid->x[0][first + k] - x, dy = grid->x[1][first + k] - y,
                       dz = grid->x[2][first + k] - z;
                squared[k] = dx * dx + dy * dy + dz * dz;
            }
            for (int k = 0; k < count; k++) {
                int id = grid->id[first + k];
                list[found < room ? found : room] = id;
                found += (squared[k] < radius * radius) & (id != self) & (!keep || keep[id]);
            }
        }
    return found;
}

int grid_query(const struct grid *grid, const struct grid_cells *cells, const double *at,
               double radius, int self, const bool *keep, int *list, int room) {
    return query(grid, cells, at, radius, self, keep, list, room);
}
