#include "border.h"

#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/mesh_query.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* ---- lists of sides -------------------------------------------------------------------------- */

struct listing {
    struct border *border;
    const struct border_def *def;
    struct mesh_query *wall; /* of each wall */
    struct box *box;         /* of each triangle at rest */
    struct bvh tree;         /* of these boxes */
    int first, last;         /* triangles of the current body: first to before last */
    int end[2];              /* of the current side */
};

static void count_side(void *user, int triangle) {
    const struct listing *l = user;
    if (triangle >= l->first && triangle < l->last) l->border->start[triangle + 1]++;
}

/* Moves the start of the list to its end. */
static void add_side(void *user, int triangle) {
    const struct listing *l = user;
    if (triangle < l->first || triangle >= l->last) return;
    int to = l->border->start[triangle]++;
    memcpy(l->border->end + 2 * (size_t)to, l->end, sizeof l->end);
}

/* The place beyond the middle of side k of body b, in the plane of its triangle. */
static void place_beyond(const struct listing *l, int b, int k, double distance, double place[3]) {
    const pdyn_body *body = &l->def->body[b];
    const double *x[3];
    double side[3], out[3];
    for (int m = 0; m < 3; m++) /* the ends of the side, the corner opposite to it */
        x[m] =
            l->def->rest + 3 * (size_t)(body->first + body->triangle[k / 3 * 3 + (k + 1 + m) % 3]);
    vec3_subtract(side, x[1], x[0]);
    for (int a = 0; a < 3; a++) place[a] = 0.5 * (x[0][a] + x[1][a]), out[a] = place[a] - x[2][a];
    vec3_add(out, -vec3_dot(out, side) / vec3_dot(side, side), side);
    vec3_add(place, distance / vec3_length(out), out);
}

static bool is_closed(const struct listing *l, int b, int k) {
    double distance = 0.5 * l->border->width, place[3];
    place_beyond(l, b, k, distance, place);
    for (int w = 0; w < l->def->walls; w++)
        if (l->def->wall[w].body != b &&
            mesh_query_is_close(&l->wall[w], place, distance * (1.0 + 1e-6)))
            return true;
    return false;
}

/* Side k of body b lies on its border: visits the triangles near it. */
static void visit_side(struct listing *l, int b, int k, void (*visit)(void *user, int triangle)) {
    const pdyn_body *body = &l->def->body[b];
    const int *corner = body->triangle + k / 3 * 3;
    struct box box = box_empty;
    for (int m = 0; m < 2; m++) {
        l->end[m] = body->first + corner[(k + 1 + m) % 3];
        box_add(&box, l->def->rest + 3 * (size_t)l->end[m]);
    }
    box_grow(&box, l->border->width);
    bvh_visit(&l->tree, &box, visit, l);
}

static void visit_sides(struct listing *l, void (*visit)(void *user, int triangle)) {
    l->last = 0;
    for (int b = 0; b < l->def->bodies; b++) {
        const pdyn_body *body = &l->def->body[b];
        l->first = l->last, l->last += hiding_triangles(body);
        for (int k = 0; k < 3 * hiding_triangles(body); k++)
            if (body->across[k] < 0 && !is_closed(l, b, k)) visit_side(l, b, k, visit);
    }
}

static void build_tree(struct listing *l) {
    int count = 0;
    for (int b = 0; b < l->def->bodies; b++) {
        const pdyn_body *body = &l->def->body[b];
        for (int k = 0; k < 3 * hiding_triangles(body); k++) {
            struct box *box = &l->box[count + k / 3];
            if (k % 3 == 0) *box = box_empty;
            box_add(box, l->def->rest + 3 * (size_t)(body->first + body->triangle[k]));
        }
        count += hiding_triangles(body);
    }
    bvh_build(&l->tree, l->box, count);
}

static pdyn_status list_sides(struct listing *l) {
    struct border *b = l->border;
    size_t triangles = (size_t)b->triangles;
    build_tree(l);
    visit_sides(l, count_side);
    for (size_t t = 0; t < triangles; t++) b->start[t + 1] += b->start[t];
    b->sides = b->start[triangles];
    b->end = NEW_ARRAY(b->context, 2 * (size_t)b->sides, int);
    if (b->sides && !b->end) return PDYN_NO_MEMORY;
    visit_sides(l, add_side);
    memmove(b->start + 1, b->start, triangles * sizeof *b->start);
    b->start[0] = 0;
    return PDYN_OK;
}

static pdyn_status prepare(struct listing *l) {
    pdyn_context *c = l->border->context;
    l->box = NEW_ARRAY(c, l->border->triangles, struct box);
    l->wall = NEW_ARRAY(c, l->def->walls, struct mesh_query);
    if (!l->box || (!l->wall && l->def->walls)) return PDYN_NO_MEMORY;
    pdyn_status status = bvh_create(c, l->border->triangles, &l->tree);
    for (int w = 0; w < l->def->walls && status == PDYN_OK; w++)
        status = mesh_query_create(c, l->def->wall[w].mesh, &l->wall[w]);
    return status;
}

static void release(struct listing *l) {
    pdyn_context *c = l->border->context;
    for (int w = 0; l->wall && w < l->def->walls; w++) mesh_query_free(c, &l->wall[w]);
    bvh_free(c, &l->tree);
    FREE_ARRAY(c, l->wall, l->def->walls);
    FREE_ARRAY(c, l->box, l->border->triangles);
}

static bool has_border(const pdyn_body *body) {
    for (int k = 0; k < 3 * hiding_triangles(body); k++)
        if (body->across[k] < 0) return true;
    return false;
}

pdyn_status border_create(pdyn_context *context, const struct border_def *def, struct border *out) {
    struct listing l = {.border = out, .def = def};
    bool any = false;
    out->context = context, out->width = def->width;
    for (int b = 0; b < def->bodies; b++) {
        out->triangles += hiding_triangles(&def->body[b]);
        any |= has_border(&def->body[b]);
    }
    if (!out->triangles || def->width == 0.0) return PDYN_OK;
    out->start = NEW_ARRAY(context, out->triangles + 1, int);
    if (!out->start) return PDYN_NO_MEMORY;
    if (!any) return PDYN_OK;
    pdyn_status status = prepare(&l);
    if (status == PDYN_OK) status = list_sides(&l);
    release(&l);
    return status;
}

void border_free(struct border *b) {
    FREE_ARRAY(b->context, b->start, b->triangles + 1);
    FREE_ARRAY(b->context, b->end, 2 * (size_t)b->sides);
}

/* ---- distance -------------------------------------------------------------------------------- */

double border_distance(const struct border *b, int triangle, const double *x, const double at[3]) {
    double squared = b->width * b->width, weight[4];
    for (int k = b->start[triangle]; k < b->start[triangle + 1]; k++) {
        const int *end = b->end + 2 * (size_t)k;
        const double *points[4] = {at, at, x + 3 * (size_t)end[0], x + 3 * (size_t)end[1]};
        squared = fmin(squared, closest_edge_edge(points, weight));
    }
    return sqrt(squared);
}
