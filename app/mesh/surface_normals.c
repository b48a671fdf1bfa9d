/* Normals and volume of a surface. */
#include "app.h"
#include "parallel.h"
#include "projdyn/vec3.h"
#include "surface.h"

#include <math.h>
#include <stdlib.h>

enum { GRAIN = 1024 };

/* The normal of a triangle, twice its area long. */
static void triangle_normal(const struct surface *surface, int t, double n[3]) {
    const int *corner = surface->triangle + 3 * (size_t)t;
    double p[3], q[3];
    for (int a = 0; a < 3; a++) {
        double x = (double)surface->x[3 * (size_t)corner[0] + (size_t)a];
        p[a] = (double)surface->x[3 * (size_t)corner[1] + (size_t)a] - x;
        q[a] = (double)surface->x[3 * (size_t)corner[2] + (size_t)a] - x;
    }
    vec3_cross(n, p, q);
}

/* Sums of the area vectors of the triangles around each vertex. */
static void add_triangle_normals(struct surface *surface) {
    for (int t = 0; t < surface->triangles; t++) {
        const int *corner = surface->triangle + 3 * (size_t)t;
        double n[3];
        triangle_normal(surface, t, n);
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++)
                surface->normal[3 * (size_t)corner[c] + (size_t)a] += (float)n[a];
    }
}

/* Unit vector along - grad phi at a vertex; 0 far from all particles. */
static void descend_field(const struct colour_field *field, const float *x, double n[3]) {
    const double point[3] = {(double)x[0], (double)x[1], (double)x[2]};
    double sum[3] = {0}, d[3];
    int at[3];
    colour_bin(field, point, at);
    struct colour_rows rows = colour_rows_around(field, at);
    for (int r = 0; r < 9; r++)
        for (int j = rows.first[r]; j < rows.last[r]; j++) {
            for (int a = 0; a < 3; a++)
                d[a] = point[a] - (double)field->x[3 * (size_t)j + (size_t)a];
            double rest = fmax(0.0, 1.0 - vec3_dot(d, d) / (field->support * field->support));
            vec3_add(sum, (double)field->weight[j] * rest * rest * rest * rest, d);
        }
    double length = vec3_length(sum);
    for (int a = 0; a < 3; a++) n[a] = length > 0.0 ? sum[a] / length : 0.0;
}

struct normals {
    struct surface *surface;
    const struct colour_field *field;
};

static void finish_normals(void *self, int first, int last) {
    const struct normals *s = self;
    for (int v = first; v < last; v++) {
        float *normal = s->surface->normal + 3 * (size_t)v;
        double n[3] = {(double)normal[0], (double)normal[1], (double)normal[2]}, field[3];
        double mobility = (double)s->surface->mobility[v], length = vec3_length(n);
        for (int a = 0; a < 3 && length > 0.0; a++) n[a] /= length;
        if (mobility < 1.0) {
            descend_field(s->field, s->surface->x + 3 * (size_t)v, field);
            vec3_add(n, 1.0 - mobility, field);
            vec3_normalise(n);
        }
        for (int a = 0; a < 3; a++) normal[a] = (float)n[a];
    }
}

int surface_make_normals(struct surface *surface, const struct colour_field *field, int threads) {
    struct normals normals = {surface, field};
    free(surface->normal);
    surface->normal = calloc(3 * (size_t)surface->vertices + 1, sizeof *surface->normal);
    if (!surface->normal) return report_no_memory();
    add_triangle_normals(surface);
    parallel_for(threads, surface->vertices, GRAIN, finish_normals, &normals);
    return EXIT_GOOD;
}

/* The sum of the tetrahedra between the triangles and the first vertex. */
double surface_volume(const struct surface *surface) {
    double sum = 0.0;
    for (int t = 0; t < surface->triangles; t++) {
        const float *x = surface->x + 3 * (size_t)surface->triangle[3 * (size_t)t];
        double n[3];
        triangle_normal(surface, t, n);
        for (int a = 0; a < 3; a++) sum += ((double)x[a] - (double)surface->x[a]) * n[a];
    }
    return sum / 6.0;
}
