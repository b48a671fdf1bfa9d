/* A tree of bounding boxes over triangles, and segments that cross these. */
#include "obstacles.h"

#include "app.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF = 4, STACK = 64 };

/* ---- building -------------------------------------------------------------------------------- */

int obstacles_add(struct obstacles *o, const struct vtk_frame *frame) {
    int need = o->count + frame->triangles;
    if (need > o->capacity) {
        struct obstacle_triangle *grown = realloc(o->triangle, (size_t)need * sizeof *grown);
        if (!grown) return report_no_memory();
        o->triangle = grown, o->capacity = need;
    }
    for (int t = 0; t < frame->triangles; t++, o->count++)
        for (int c = 0; c < 3; c++)
            memcpy(o->triangle[o->count].corner[c],
                   frame->x + 3 * (size_t)frame->triangle[3 * (size_t)t + (size_t)c],
                   3 * sizeof(float));
    return EXIT_GOOD;
}

static void bound(const struct obstacles *o, struct obstacle_node *node) {
    for (int a = 0; a < 3; a++) node->min[a] = INFINITY, node->max[a] = -INFINITY;
    for (int t = node->first; t < node->last; t++)
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++) {
                node->min[a] = fminf(node->min[a], o->triangle[t].corner[c][a]);
                node->max[a] = fmaxf(node->max[a], o->triangle[t].corner[c][a]);
            }
}

/* Three times the centre of a triangle along an axis. */
static float centre(const struct obstacle_triangle *t, int axis) {
    return t->corner[0][axis] + t->corner[1][axis] + t->corner[2][axis];
}

static int compare_x(const void *p, const void *q) {
    float a = centre(p, 0), b = centre(q, 0);
    return (a > b) - (a < b);
}
static int compare_y(const void *p, const void *q) {
    float a = centre(p, 1), b = centre(q, 1);
    return (a > b) - (a < b);
}
static int compare_z(const void *p, const void *q) {
    float a = centre(p, 2), b = centre(q, 2);
    return (a > b) - (a < b);
}

/* Makes the node of triangles first to last - 1 and its children: halves along the longest side. */
static void divide(struct obstacles *o, int first, int last) {
    static int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
    struct obstacle_node *node = &o->node[o->nodes++];
    *node = (struct obstacle_node){.first = first, .last = last};
    bound(o, node);
    if (last - first <= LEAF) return;
    int axis = 0, middle = first + (last - first) / 2;
    for (int a = 1; a < 3; a++)
        if (node->max[a] - node->min[a] > node->max[axis] - node->min[axis]) axis = a;
    qsort(o->triangle + first, (size_t)(last - first), sizeof *o->triangle, compare[axis]);
    divide(o, first, middle);
    node->right = o->nodes;
    divide(o, middle, last);
}

int obstacles_build(struct obstacles *o) {
    if (!o->count) return EXIT_GOOD;
    o->node = malloc(2 * (size_t)o->count * sizeof *o->node);
    if (!o->node) return report_no_memory();
    divide(o, 0, o->count);
    return EXIT_GOOD;
}

void obstacles_free(struct obstacles *o) {
    free(o->triangle), free(o->node);
    *o = (struct obstacles){0};
}

/* ---- crossing -------------------------------------------------------------------------------- */

static bool touches(const struct obstacle_node *node, const double p[3], const double q[3]) {
    for (int a = 0; a < 3; a++)
        if (fmin(p[a], q[a]) > (double)node->max[a] || fmax(p[a], q[a]) < (double)node->min[a])
            return false;
    return true;
}

/* Moeller and Trumbore 1997. The tolerance closes the gap between two triangles at an edge. */
static double cross_triangle(const struct obstacle_triangle *t, const double p[3],
                             const double q[3]) {
    static const double tolerance = 1e-6;
    double e[3], f[3], way[3], from[3], n[3], m[3];
    for (int a = 0; a < 3; a++) {
        e[a] = (double)t->corner[1][a] - (double)t->corner[0][a];
        f[a] = (double)t->corner[2][a] - (double)t->corner[0][a];
        way[a] = q[a] - p[a], from[a] = p[a] - (double)t->corner[0][a];
    }
    vec3_cross(n, way, f);
    vec3_cross(m, from, e);
    double scale = vec3_dot(e, n), u = vec3_dot(from, n) / scale, v = vec3_dot(way, m) / scale;
    double part = vec3_dot(f, m) / scale;
    bool hits = u >= -tolerance && v >= -tolerance && u + v <= 1.0 + tolerance && part >= 0.0 &&
                part <= 1.0; /* false for a segment in the plane, where scale is 0 */
    return hits ? part : 2.0;
}

double obstacles_cross(const struct obstacles *o, const double p[3], const double q[3],
                       int *triangle) {
    int stack[STACK], depth = 0;
    double nearest = 2.0;
    if (o->nodes) stack[depth++] = 0;
    while (depth) {
        int at = stack[--depth];
        const struct obstacle_node *node = &o->node[at];
        if (!touches(node, p, q)) continue;
        for (int t = node->first; !node->right && t < node->last; t++) {
            double part = cross_triangle(&o->triangle[t], p, q);
            if (!(part < nearest)) continue;
            nearest = part;
            if (triangle) *triangle = t;
        }
        if (node->right) stack[depth++] = at + 1, stack[depth++] = node->right;
    }
    return nearest;
}

void obstacles_normal(const struct obstacles *o, int triangle, double normal[3]) {
    double x[3][3];
    for (int k = 0; k < 9; k++)
        x[k / 3][k % 3] = (double)o->triangle[triangle].corner[k / 3][k % 3];
    vec3_normal(normal, x[0], x[1], x[2]);
    vec3_normalise(normal);
}
