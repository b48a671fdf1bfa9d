/* Occlusion by triangles: clearance of points, and segments that meet a triangle. */
#include "occlusion.h"

#include "base/body.h"
#include "geometry/distance.h"

#include "projdyn/vec3.h"

#include <math.h>

/* ---- memory ---------------------------------------------------------------------------------- */

static bool resize_arrays(struct occlusion *s, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(s->corner, 3 * (size_t)s->triangles),
        ARRAY(s->is_sheet, s->triangles),
        ARRAY(s->near_triangle, s->triangles),
        ARRAY(s->box, s->triangles),
        ARRAY(s->clearance, s->points),
        ARRAY(s->nearest, s->points),
    };
    return context_arrays(s->context, table, ARRAY_ROWS(table), action);
}

static pdyn_status fill(struct occlusion *s, int bodies, const pdyn_body *body) {
    if (!resize_arrays(s, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    int *corner = s->corner;
    bool *is_sheet = s->is_sheet;
    for (int b = 0; b < bodies; b++) {
        for (int k = 0; k < 3 * hiding_triangles(&body[b]); k++)
            *corner++ = body[b].first + body[b].triangle[k];
        for (int k = 0; k < hiding_triangles(&body[b]); k++) *is_sheet++ = body_is_sheet(&body[b]);
    }
    return bvh_create(s->context, s->triangles, &s->tree);
}

pdyn_status occlusion_create(pdyn_context *context, int bodies, const pdyn_body *body,
                             const struct border *border, int points, double reach,
                             struct occlusion **out) {
    *out = NULL;
    if (!border->triangles) return PDYN_OK;
    struct occlusion *s = NEW_ARRAY(context, 1, struct occlusion);
    if (!s) return PDYN_NO_MEMORY;
    *s = (struct occlusion){.context = context,
                            .points = points,
                            .triangles = border->triangles,
                            .border = border,
                            .reach = reach};
    pdyn_status status = fill(s, bodies, body);
    if (status == PDYN_OK) *out = s;
    else occlusion_free(s);
    return status;
}

void occlusion_free(struct occlusion *s) {
    if (!s) return;
    resize_arrays(s, ARRAYS_FREE);
    bvh_free(s->context, &s->tree);
    FREE_ARRAY(s->context, s, 1);
}

/* ---- clearance ------------------------------------------------------------------------------- */

void occlusion_update(struct occlusion *s, const double *x, const struct box *around) {
    struct box near = *around;
    box_grow(&near, s->reach);
    s->x = x, s->near_count = 0;
    for (int t = 0; t < s->triangles; t++) {
        struct box *box = &s->box[s->near_count];
        *box = box_empty;
        for (int k = 0; k < 3; k++) box_add(box, x + 3 * (size_t)s->corner[3 * t + k]);
        if (box_overlaps(box, &near)) s->near_triangle[s->near_count++] = t;
    }
    bvh_build(&s->tree, s->box, s->near_count);
}

struct query {
    const struct occlusion *occlusion;
    const double *from, *to;
    struct box box; /* region of the search */
    double nearest; /* squared distance to the nearest triangle so far, m^2 */
    int triangle;   /* that triangle; -1: none */
    double touch;   /* m; `to` lies on a triangle whose plane is closer. Such a triangle does not
                       block, unless it is of a sheet */
    bool blocked;
};

static const int *corners(const struct query *q, int id) {
    return q->occlusion->corner + 3 * q->occlusion->near_triangle[id];
}

/* Updates the nearest triangle and shrinks the search to its distance. */
static void compare_triangle(struct query *q, int triangle) {
    const double *points[4] = {q->from};
    double unused[4];
    for (int k = 0; k < 3; k++)
        points[k + 1] = q->occlusion->x + 3 * (size_t)q->occlusion->corner[3 * triangle + k];
    double squared = closest_vertex_face(points, unused);
    if (!(squared < q->nearest)) return;
    q->nearest = squared, q->triangle = triangle;
    q->box = box_of_ball(q->from, sqrt(squared));
}

static void visit_triangle(void *user, int id) {
    struct query *q = user;
    compare_triangle(q, q->occlusion->near_triangle[id]);
}

/* The triangle that was the nearest one last time is compared first: it bounds the search. */
void occlusion_compute_clearance(struct occlusion *s, int i, const double *at, double most) {
    struct query q = {.occlusion = s,
                      .from = at,
                      .box = box_of_ball(at, most),
                      .nearest = most * most,
                      .triangle = -1};
    if (s->nearest[i]) compare_triangle(&q, s->nearest[i] - 1);
    bvh_visit(&s->tree, &q.box, visit_triangle, &q);
    s->clearance[i] = sqrt(q.nearest), s->nearest[i] = 1 + q.triangle;
}

/* ---- blocking triangles ---------------------------------------------------------------------- */

/* On which side of the line from 0 along d the edge from a to b passes: the sign of d . (a x b). It
 * changes its sign exactly if a and b are swapped, so a segment through the common edge of two
 * triangles meets exactly one of them. */
static double edge_side(const double d[3], const double a[3], const double b[3]) {
    double normal[3];
    vec3_cross(normal, a, b);
    return vec3_dot(d, normal);
}

/* Whether the segment from 0 to d meets the triangle c, on which d does not lie. */
static bool segment_meets_triangle(const double d[3], double c[3][3], double touch) {
    double n[3];
    vec3_normal(n, c[0], c[1], c[2]);
    double begin = -vec3_dot(n, c[0]), end = begin + vec3_dot(n, d);
    if ((begin > 0.0) == (end > 0.0)) return false;
    if (end * end < touch * touch * vec3_dot(n, n)) return false;
    double s[3];
    for (int k = 0; k < 3; k++) s[k] = edge_side(d, c[k], c[(k + 1) % 3]);
    return (s[0] >= 0.0 && s[1] >= 0.0 && s[2] >= 0.0) ||
           (s[0] <= 0.0 && s[1] <= 0.0 && s[2] <= 0.0);
}

/* Whether the segment from 0 to d, which meets triangle `id`, c, does so beside a border. */
static bool goes_around(const struct query *q, int id, const double d[3], double c[3][3]) {
    const struct border *border = q->occlusion->border;
    int triangle = q->occlusion->near_triangle[id];
    double n[3], at[3];
    if (!border_is_near(border, triangle)) return false;
    vec3_normal(n, c[0], c[1], c[2]);
    double part = vec3_dot(n, c[0]) / vec3_dot(n, d);
    for (int a = 0; a < 3; a++) at[a] = q->from[a] + part * d[a];
    return border_distance(border, triangle, q->occlusion->x, at) < border->width;
}

static void test_blocking(void *user, int id) {
    struct query *q = user;
    const int *corner = corners(q, id);
    double d[3], c[3][3];
    for (int a = 0; a < 3; a++) {
        d[a] = q->to[a] - q->from[a];
        for (int k = 0; k < 3; k++)
            c[k][a] = q->occlusion->x[3 * (size_t)corner[k] + (size_t)a] - q->from[a];
    }
    bool is_sheet = q->occlusion->is_sheet[q->occlusion->near_triangle[id]];
    if (segment_meets_triangle(d, c, is_sheet ? 0.0 : q->touch) && !goes_around(q, id, d, c))
        q->blocked = true;
}

bool occlusion_is_clear(const struct occlusion *s, int i, double distance) {
    return s->clearance[i] >= distance;
}

bool occlusion_is_near(const struct occlusion *s, int i) {
    return s->clearance[i] < 0.5 * s->reach;
}

bool occlusion_separates(const struct occlusion *s, const double *from, const double *to,
                         double touch) {
    struct query q = {.occlusion = s, .from = from, .to = to, .box = box_empty, .touch = touch};
    box_add(&q.box, from), box_add(&q.box, to);
    bvh_visit(&s->tree, &q.box, test_blocking, &q);
    return q.blocked;
}

/* Every point has a ball around it that contains no triangle. If the two balls cover the segment,
 * no search is needed. */
bool occlusion_blocks(const struct occlusion *s, int i, const double *a, int j, const double *b) {
    double distance = vec3_distance(a, b);
    if (occlusion_is_clear(s, i, distance) || s->clearance[i] + s->clearance[j] >= distance)
        return false;
    return i < j ? occlusion_separates(s, a, b, 0.0) : occlusion_separates(s, b, a, 0.0);
}
