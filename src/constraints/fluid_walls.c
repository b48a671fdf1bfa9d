#include "fluid_walls.h"

#include "fluid_pairs.h"

static const double settled_share = 0.085;
static const double give_way = 0.01; /* of the way to it, in a step */

/* ---- memory ---------------------------------------------------------------------------------- */

static void *resize(struct fluid *f, void *block, int from, int to, size_t size) {
    return f->services->allocate(f->services->core, block, (size_t)from * size, (size_t)to * size);
}

static bool create(struct fluid *f, int boundary) {
    struct fluid_walls *w = &f->walls;
    w->start = resize(f, NULL, 0, boundary + 2, sizeof *w->start);
    w->share = resize(f, NULL, 0, boundary, sizeof *w->share);
    w->seen = resize(f, NULL, 0, boundary, sizeof *w->seen);
    return w->start && (!boundary || (w->share && w->seen));
}

static bool reserve(struct fluid *f, int neighbours) {
    struct fluid_walls *w = &f->walls;
    if (neighbours <= w->capacity) return true;
    resize(f, w->particle, w->capacity, 0, sizeof *w->particle);
    w->capacity =
        neighbours + neighbours / 4; /* room, so that a warmed-up step allocates nothing */
    w->particle = resize(f, NULL, 0, w->capacity, sizeof *w->particle);
    return w->particle;
}

void fluid_walls_free(struct fluid *f) {
    struct fluid_walls *w = &f->walls;
    int boundary = f->points - f->particles;
    if (w->start) resize(f, w->start, boundary + 2, 0, sizeof *w->start);
    if (w->share) resize(f, w->share, boundary, 0, sizeof *w->share);
    if (w->seen) resize(f, w->seen, boundary, 0, sizeof *w->seen);
    if (w->particle) resize(f, w->particle, w->capacity, 0, sizeof *w->particle);
}

/* ---- neighbours ------------------------------------------------------------------------------ */

/* place[b], the entry after start[b]: first counts those before b, then runs from the first place
 * of b to the one after its last. */
bool fluid_walls_neighbours(struct fluid *f) {
    const pdyn_neighbours *l = f->lists;
    struct fluid_walls *w = &f->walls;
    int boundary = f->points - f->particles;
    if (!w->start && !create(f, boundary)) return false;
    int *place = w->start + 1;
    memset(w->start, 0, ((size_t)boundary + 2) * sizeof *w->start);
    for (int i = f->first; i < f->first + f->count; i++)
        for (int s = l->boundary_start[i]; s < l->end[i]; s++)
            place[1 + l->index[s] - f->particles]++;
    for (int b = 0; b < boundary; b++) place[b + 1] += place[b];
    if (!reserve(f, place[boundary])) return false;
    for (int i = f->first; i < f->first + f->count; i++)
        for (int s = l->boundary_start[i]; s < l->end[i]; s++)
            w->particle[place[l->index[s] - f->particles]++] = i;
    return true;
}

/* ---- shares ---------------------------------------------------------------------------------- */

double fluid_walls_see(struct fluid_walls *w, int b, double density) {
    w->seen[b] = density;
    if (w->share[b] == 0.0) w->share[b] = fmax(settled_share, density);
    return density - w->share[b];
}

void fluid_walls_settle(struct fluid *f) {
    struct fluid_walls *w = &f->walls;
    for (int b = 0; b < f->points - f->particles; b++) {
        double room = fmax(0.0, fmin(w->share[b], w->seen[b]) - settled_share);
        w->share[b] = settled_share + (1.0 - give_way) * room;
    }
}
