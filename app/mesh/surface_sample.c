/* What the particles around a vertex of a surface give it: a velocity, a side, and mobility. */
#include "app.h"
#include "parallel.h"
#include "projdyn/vec3.h"
#include "surface.h"

#include <math.h>
#include <stdlib.h>

enum { GRAIN = 1024 };

/* Density sums, in particles per spacing^3 (0.5 at a flat surface, 0.2 at a drop of one particle),
 * up to which a vertex rests and from which on it is smoothed fully. */
static const double drop_sum = 0.3, flat_sum = 0.42;

struct sampling {
    struct surface *surface;
    const struct colour_field *field;
};

static void sample_vertex(const struct sampling *s, int vertex) {
    const struct colour_field *field = s->field;
    const float *x = s->surface->x + 3 * (size_t)vertex;
    const double point[3] = {(double)x[0], (double)x[1], (double)x[2]};
    double sum = 0.0, v[3] = {0}, best = INFINITY;
    int at[3];
    colour_bin(field, point, at);
    struct colour_rows rows = colour_rows_around(field, at);
    for (int r = 0; r < 9; r++)
        for (int j = rows.first[r]; j < rows.last[r]; j++) {
            double d[3];
            for (int a = 0; a < 3; a++)
                d[a] = point[a] - (double)field->x[3 * (size_t)j + (size_t)a];
            double r2 = vec3_dot(d, d), w = colour_kernel(field, r2);
            if (r2 < best) best = r2, s->surface->closest[vertex] = j;
            sum += w;
            for (int a = 0; a < 3; a++) v[a] += w * (double)field->v[3 * (size_t)j + (size_t)a];
        }
    for (int a = 0; a < 3; a++)
        s->surface->velocity[3 * (size_t)vertex + (size_t)a] = (float)(v[a] / sum);
    double mobility = (sum * COLOUR_SUM_SCALE - drop_sum) / (flat_sum - drop_sum);
    s->surface->mobility[vertex] = (float)fmin(1.0, fmax(0.0, mobility));
}

static void sample_vertices(void *self, int first, int last) {
    for (int v = first; v < last; v++) sample_vertex(self, v);
}

int surface_sample(struct surface *surface, const struct colour_field *field, int threads) {
    struct sampling sampling = {surface, field};
    size_t n = (size_t)surface->vertices + 1;
    surface->velocity = malloc(3 * n * sizeof *surface->velocity);
    surface->closest = malloc(n * sizeof *surface->closest);
    surface->mobility = malloc(n * sizeof *surface->mobility);
    if (!surface->velocity || !surface->closest || !surface->mobility) return report_no_memory();
    parallel_for(threads, surface->vertices, GRAIN, sample_vertices, &sampling);
    return EXIT_GOOD;
}
