#include "crossing_path.h"

#include "geometry/distance.h"

#include "projdyn/vec3.h"

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

/* Width of the border of a triangle, relative to its size. The plane turns within a step, so the
 * time at which a particle meets it is not exact. */
static const double border = 1e-3;

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

struct border_search { /* for a border edge close to a point */
    const struct crossing_path *path;
    int surface;
    double t, x[3];
    bool found;
};

static void test_border(void *user, int k) {
    struct border_search *s = user;
    const struct swept_triangles *set = s->path->set;
    const int *across = s->path->swept->surface[s->surface].across;
    double corner[3][3], n[3], weight[4];
    if (s->found || set->surface[k] != s->surface) return;
    plane_at(s->path, k, s->t, corner, n);
    for (int i = 0; i < 3; i++) {
        const double *side[4] = {s->x, s->x, corner[(i + 1) % 3], corner[(i + 2) % 3]};
        if (across[3 * (size_t)set->triangle[k] + (size_t)i] < 0 &&
            closest_edge_edge(side, weight) < s->path->radius * s->path->radius)
            s->found = true;
    }
}

/* Closer to the border of the surface than the particle's radius: the particle goes around. The
 * border edge may belong to another triangle than k. */
static bool is_on_border(const struct crossing_path *path, int k, double t, const double x[3]) {
    struct border_search s = {.path = path, .surface = path->set->surface[k], .t = t};
    struct box box;
    if (!path->swept->surface[s.surface].across) return false;
    for (int a = 0; a < 3; a++)
        s.x[a] = x[a], box.min[a] = x[a] - path->radius, box.max[a] = x[a] + path->radius;
    bvh_visit(&path->set->tree, &box, 0, test_border, &s);
    return s.found;
}

/* The direction in which a particle passes a plane, +1 along its normal; 0: it does not. slack and
 * distances at the two ends of the step: times the length of the normal. */
static int direction_of(double begin, double end, double slack) {
    if (begin > -slack && end <= -slack) return -1;
    return begin <= slack && end > slack;
}

static void test_triangle(void *user, int k) {
    struct crossing_path *path = user;
    double corner[3][3], n[3], x[3];
    int surface = path->set->surface[k];
    if (surface < path->first_surface) return;
    double begin = plane_at(path, k, 0.0, corner, n), end = plane_at(path, k, 1.0, corner, n);
    double slack = path->slack * vec3_length(n);
    int direction = direction_of(begin, end, slack);
    if (!direction) return;
    double t = (begin - direction * slack) / (begin - end);
    plane_at(path, k, t, corner, n);
    for (int a = 0; a < 3; a++) x[a] = (1.0 - t) * path->begin[a] + t * path->end[a];
    if (!is_inside(x, corner, n) || is_on_border(path, k, t, x)) return;
    if (!path->direction) path->surface = surface;
    if (surface == path->surface) path->direction += direction;
}

void crossing_path_test(struct crossing_path *path, const struct swept_triangles *set) {
    struct box box = box_empty;
    box_add(&box, path->begin), box_add(&box, path->end);
    path->set = set;
    bvh_visit(&set->tree, &box, 0, test_triangle, path);
}
