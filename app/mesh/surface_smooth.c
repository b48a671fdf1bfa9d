/* Smoothing of a surface. */
#include "app.h"
#include "parallel.h"
#include "surface.h"

#include <stdlib.h>
#include <string.h>

enum { GRAIN = 4096 };

/* Factors of the two half passes, pass band 0.04: x <- x + f m (mean of the neighbours - x). */
static const double shrink = 0.5, grow = -0.51;

/* The neighbours of each vertex. In a closed mesh each is the next corner in one triangle. */
struct ring {
    const bool *line; /* vertices: only those on a line have neighbours, those on it; NULL: all */
    int *first;       /* vertices + 1 */
    int *neighbour;   /* 3 x triangles */
};

/* The next corner after corner c in its triangle; -1: it is no neighbour. */
static int next_vertex(const struct surface *surface, const struct ring *ring, int c) {
    int vertex = surface->triangle[c], next = surface->triangle[c % 3 == 2 ? c - 2 : c + 1];
    return !ring->line || (ring->line[vertex] && ring->line[next]) ? next : -1;
}

static void fill_ring(const struct surface *surface, struct ring *ring) {
    int corners = 3 * surface->triangles;
    for (int c = 0; c < corners; c++)
        ring->first[surface->triangle[c] + 1] += next_vertex(surface, ring, c) >= 0;
    for (int v = 0; v < surface->vertices; v++) ring->first[v + 1] += ring->first[v];
    for (int c = 0; c < corners; c++) {
        int next = next_vertex(surface, ring, c);
        if (next >= 0) ring->neighbour[ring->first[surface->triangle[c]]++] = next;
    }
    for (int v = surface->vertices; v > 0; v--) ring->first[v] = ring->first[v - 1];
    ring->first[0] = 0;
}

struct half_pass {
    const struct ring *ring;
    const float *from, *mobility;
    float *to;
    double factor;
};

static void move_vertex(const struct half_pass *pass, int v, double factor) {
    const struct ring *ring = pass->ring;
    double mean[3] = {0};
    int begin = ring->first[v], end = ring->first[v + 1];
    for (int n = begin; n < end; n++)
        for (int a = 0; a < 3; a++)
            mean[a] += (double)pass->from[3 * (size_t)ring->neighbour[n] + (size_t)a];
    for (int a = 0; a < 3; a++) {
        double x = (double)pass->from[3 * (size_t)v + (size_t)a];
        pass->to[3 * (size_t)v + (size_t)a] = (float)(x + factor * (mean[a] / (end - begin) - x));
    }
}

static void run_half_pass(void *self, int first, int last) {
    const struct half_pass *pass = self;
    for (int v = first; v < last; v++) {
        double mobility = (double)pass->mobility[v];
        bool moves = mobility > 0.0 && pass->ring->first[v + 1] - pass->ring->first[v] > 1;
        if (moves) move_vertex(pass, v, mobility * pass->factor);
        else memcpy(pass->to + 3 * (size_t)v, pass->from + 3 * (size_t)v, 3 * sizeof(float));
    }
}

int surface_smooth(struct surface *surface, const bool *line, const float *mobility, int passes,
                   int threads) {
    size_t n = (size_t)surface->vertices;
    struct ring ring = {line, calloc(n + 2, sizeof *ring.first),
                        malloc((3 * (size_t)surface->triangles + 1) * sizeof *ring.neighbour)};
    float *other = malloc((3 * n + 1) * sizeof *other);
    bool good = ring.first && ring.neighbour && other;
    if (good) fill_ring(surface, &ring);
    for (int p = 0; good && p < passes; p++) {
        struct half_pass there = {&ring, surface->x, mobility, other, shrink};
        struct half_pass back = {&ring, other, mobility, surface->x, grow};
        parallel_for(threads, surface->vertices, GRAIN, run_half_pass, &there);
        parallel_for(threads, surface->vertices, GRAIN, run_half_pass, &back);
    }
    free(ring.first), free(ring.neighbour), free(other);
    return good ? EXIT_GOOD : report_no_memory();
}
