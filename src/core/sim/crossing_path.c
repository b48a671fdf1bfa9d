#include "crossing_path.h"

#include "geometry/distance.h"

#include "projdyn/vec3.h"

#include <math.h>

/* The plane's corners and normal at time t of the step, 0 to 1; returns the distance of the
 * particle, times the length of the normal. */
static double plane_at(const struct crossing_path *path, int k, double t, double corner[3][3],
                       double n[3]) {
    const struct swept_surface *s = &path->swept->surface[path->set->surface[k]];
    const int *vertex = s->triangle + 3 * (size_t)path->set->triangle[k];
    double r[3];
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) {
            size_t at = 3 * (size_t)vertex[i] + (size_t)a;
            corner[i][a] = (1.0 - t) * s->begin[at] + t * s->end[at];
        }
    vec3_normal(n, corner[0], corner[1], corner[2]);
    for (int a = 0; a < 3; a++) r[a] = (1.0 - t) * path->begin[a] + t * path->end[a] - corner[0][a];
    return vec3_dot(r, n);
}

/* Width of the border of a triangle, relative to its size: above rounding. */
static const double border = 1e-6;

/* Inside or on the border: a particle that passes through the common edge of two
 * triangles passes both in the same direction, which counts once. */
static bool is_inside(const double x[3], double corner[3][3], const double n[3]) {
    for (int i = 0; i < 3; i++) {
        double side[3];
        vec3_normal(side, corner[i], corner[(i + 1) % 3], x);
        if (vec3_dot(side, n) < -border * vec3_dot(n, n)) return false;
    }
    return true;
}

struct border_search { /* for a border edge close to a point, then for what closes it */
    const struct crossing_path *path;
    int surface;
    double t;
    const double *x;
    double place[3]; /* the point of the border edge that is closest to x */
    bool found, closed;
};

static void test_border(void *user, int k) {
    struct border_search *s = user;
    const struct swept_triangles *set = s->path->set;
    const int *across = s->path->swept->surface[s->surface].across;
    double corner[3][3], n[3], weight[4];
    if (s->found || set->surface[k] != s->surface) return;
    plane_at(s->path, k, s->t, corner, n);
    for (int i = 0; i < 3 && !s->found; i++) {
        const double *a = corner[(i + 1) % 3], *b = corner[(i + 2) % 3];
        const double *side[4] = {s->x, s->x, a, b};
        if (across[3 * (size_t)set->triangle[k] + (size_t)i] >= 0) continue;
        s->found = closest_edge_edge(side, weight) < s->path->radius * s->path->radius;
        for (int axis = 0; axis < 3; axis++)
            s->place[axis] = -weight[2] * a[axis] - weight[3] * b[axis];
    }
}

/* Another surface within the particle's radius of the border closes it. */
static void test_closed(void *user, int k) {
    struct border_search *s = user;
    double corner[3][3], n[3], weight[4];
    if (s->closed || s->path->set->surface[k] == s->surface) return;
    plane_at(s->path, k, s->t, corner, n);
    const double *face[4] = {s->place, corner[0], corner[1], corner[2]};
    s->closed = closest_vertex_face(face, weight) < s->path->radius * s->path->radius;
}

static bool is_closed(struct border_search s) {
    struct box box = box_of_ball(s.place, s.path->radius);
    struct crossing_path path = *s.path;
    const struct swept_triangles *sets[] = {&path.swept->resting, &path.swept->moving};
    for (int k = 0; k < 2; k++) {
        path.set = sets[k], s.path = &path;
        bvh_visit(&path.set->tree, &box, test_closed, &s);
    }
    return s.closed;
}

/* Closer to the border of the surface than the particle's radius: the particle goes around. The
 * border edge may belong to another triangle than k. The border of a solid that another surface
 * closes, as that of a wall on a floor, is none. */
static bool is_on_border(const struct crossing_path *path, int k, double t, const double x[3]) {
    struct border_search s = {.path = path, .surface = path->set->surface[k], .t = t, .x = x};
    struct box box = box_of_ball(x, path->radius);
    bvh_visit(&path->set->tree, &box, test_border, &s);
    return s.found && !(path->swept->surface[s.surface].is_solid && is_closed(s));
}

/* The direction in which a particle passes a plane, +1 along its normal; 0: it does not. slack and
 * distances at the two ends of the step: times the length of the normal. */
static int direction_of(double begin, double end, double slack) {
    if (begin > -slack && end <= -slack) return -1;
    return begin <= slack && end > slack;
}

/* Cuts the step into parts in which the distance only rises or only falls. It is a cubic of time,
 * as the plane turns. Returns the number of cuts: the first is 0, the last is 1. */
static int cut_step(const struct crossing_path *path, int k, double cut[4]) {
    double corner[3][3], n[3], f[4];
    for (int i = 0; i < 4; i++) f[i] = plane_at(path, k, i / 3.0, corner, n);
    /* By differences: the derivative is a u^2 + b u + c with u = 3 t. */
    double d1 = f[1] - f[0], d2 = f[2] - 2.0 * f[1] + f[0], d3 = f[3] - f[0] + 3.0 * (f[1] - f[2]);
    double a = 0.5 * d3, b = d2 - d3, c = d1 - 0.5 * d2 + d3 / 3.0;
    double q = -0.5 * (b + copysign(sqrt(fmax(0.0, b * b - 4.0 * a * c)), b));
    double t[2] = {fmin(q / a, c / q) / 3.0, fmax(q / a, c / q) / 3.0};
    int count = 0;
    cut[count++] = 0.0;
    for (int i = 0; i < 2; i++)
        if (t[i] > cut[count - 1] && t[i] < 1.0) cut[count++] = t[i];
    cut[count++] = 1.0;
    return count;
}

enum { HALVINGS = 40 };

/* Tests a part of the step, in which the particle passes the plane at most once: bisection. */
static void test_part(struct crossing_path *path, int k, double from, double to) {
    double corner[3][3], n[3], x[3];
    int surface = path->set->surface[k];
    double begin = plane_at(path, k, from, corner, n), end = plane_at(path, k, to, corner, n);
    double slack = path->slack * vec3_length(n);
    int direction = direction_of(begin, end, slack);
    if (!direction) return;
    for (int round = 0; round < HALVINGS; round++) {
        double t = 0.5 * (from + to);
        if (direction * plane_at(path, k, t, corner, n) > slack) to = t;
        else from = t;
    }
    plane_at(path, k, to, corner, n);
    for (int a = 0; a < 3; a++) x[a] = (1.0 - to) * path->begin[a] + to * path->end[a];
    if (!is_inside(x, corner, n) || is_on_border(path, k, to, x)) return;
    if (!path->direction) path->surface = surface;
    if (surface == path->surface) path->direction += direction;
}

static void test_triangle(void *user, int k) {
    struct crossing_path *path = user;
    double cut[4];
    if (path->set->surface[k] < path->first_surface) return;
    int cuts = cut_step(path, k, cut);
    for (int i = 1; i < cuts; i++) test_part(path, k, cut[i - 1], cut[i]);
}

void crossing_path_test(struct crossing_path *path, const struct swept_triangles *set) {
    struct box box = box_empty;
    box_add(&box, path->begin), box_add(&box, path->end);
    path->set = set;
    bvh_visit(&set->tree, &box, test_triangle, path);
}
