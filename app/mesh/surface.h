/* The surface of a fluid as a closed triangle mesh: every edge has two triangles, which face out of
 * the fluid. */
#ifndef MESH_SURFACE_H
#define MESH_SURFACE_H

#include "colour_field.h"
#include "obstacles.h"

#include <limits.h>

struct surface {
    int vertices, triangles;
    int particles;        /* of the fluid */
    float *x;             /* vertices x 3, m */
    float *velocity;      /* vertices x 3, m/s: mean of the particles nearby, by kernel */
    float *normal;        /* vertices x 3, unit vectors */
    int *triangle;        /* triangles x 3 */
    int *closest;         /* vertices: the particle next to it, an index of the colour field */
    unsigned char *walls; /* vertices: number of obstacles that it was moved to, 0 to 3 */
    float *mobility;      /* vertices: how far smoothing moves it, 0 to 1; 0 in drops */
};

/* Largest number of vertices or triangles: 3 times it fits int. */
#define SURFACE_MOST (INT_MAX / 3)

/* The gap between surface and obstacle, in particle radii: room for the edges between vertices, and
 * for a renderer that cannot tell two surfaces at one place apart. */
#define SURFACE_GAP 0.03

/* The functions below that return int return an exit code, after a message unless it is EXIT_GOOD.
 */

/* Makes room in x and triangle. EXIT_FAILED: more than SURFACE_MOST, or no memory. */
int surface_resize(struct surface *surface, long vertices, long triangles);

/* Marching cubes on the samples of a colour field. Makes x and triangle; the caller frees the
 * surface in any case. */
int surface_extract(const struct colour_field *field, int threads, struct surface *out);

/* Adds a ball for each particle without neighbours; the samples do not have these. */
int surface_add_drops(struct surface *surface, const struct colour_field *field);

/* Makes velocity, closest and mobility from the particles around each vertex. */
int surface_sample(struct surface *surface, const struct colour_field *field, int threads);

/* Smooths x without shrinking (Taubin 1995), each vertex by its mobility, 0 to 1. line: only the
 * vertices on a line, each with those of its neighbours on a line; NULL: all. */
int surface_smooth(struct surface *surface, const bool *line, const float *mobility, int passes,
                   int threads);

/* Moves vertices beyond an obstacle back to it, and those at most `reach`, m, before one to it. A
 * vertex is beyond an obstacle if a triangle of it lies between the vertex and the closest
 * particle. */
void surface_attach(struct surface *surface, const struct colour_field *field,
                    const struct obstacles *obstacles, double reach, int threads);

/* Makes walls: moves vertices at rounded edges to the obstacles within `reach`, m, along their
 * normals, up to a gap, m. */
int surface_sharpen(struct surface *surface, const struct obstacles *obstacles, double reach,
                    double gap, int threads);

/* Makes normal: mean of the triangles around a vertex, by area, and of the gradient of the field
 * where smoothing did not move the vertex. */
int surface_make_normals(struct surface *surface, const struct colour_field *field, int threads);

/* Enclosed volume, m^3. */
double surface_volume(const struct surface *surface);

void surface_free(struct surface *surface);

#endif
