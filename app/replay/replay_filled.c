/* How densely the particles of a fluid surround each of them. The density in the files counts walls
 * as well, beside which a lone particle looks like one in the middle of the fluid.
 *
 *     filled_i = sum over j of (1 - d_ij^2 / (4 r)^2)^3 / 5.16
 *
 * j = i is in the sum; r is the particle radius. The value is 1 in a cubic lattice of spacing 2 r
 * and 0.19 for a lone particle. */
#include "replay_filled.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

static const double lattice_sum = 5.16;

/* Particles by cubic cells of side 4 r, in buckets of a hash table; -1 ends a list. */
struct cells {
    int64_t (*cell)[3]; /* of each particle */
    int *next, *first;  /* next: particle in the same bucket; first: of each bucket */
    uint64_t mask;      /* number of buckets, a power of two, less 1 */
};

static uint64_t find_bucket(const struct cells *cells, const int64_t c[3]) {
    uint64_t hash = (uint64_t)c[0] * 73856093U ^ (uint64_t)c[1] * 19349663U;
    return (hash ^ (uint64_t)c[2] * 83492791U) & cells->mask;
}

static bool make_cells(struct cells *cells, const struct vtk_frame *frame, double side) {
    size_t buckets = 1, count = (size_t)frame->count;
    while (buckets < 2 * count) buckets *= 2;
    *cells = (struct cells){.cell = calloc(count + 1, sizeof *cells->cell),
                            .next = calloc(count + 1, sizeof *cells->next),
                            .first = calloc(buckets, sizeof *cells->first),
                            .mask = buckets - 1};
    if (!cells->cell || !cells->next || !cells->first) return false;
    for (size_t b = 0; b < buckets; b++) cells->first[b] = -1;
    for (int i = 0; i < frame->count; i++) {
        for (int k = 0; k < 3; k++) /* out of range only in a run that has failed */
            cells->cell[i][k] = (int64_t)fmin(1e15, fmax(-1e15, floor(frame->x[3 * i + k] / side)));
        uint64_t bucket = find_bucket(cells, cells->cell[i]);
        cells->next[i] = cells->first[bucket];
        cells->first[bucket] = i;
    }
    return true;
}

/* Sum over the particles of one cell for particle i. */
static double sum_cell(const struct cells *cells, const struct vtk_frame *frame, int i,
                       const int64_t c[3], double side) {
    double sum = 0.0;
    for (int j = cells->first[find_bucket(cells, c)]; j >= 0; j = cells->next[j]) {
        const int64_t *own = cells->cell[j];
        if (own[0] != c[0] || own[1] != c[1] || own[2] != c[2]) continue;
        double rest = side * side;
        for (int k = 0; k < 3; k++) {
            double d = (double)frame->x[3 * i + k] - frame->x[3 * j + k];
            rest -= d * d;
        }
        if (rest > 0.0) sum += rest * rest * rest;
    }
    return sum;
}

double *replay_find_filled(const struct vtk_frame *frame, double radius) {
    struct cells cells;
    double side = 4.0 * radius, *filled = calloc((size_t)frame->count + 1, sizeof *filled);
    bool good = make_cells(&cells, frame, side) && filled;
    for (int i = 0; i < frame->count && good; i++) {
        double sum = 0.0;
        for (int n = 0; n < 27; n++) {
            const int64_t *own = cells.cell[i];
            int64_t c[3] = {own[0] + n % 3 - 1, own[1] + n / 3 % 3 - 1, own[2] + n / 9 - 1};
            sum += sum_cell(&cells, frame, i, c, side);
        }
        filled[i] = fmin(1.0, sum / pow(side, 6.0) / lattice_sum);
    }
    free(cells.cell);
    free(cells.next);
    free(cells.first);
    if (good) return filled;
    free(filled);
    return NULL;
}
