#include "fluid_walls.h"

#include "fluid_pairs.h"

static const double settled_share = 0.085;
static const double give_way = 0.01; /* of the way to it, in a step */

/* ---- memory ---------------------------------------------------------------------------------- */

static bool create(struct fluid *f, size_t boundary) {
    struct fluid_walls *w = &f->walls;
    w->start = fluid_resize(f, NULL, 0, boundary + 2, sizeof *w->start);
    w->share = fluid_resize(f, NULL, 0, boundary, sizeof *w->share);
    w->seen = fluid_resize(f, NULL, 0, boundary, sizeof *w->seen);
    return w->start && (!boundary || (w->share && w->seen));
}

static bool reserve(struct fluid *f, size_t neighbours) {
    struct fluid_walls *w = &f->walls;
    if (neighbours <= w->capacity) return true;
    fluid_resize(f, w->particle, w->capacity, 0, sizeof *w->particle);
    w->capacity =
        neighbours + neighbours / 4; /* room, so that a warmed-up step allocates nothing */
    w->particle = fluid_resize(f, NULL, 0, w->capacity, sizeof *w->particle);
    return w->particle;
}

void fluid_walls_free(struct fluid *f) {
    struct fluid_walls *w = &f->walls;
    size_t boundary = (size_t)(f->points - f->particles);
    fluid_resize(f, w->start, boundary + 2, 0, sizeof *w->start);
    fluid_resize(f, w->share, boundary, 0, sizeof *w->share);
    fluid_resize(f, w->seen, boundary, 0, sizeof *w->seen);
    fluid_resize(f, w->particle, w->capacity, 0, sizeof *w->particle);
}

/* ---- neighbours ------------------------------------------------------------------------------ */

/* place[b], the entry after start[b]: first counts those before b, then runs from the first place
 * of b to the one after its last. */
bool fluid_walls_neighbours(struct fluid *f) {
    const pdyn_neighbours *l = f->lists;
    struct fluid_walls *w = &f->walls;
    int boundary = f->points - f->particles;
    if (!w->start && !create(f, (size_t)boundary)) return false;
    int *place = w->start + 1;
    memset(w->start, 0, ((size_t)boundary + 2) * sizeof *w->start);
    for (int i = f->first; i < f->first + f->count; i++)
        for (int s = l->boundary_start[i]; s < l->end[i]; s++)
            place[1 + l->index[s] - f->particles]++;
    for (int b = 0; b < boundary; b++) place[b + 1] += place[b];
    if (!reserve(f, (size_t)place[boundary])) return false;
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

void fluid_walls_persist(struct fluid *f, pdyn_archive *archive) {
    size_t boundary = (size_t)(f->points - f->particles);
    if (boundary) archive->bytes(archive, f->walls.share, boundary * sizeof *f->walls.share);
}

void fluid_walls_settle(struct fluid *f) {
    struct fluid_walls *w = &f->walls;
    for (int b = 0; b < f->points - f->particles; b++) {
        double room = fmax(0.0, fmin(w->share[b], w->seen[b]) - settled_share);
        w->share[b] = settled_share + (1.0 - give_way) * room;
    }
}
