/* Sharp edges where the surface of the water meets walls, and where it lies in a corner between
 * walls. Smoothing rounds them. A vertex at a rounded edge moves along its normal to the wall, then
 * along the part of the normal that is parallel to this wall to the next one, and so on:
 *
 *      | .-- water      |.--- water
 *      |/               |
 *      (                |
 *      |\               |
 *      | '--            |'---
 */
#include "app.h"
#include "parallel.h"
#include "projdyn/vec3.h"
#include "surface.h"

#include <math.h>
#include <stdlib.h>

enum { GRAIN = 1024, WALLS = 3 };

struct sharpening {
    struct surface *surface;
    const struct obstacles *obstacles;
    double reach, gap; /* m */
};

/* Moves x up to the gap before the first obstacle that the ray along a unit vector meets within
 * reach, perpendicular to that obstacle. wall: its normal. Returns whether there is one. */
static bool move_to_wall(const struct sharpening *s, double x[3], const double way[3],
                         double wall[3]) {
    double end[3];
    int triangle;
    for (int a = 0; a < 3; a++) end[a] = x[a] + s->reach * way[a];
    double part = obstacles_cross(s->obstacles, x, end, &triangle);
    if (part > 1.0) return false;
    obstacles_normal(s->obstacles, triangle, wall);
    double away = part * s->reach * vec3_dot(way, wall);
    vec3_add(x, away - copysign(s->gap, away), wall);
    return true;
}

static void sharpen_vertex(const struct sharpening *s, int v) {
    float *at = s->surface->x + 3 * (size_t)v, *normal = s->surface->normal + 3 * (size_t)v;
    double x[3], way[3], wall[3];
    for (int a = 0; a < 3; a++) x[a] = (double)at[a], way[a] = (double)normal[a];
    for (int k = 0; k < WALLS && move_to_wall(s, x, way, wall); k++) {
        s->surface->walls[v]++;
        vec3_add(way, -vec3_dot(way, wall), wall);
        double length = vec3_length(way);
        if (length < 0.3) break;
        for (int a = 0; a < 3; a++) way[a] /= length;
    }
    for (int a = 0; a < 3; a++) at[a] = (float)x[a];
}

static void sharpen_vertices(void *self, int first, int last) {
    for (int v = first; v < last; v++) sharpen_vertex(self, v);
}

/* ---- the line where surface and obstacles meet ----------------------------------------------- */

enum { PASSES = 10 };

/* Marks the vertices of the line: those at obstacles that share a triangle with others. */
static void mark_line(const struct surface *surface, bool *line) {
    for (int t = 0; t < surface->triangles; t++) {
        const int *v = surface->triangle + 3 * (size_t)t;
        int attached = 0;
        for (int c = 0; c < 3; c++) attached += surface->walls[v[c]] > 0;
        for (int c = 0; c < 3 && attached < 3; c++) line[v[c]] |= surface->walls[v[c]] > 0;
    }
}

/* Vertices at two walls stay: smoothing would round the corner of the line there. */
static int smooth_lines(struct surface *surface, int threads) {
    size_t n = (size_t)surface->vertices + 1;
    bool *line = calloc(n, sizeof *line);
    float *mobility = malloc(n * sizeof *mobility);
    int code = line && mobility ? EXIT_GOOD : report_no_memory();
    if (code == EXIT_GOOD) {
        mark_line(surface, line);
        for (int v = 0; v < surface->vertices; v++) mobility[v] = surface->walls[v] < 2;
        code = surface_smooth(surface, line, mobility, PASSES, threads);
    }
    free(line), free(mobility);
    return code;
}

int surface_sharpen(struct surface *surface, const struct obstacles *obstacles, double reach,
                    double gap, int threads) {
    struct sharpening s = {surface, obstacles, reach, gap};
    surface->walls = calloc((size_t)surface->vertices + 1, sizeof *surface->walls);
    if (!surface->walls) return report_no_memory();
    parallel_for(threads, surface->vertices, GRAIN, sharpen_vertices, &s);
    return smooth_lines(surface, threads);
}
