#include "occlusion.h"

#include "geometry/distance.h"

#include "projdyn/vec3.h"

#include <math.h>

/* ---- memory ---------------------------------------------------------------------------------- */

static pdyn_status fill(struct occlusion *s, int bodies, const pdyn_body *body) {
    s->corner = NEW_ARRAY(s->context, 3 * (size_t)s->triangles, int);
    s->planted_as = NEW_ARRAY(s->context, s->triangles, int);
    s->box = NEW_ARRAY(s->context, s->triangles, struct box);
    s->clearance = NEW_ARRAY(s->context, s->points, double);
    if (!s->corner || !s->planted_as || !s->box || !s->clearance) return PDYN_NO_MEMORY;
    int *corner = s->corner;
    for (int b = 0; b < bodies; b++)
        for (int k = 0; k < 3 * body[b].triangles; k++)
            *corner++ = body[b].first + body[b].triangle[k];
    return bvh_create(s->context, s->triangles, &s->tree);
}

pdyn_status occlusion_create(pdyn_context *context, int bodies, const pdyn_body *body, int points,
                             double reach, struct occlusion **out) {
    int triangles = 0;
    *out = NULL;
    for (int b = 0; b < bodies; b++) triangles += body[b].triangles;
    if (!triangles) return PDYN_OK;
    struct occlusion *s = NEW_ARRAY(context, 1, struct occlusion);
    if (!s) return PDYN_NO_MEMORY;
    *s = (struct occlusion){
        .context = context, .points = points, .triangles = triangles, .reach = reach};
    pdyn_status status = fill(s, bodies, body);
    if (status == PDYN_OK) *out = s;
    else occlusion_free(s);
    return status;
}

void occlusion_free(struct occlusion *s) {
    if (!s) return;
    FREE_ARRAY(s->context, s->corner, 3 * (size_t)s->triangles);
    FREE_ARRAY(s->context, s->planted_as, s->triangles);
    FREE_ARRAY(s->context, s->box, s->triangles);
    FREE_ARRAY(s->context, s->clearance, s->points);
    bvh_free(s->context, &s->tree);
    FREE_ARRAY(s->context, s, 1);
}

/* ---- how far from the surfaces --------------------------------------------------------------- */

/* All that is at most so far from a box of one point or of many. */
static struct box grown(const double *min, const double *max, double by) {
    struct box box;
    for (int a = 0; a < 3; a++) box.min[a] = min[a] - by, box.max[a] = max[a] + by;
    return box;
}

void occlusion_update(struct occlusion *s, const double *x, const struct box *around) {
    struct box near = grown(around->min, around->max, s->reach);
    s->x = x, s->planted = 0;
    for (int t = 0; t < s->triangles; t++) {
        struct box *box = &s->box[s->planted];
        *box = box_empty;
        for (int k = 0; k < 3; k++) box_add(box, x + 3 * (size_t)s->corner[3 * t + k]);
        if (box_overlaps(box, &near)) s->planted_as[s->planted++] = t;
    }
    bvh_build(&s->tree, s->box, s->planted);
}

struct question {
    const struct occlusion *sides;
    const double *from, *to;
    struct box box; /* of the search */
    double nearest; /* m^2 */
    bool between;
};

static const int *corners(const struct question *q, int planted) {
    return q->sides->corner + 3 * q->sides->planted_as[planted];
}

/* What is farther need not be looked at any more. */
static void see_nearest(void *user, int planted) {
    struct question *q = user;
    const int *corner = corners(q, planted);
    const double *points[4] = {q->from};
    double unused[4];
    for (int k = 0; k < 3; k++) points[k + 1] = q->sides->x + 3 * (size_t)corner[k];
    double squared = closest_vertex_face(points, unused);
    if (!(squared < q->nearest)) return;
    q->nearest = squared;
    q->box = grown(q->from, q->from, sqrt(squared));
}

void occlusion_measure(struct occlusion *s, int i, const double *at) {
    double far = 0.5 * s->reach;
    struct question q = {.sides = s, .from = at, .box = grown(at, at, far), .nearest = far * far};
    bvh_visit(&s->tree, &q.box, 0, see_nearest, &q);
    s->clearance[i] = sqrt(q.nearest);
}

/* ---- what is between ------------------------------------------------------------------------- */

/* Which side of the line from 0 along d passes that from a to b; changes its sign, and nothing
 * else, where a and b change places: a segment through an edge of two triangles meets one. */
static double passes(const double d[3], const double a[3], const double b[3]) {
    double normal[3];
    vec3_cross(normal, a, b);
    return vec3_dot(d, normal);
}

/* Does the segment from 0 to d meet the triangle? */
static bool meets(const double d[3], double c[3][3]) {
    double u[3], v[3], n[3];
    for (int a = 0; a < 3; a++) u[a] = c[1][a] - c[0][a], v[a] = c[2][a] - c[0][a];
    vec3_cross(n, u, v);
    double begin = -vec3_dot(n, c[0]), end = begin + vec3_dot(n, d);
    if ((begin > 0.0) == (end > 0.0)) return false;
    double s[3];
    for (int k = 0; k < 3; k++) s[k] = passes(d, c[k], c[(k + 1) % 3]);
    return (s[0] >= 0.0 && s[1] >= 0.0 && s[2] >= 0.0) ||
           (s[0] <= 0.0 && s[1] <= 0.0 && s[2] <= 0.0);
}

static void see_between(void *user, int planted) {
    struct question *q = user;
    const int *corner = corners(q, planted);
    double d[3], c[3][3];
    for (int a = 0; a < 3; a++) {
        d[a] = q->to[a] - q->from[a];
        for (int k = 0; k < 3; k++)
            c[k][a] = q->sides->x[3 * (size_t)corner[k] + (size_t)a] - q->from[a];
    }
    q->between |= meets(d, c);
}

bool occlusion_is_near(const struct occlusion *s, int i) {
    return s->clearance[i] < 0.5 * s->reach;
}

/* Around each point there is a ball without a triangle; often the two cover the segment. */
bool occlusion_blocks(const struct occlusion *s, int i, const double *a, int j, const double *b) {
    struct question q = {.sides = s, .from = i < j ? a : b, .to = i < j ? b : a};
    double room = s->clearance[i] + s->clearance[j];
    if (room >= vec3_distance(q.from, q.to)) return false;
    q.box = box_empty;
    box_add(&q.box, q.from), box_add(&q.box, q.to);
    bvh_visit(&s->tree, &q.box, 0, see_between, &q);
    return q.between;
}
