/* Drops of one particle: a particle without neighbours is a ball of 42 vertices, the icosahedron
 * divided once, with the volume of the particle. The grid of samples is too coarse for it. */
#include "app.h"
#include "projdyn/vec3.h"
#include "surface.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 12, BALL_VERTICES = 42, BALL_TRIANGLES = 80 };

struct ball {
    int vertices, triangles;
    double x[BALL_VERTICES][3];
    int triangle[BALL_TRIANGLES][3];
};

static double determinant(const double a[3], const double b[3], const double c[3]) {
    double normal[3];
    vec3_cross(normal, b, c);
    return vec3_dot(a, normal);
}

/* The corners of an icosahedron in a ball of radius 1: cyclic permutations of (0, +-1, +-g). */
static void make_corners(struct ball *ball) {
    const double g = 0.5 * (1.0 + sqrt(5.0)), scale = 1.0 / sqrt(1.0 + g * g);
    for (int c = 0; c < CORNERS; c++) {
        int axis = c / 4;
        ball->x[c][axis] = 0.0;
        ball->x[c][(axis + 1) % 3] = c & 1 ? scale : -scale;
        ball->x[c][(axis + 2) % 3] = c & 2 ? g * scale : -g * scale;
    }
    ball->vertices = CORNERS;
}

/* The vertex in the middle between a and b, moved to radius 1; a new one if there is none. */
static int middle_vertex(struct ball *ball, int a, int b) {
    double x[3];
    for (int k = 0; k < 3; k++) x[k] = ball->x[a][k] + ball->x[b][k];
    vec3_normalise(x);
    for (int v = CORNERS; v < ball->vertices; v++)
        if (vec3_distance(ball->x[v], x) < 1e-4) return v;
    memcpy(ball->x[ball->vertices], x, sizeof x);
    return ball->vertices++;
}

/* Divides the face of three corners into four triangles. */
static void divide_face(struct ball *ball, int a, int b, int c) {
    int ab = middle_vertex(ball, a, b), bc = middle_vertex(ball, b, c),
        ca = middle_vertex(ball, c, a);
    const int four[4][3] = {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}};
    memcpy(ball->triangle[ball->triangles], four, sizeof four);
    ball->triangles += 4;
}

/* Makes a ball of volume 1. Faces are the triples of corners at the distance of an edge. */
static void make_ball(struct ball *ball) {
    *ball = (struct ball){0};
    make_corners(ball);
    double edge = vec3_distance(ball->x[0], ball->x[1]) + 1e-9, volume = 0.0;
    for (int a = 0; a < CORNERS; a++)
        for (int b = a + 1; b < CORNERS; b++)
            for (int c = a + 1; c < CORNERS; c++)
                if (b != c && vec3_distance(ball->x[a], ball->x[b]) < edge &&
                    vec3_distance(ball->x[b], ball->x[c]) < edge &&
                    vec3_distance(ball->x[c], ball->x[a]) < edge &&
                    determinant(ball->x[a], ball->x[b], ball->x[c]) > 0.0)
                    divide_face(ball, a, b, c);
    for (int t = 0; t < BALL_TRIANGLES; t++) {
        const int *corner = ball->triangle[t];
        volume += determinant(ball->x[corner[0]], ball->x[corner[1]], ball->x[corner[2]]) / 6.0;
    }
    for (int v = 0; v < BALL_VERTICES; v++)
        for (int a = 0; a < 3; a++) ball->x[v][a] /= cbrt(volume);
}

static void add_ball(struct surface *surface, const struct ball *ball, const float *centre,
                     double spacing) {
    float *x = surface->x + 3 * (size_t)surface->vertices;
    int *triangle = surface->triangle + 3 * (size_t)surface->triangles;
    for (int k = 0; k < 3 * BALL_VERTICES; k++)
        x[k] = (float)((double)centre[k % 3] + spacing * ball->x[k / 3][k % 3]);
    for (int k = 0; k < 3 * BALL_TRIANGLES; k++)
        triangle[k] = surface->vertices + ball->triangle[k / 3][k % 3];
    surface->vertices += BALL_VERTICES, surface->triangles += BALL_TRIANGLES;
}

int surface_add_drops(struct surface *surface, const struct colour_field *field) {
    struct ball ball;
    long drops = 0;
    for (int i = 0; i < field->count; i++) drops += colour_is_alone(field, i);
    int code = surface_resize(surface, surface->vertices + BALL_VERTICES * drops,
                              surface->triangles + BALL_TRIANGLES * drops);
    if (code != EXIT_GOOD) return code;
    make_ball(&ball);
    for (int i = 0; i < field->count; i++)
        if (colour_is_alone(field, i))
            add_ball(surface, &ball, field->x + 3 * (size_t)i, 2.0 * field->cell);
    return EXIT_GOOD;
}
