/* Attaches vertices of the surface of the water to sheets, bodies and solids beside it. */
#include "parallel.h"
#include "projdyn/vec3.h"
#include "surface.h"

#include <math.h>

enum { GRAIN = 1024 };

struct attachment {
    struct surface *surface;
    const struct colour_field *field;
    const struct obstacles *obstacles;
    double reach; /* m */
};

/* Moves a vertex to a small gap before the first obstacle on the line from particle p to it and
 * `reach` beyond it. */
static void attach_vertex(const struct attachment *s, const float *p, float *vertex) {
    double from[3], way[3], end[3], gap = SURFACE_GAP * s->field->cell;
    for (int a = 0; a < 3; a++) from[a] = (double)p[a], way[a] = (double)vertex[a] - from[a];
    double length = vec3_length(way);
    if (!(length > 0.0)) return;
    double reach = length + s->reach + gap;
    for (int a = 0; a < 3; a++) end[a] = from[a] + way[a] / length * reach;
    double part = obstacles_cross(s->obstacles, from, end, NULL);
    if (part > 1.0) return;
    double kept = fmax(0.0, part * reach - gap);
    for (int a = 0; a < 3; a++) vertex[a] = (float)(from[a] + way[a] / length * kept);
}

static void attach_vertices(void *self, int first, int last) {
    const struct attachment *s = self;
    for (int v = first; v < last; v++) {
        const float *p = s->field->x + 3 * (size_t)s->surface->closest[v];
        attach_vertex(s, p, s->surface->x + 3 * (size_t)v);
    }
}

void surface_attach(struct surface *surface, const struct colour_field *field,
                    const struct obstacles *obstacles, double reach, int threads) {
    struct attachment attachment = {surface, field, obstacles, reach};
    parallel_for(threads, surface->vertices, GRAIN, attach_vertices, &attachment);
}
