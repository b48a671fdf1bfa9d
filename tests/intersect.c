#include "intersect.h"

#include "contact/contact_parts.h"

#include "projdyn/vec3.h"

#include <stdlib.h>
#include <string.h>

struct soup soup_of(const pdyn_sim *sim) {
    struct soup s = {0};
    for (int b = 0; b < sim->bodies; b++)
        if (sim->body[b].triangles)
            s.points += sim->body[b].count, s.triangles += sim->body[b].triangles;
    s.free = s.triangles;
    int solids = s.points, at = 0;
    for (int k = 0; k < sim->scene.solids; k++) {
        s.points += sim->scene.solid[k].mesh.vertices;
        s.triangles += sim->scene.solid[k].mesh.triangles;
    }
    s.x = malloc(3 * (size_t)s.points * sizeof *s.x);
    s.triangle = malloc(3 * (size_t)s.triangles * sizeof *s.triangle);
    if (!s.x || !s.triangle) abort();
    int *triangle = s.triangle;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body->triangles) continue;
        memcpy(s.x + 3 * at, sim->x + 3 * body->first, 3 * (size_t)body->count * sizeof *s.x);
        for (int k = 0; k < 3 * body->triangles; k++) *triangle++ = at + body->triangle[k];
        at += body->count;
    }
    memcpy(s.x + 3 * solids, sim->objective.contact->at + 3 * solids,
           3 * (size_t)(s.points - solids) * sizeof *s.x);
    for (int k = 0; k < sim->scene.solids; k++) {
        const struct mesh *mesh = &sim->scene.solid[k].mesh;
        for (int m = 0; m < 3 * mesh->triangles; m++) *triangle++ = at + mesh->triangle[m];
        at += mesh->vertices;
    }
    return s;
}

void soup_free(struct soup *soup) {
    free(soup->x), free(soup->triangle);
    *soup = (struct soup){0};
}

/* True if the segment and the triangle are separated along an axis by more than rounding errors. */
static bool separates(const double *axis, const double *const segment[2],
                      const double *const triangle[3]) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, size = 0.0;
    for (int k = 0; k < 5; k++) {
        double d[3], at;
        for (int a = 0; a < 3; a++)
            d[a] = (k < 2 ? segment[k] : triangle[k - 2])[a] - segment[0][a];
        at = vec3_dot(axis, d);
        low[k < 2] = fmin(low[k < 2], at), high[k < 2] = fmax(high[k < 2], at);
        size = fmax(size, vec3_length(d));
    }
    double rounding = 1e-14 * vec3_length(axis) * size;
    return low[0] - high[1] > rounding || low[1] - high[0] > rounding;
}

/* True if a face normal of the Minkowski difference separates them: the triangle's normal, and one
 * for each pair of a side and the segment. For a segment in the triangle's plane, the normals of
 * the sides and of the segment within the plane. */
static bool apart(const double *const segment[2], const double *const triangle[3]) {
    double d[3], side[3][3], normal[3], axis[3];
    for (int a = 0; a < 3; a++) {
        d[a] = segment[1][a] - segment[0][a];
        for (int k = 0; k < 3; k++) side[k][a] = triangle[(k + 1) % 3][a] - triangle[k][a];
    }
    vec3_cross(normal, side[0], side[1]);
    if (separates(normal, segment, triangle)) return true;
    for (int k = 0; k < 3; k++) {
        vec3_cross(axis, d, side[k]);
        if (separates(axis, segment, triangle)) return true;
        vec3_cross(axis, normal, side[k]);
        if (separates(axis, segment, triangle)) return true;
    }
    vec3_cross(axis, normal, d);
    return separates(axis, segment, triangle);
}

/* True if a side of triangle a meets triangle b. Sides that share a corner with b are left out. */
static bool side_passes(const struct soup *s, int one, int other) {
    const int *p = s->triangle + 3 * one, *q = s->triangle + 3 * other;
    const double *face[3] = {s->x + 3 * q[0], s->x + 3 * q[1], s->x + 3 * q[2]};
    for (int k = 0; k < 3; k++) {
        int i = p[k], j = p[(k + 1) % 3];
        const double *segment[2] = {s->x + 3 * i, s->x + 3 * j};
        if (i == q[0] || i == q[1] || i == q[2] || j == q[0] || j == q[1] || j == q[2]) continue;
        if (!apart(segment, face)) return true;
    }
    return false;
}

struct span { /* of a triangle */
    double min[3], max[3];
    int triangle;
};

static int compare_spans(const void *a, const void *b) {
    const struct span *p = a, *q = b;
    return (p->min[0] > q->min[0]) - (p->min[0] < q->min[0]);
}

static struct span *sorted_spans(const struct soup *s) {
    struct span *span = malloc((size_t)s->triangles * sizeof *span);
    if (!span) abort();
    for (int t = 0; t < s->triangles; t++) {
        span[t].triangle = t;
        for (int a = 0; a < 3; a++) {
            double c[3];
            for (int k = 0; k < 3; k++) c[k] = s->x[3 * s->triangle[3 * t + k] + a];
            span[t].min[a] = fmin(c[0], fmin(c[1], c[2]));
            span[t].max[a] = fmax(c[0], fmax(c[1], c[2]));
        }
    }
    qsort(span, (size_t)s->triangles, sizeof *span, compare_spans);
    return span;
}

int soup_intersections(const struct soup *s, int *a, int *b) {
    struct span *span = sorted_spans(s);
    int count = 0;
    for (int i = 0; i < s->triangles; i++)
        for (int j = i + 1; j < s->triangles && span[j].min[0] <= span[i].max[0]; j++) {
            int p = span[i].triangle, q = span[j].triangle;
            if (p >= s->free && q >= s->free) continue;
            if (span[i].min[1] > span[j].max[1] || span[j].min[1] > span[i].max[1]) continue;
            if (span[i].min[2] > span[j].max[2] || span[j].min[2] > span[i].max[2]) continue;
            if (!side_passes(s, p, q) && !side_passes(s, q, p)) continue;
            if (!count++) *a = p, *b = q;
        }
    free(span);
    return count;
}
