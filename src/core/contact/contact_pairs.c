/* Broad phase: the list of pairs that may come into contact. Each point has a region, a box around
 * it and its displacement. Pairs whose boxes around these regions overlap (bvh.h) and that can come
 * closer than their thickness are listed; the list is complete while every point is in its region.
 */
#include "contact.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { QUERIES = 64 }; /* of a parallel block */

/* Margin of a region around a point and its displacement: `still` thicknesses plus `ahead` of the
 * length of the displacement, the latter at most `most_ahead` thicknesses. */
static const double still = 0.5, ahead = 0.25, most_ahead = 1.0;

/* ---- regions --------------------------------------------------------------------------------- */

static bool holds(const struct box *box, const double *x, const double *step) {
    for (int a = 0; a < 3; a++) {
        double y = x[a] + (step ? step[a] : 0.0);
        if (x[a] < box->min[a] || x[a] > box->max[a]) return false;
        if (y < box->min[a] || y > box->max[a]) return false;
    }
    return true;
}

static bool all_hold(const struct contact *c, const double *x, const double *step) {
    for (int i = 0; i < c->points; i++)
        if (!holds(&c->region[i], x + 3 * i, step ? step + 3 * i : NULL)) return false;
    return true;
}

static void set_regions(struct contact *c, const double *x, const double *step) {
    const double T = c->set->thickness;
    for (int i = 0; i < c->points; i++) {
        double end[3] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]}, far = 0.0;
        if (step) vec3_add(end, 1.0, step + 3 * i);
        double way = vec3_distance(end, x + 3 * i);
        double margin =
            i < c->free || way > 0.0 ? still * T + fmin(ahead * way, most_ahead * T) : 0.0;
        c->region[i] = box_empty;
        box_add(&c->region[i], x + 3 * i);
        box_add(&c->region[i], end);
        for (int a = 0; a < 3; a++) {
            c->region[i].min[a] -= margin, c->region[i].max[a] += margin;
            double side = margin + fabs(end[a] - x[3 * i + a]);
            far += side * side;
        }
        c->reach[i] = sqrt(far);
    }
    memcpy(c->built, x, 3 * (size_t)c->points * sizeof *x);
}

/* ---- trees ----------------------------------------------------------------------------------- */

/* The box around the regions of the corners, larger by half a thickness. */
static void wrap(const struct contact *c, const int *corner, int corners, struct box *box) {
    *box = box_empty;
    for (int k = 0; k < corners; k++) {
        box_add(box, c->region[corner[k]].min);
        box_add(box, c->region[corner[k]].max);
    }
    for (int a = 0; a < 3; a++) {
        box->min[a] -= 0.5 * c->set->thickness;
        box->max[a] += 0.5 * c->set->thickness;
    }
}

static void plant(struct contact *c) {
    for (int f = 0; f < c->faces; f++) wrap(c, c->face + 3 * f, 3, &c->face_box[f]);
    for (int e = 0; e < c->edges; e++) wrap(c, c->edge + 2 * e, 2, &c->edge_box[e]);
    bvh_build(&c->face_tree[0], c->face_box, c->free_faces);
    bvh_build(&c->face_tree[1], c->face_box + c->free_faces, c->faces - c->free_faces);
    bvh_build(&c->edge_tree[0], c->edge_box, c->free_edges);
    bvh_build(&c->edge_tree[1], c->edge_box + c->free_edges, c->edges - c->free_edges);
}

/* ---- the search ------------------------------------------------------------------------------ */

struct search { /* for the pairs of one point or edge, number a */
    struct contact *contact;
    bool edges;
    int a, base, block; /* base: number of the first box of the tree */
};

static double farthest(const double *of, const int point[4], int first) {
    double one = of[point[0]], other = of[point[3]];
    for (int k = 1; k < 3; k++)
        if (k < first) one = fmax(one, of[point[k]]);
        else other = fmax(other, of[point[k]]);
    return one + other;
}

static bool share_point(const int point[4], int first) {
    for (int k = 0; k < first; k++)
        for (int m = first; m < 4; m++)
            if (point[k] == point[m]) return true;
    return false;
}

static double distance_in(const struct pair *p, const double *x) {
    const double *points[4];
    double unused[4];
    pair_load(p->point, x, points);
    return sqrt(pair_kind_of(p->key)->closest(points, unused));
}

/* Squared sine of the angle below which edges are nearly parallel: 1.8 degrees. */
static const double parallel = 1e-3;

/* The closest points of parallel edges are not unique, and the moment of a force between them would
 * jump: a soft block whose edges lie along the diagonal of a plane would not come to the end of a
 * step. Their distance is that of a vertex and a face, which is a pair, too. The mollifier of Li et
 * al. (2020), with the directions of when the pair is listed. */
static double share_of(const struct contact *c, const struct pair *p) {
    const double *x[4];
    double d[2][3], normal[3];
    if (pair_kind_of(p->key) != &pair_edge_edge) return 1.0;
    pair_load(p->point, c->built, x);
    for (int k = 0; k < 2; k++) vec3_subtract(d[k], x[2 * k + 1], x[2 * k]);
    vec3_cross(normal, d[0], d[1]);
    double squares = vec3_dot(d[0], d[0]) * vec3_dot(d[1], d[1]);
    double t = vec3_dot(normal, normal) / (parallel * squares);
    return t < 1.0 ? t * (2.0 - t) : 1.0;
}

/* Whether the pair can come closer than its thickness while its points are in their regions; sets
 * its distance and thickness. Within a body the thickness is less than the distance in the rest
 * shape, so that the rest shape has no contact forces. */
static bool close_enough(const struct contact *c, struct pair *p) {
    int first = pair_kind_of(p->key)->first;
    bool same = c->group[p->point[0]] == c->group[p->point[3]];
    if (share_point(p->point, first)) return false;
    p->distance = distance_in(p, c->built);
    p->thickness = fmin(c->near[c->group[p->point[0]]], c->near[c->group[p->point[3]]]);
    double nearest = p->distance - farthest(c->reach, p->point, first);
    if (nearest > p->thickness) return false;
    p->share = share_of(c, p);
    if (same) p->thickness = fmin(p->thickness, 0.9 * distance_in(p, c->rest));
    return nearest <= p->thickness;
}

static struct pair make_pair(const struct contact *c, bool edges, int a, int b) {
    struct pair p = {.key = (uint64_t)edges << 63 | (uint64_t)a << 32 | (uint64_t)b};
    const int *second = edges ? c->edge + 2 * b : c->face + 3 * b;
    memcpy(p.point, edges ? c->edge + 2 * a : &a, (edges ? 2 : 1) * sizeof a);
    memcpy(p.point + (edges ? 2 : 1), second, (edges ? 2 : 3) * sizeof a);
    return p;
}

static void visit(void *user, int id) {
    const struct search *s = user;
    struct contact *c = s->contact;
    struct pair p = make_pair(c, s->edges, s->a, s->base + id);
    if (!close_enough(c, &p)) return;
    size_t at = c->found_start[s->block] + (size_t)c->found_count[s->block]++;
    if (at < c->found_start[s->block + 1]) c->found[at] = p;
}

static void search_around(struct search *s, const struct box *box) {
    struct contact *c = s->contact;
    int group = c->group[s->edges ? c->edge[2 * s->a] : s->a];
    s->base = 0;
    bvh_visit_others(s->edges ? &c->edge_tree[0] : &c->face_tree[0], box, s->edges ? s->a + 1 : 0,
                     group, visit, s);
    if (!s->edges && s->a >= c->vertices) return; /* solids act on fluids by their samples */
    s->base = s->edges ? c->free_edges : c->free_faces;
    bvh_visit(s->edges ? &c->edge_tree[1] : &c->face_tree[1], box, 0, visit, s);
}

/* Whether the point is a particle that does not exist: not yet emitted, or removed. */
static bool is_absent(const struct contact *c, int point) {
    return c->live && point >= c->vertices && point < c->free && !c->live[c->column[point]];
}

/* A range of queries: each point is a query, then each edge of a surface. */
static void search_block(void *arg, int first, int last, int block) {
    struct contact *c = arg;
    c->found_count[block] = 0;
    for (int q = first; q < last; q++) {
        bool edges = q >= c->points;
        struct search s = {.contact = c, .edges = edges, .a = edges ? q - c->points : q};
        struct box point;
        s.block = block;
        if (!edges && (c->group[q] < 0 || is_absent(c, q))) continue;
        if (!edges) wrap(c, &q, 1, &point);
        search_around(&s, edges ? &c->edge_box[s.a] : &point);
    }
}

/* Gives each block room for twice as many pairs as it has found. */
static pdyn_status make_block_room(struct contact *c) {
    for (int b = 0; b < c->blocks; b++)
        c->found_start[b + 1] = c->found_start[b] + 64 + 2 * (size_t)c->found_count[b];
    struct pair *found = context_grow(c->context, c->found, &c->found_room,
                                      c->found_start[c->blocks], sizeof *found);
    if (!found) return PDYN_NO_MEMORY;
    c->found = found;
    return PDYN_OK;
}

/* Makes room for the search before the first one. */
static pdyn_status prepare(struct contact *c) {
    if (c->found) return PDYN_OK;
    c->blocks = pool_blocks(c->points + c->free_edges, QUERIES);
    c->found_count = NEW_ARRAY(c->context, c->blocks, int);
    c->found_start = NEW_ARRAY(c->context, c->blocks + 1, size_t);
    return c->found_count && c->found_start ? make_block_room(c) : PDYN_NO_MEMORY;
}

static bool is_complete(const struct contact *c) {
    bool complete = true;
    for (int b = 0; b < c->blocks; b++)
        complete &= c->found_start[b] + (size_t)c->found_count[b] <= c->found_start[b + 1];
    return complete;
}

/* Repeats the search with more room if a block found more pairs than it had room for. */
static pdyn_status search(struct contact *c) {
    pdyn_status status = prepare(c);
    while (status == PDYN_OK) {
        pool_for(c->context->pool, c->points + c->free_edges, QUERIES, search_block, c);
        if (is_complete(c)) return PDYN_OK;
        status = make_block_room(c);
    }
    return status;
}

/* ---- the list -------------------------------------------------------------------------------- */

static pdyn_status make_room(struct contact *c, int room) {
    contact_free_pairs(c);
    c->room = room;
    c->pair = NEW_ARRAY(c->context, room, struct pair);
    c->hit = NEW_ARRAY(c->context, room, struct hit);
    c->hit_count = NEW_ARRAY(c->context, pool_blocks(room, CONTACT_GRAIN), int);
    c->hit_start = NEW_ARRAY(c->context, pool_blocks(room, CONTACT_GRAIN), int);
    c->blocked = NEW_ARRAY(c->context, room, struct blocked);
    c->blocked_count = NEW_ARRAY(c->context, pool_blocks(room, CONTACT_GRAIN), int);
    bool good = c->pair && c->hit && c->hit_count && c->hit_start && c->blocked && c->blocked_count;
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

void contact_free_pairs(struct contact *c) {
    FREE_ARRAY(c->context, c->pair, c->room);
    FREE_ARRAY(c->context, c->hit, c->room);
    FREE_ARRAY(c->context, c->hit_count, pool_blocks(c->room, CONTACT_GRAIN));
    FREE_ARRAY(c->context, c->hit_start, pool_blocks(c->room, CONTACT_GRAIN));
    FREE_ARRAY(c->context, c->blocked, c->room);
    FREE_ARRAY(c->context, c->blocked_count, pool_blocks(c->room, CONTACT_GRAIN));
}

static pdyn_status collect(struct contact *c) {
    long count = 0;
    for (int b = 0; b < c->blocks; b++) count += c->found_count[b];
    if (count > INT32_MAX / 4)
        return context_fail(c->context, PDYN_DIVERGED, "contact: %ld pairs are close", count);
    c->pairs = 0;
    if (count > c->room) {
        pdyn_status status = make_room(c, (int)(count + count / 4));
        if (status != PDYN_OK) return status;
    }
    for (int b = 0; count && b < c->blocks; b++) {
        memcpy(c->pair + c->pairs, c->found + c->found_start[b],
               (size_t)c->found_count[b] * sizeof *c->pair);
        c->pairs += c->found_count[b];
    }
    return PDYN_OK;
}

pdyn_status contact_list(struct contact *c) {
    plant(c);
    pdyn_status status = search(c);
    return status == PDYN_OK ? collect(c) : status;
}

pdyn_status contact_cover(struct contact *c, const double *x, const double *step) {
    if (!all_hold(c, x, step)) {
        set_regions(c, x, step);
        pdyn_status status = contact_list(c);
        if (status != PDYN_OK) return status;
    }
    for (int i = 0; i < c->points; i++) c->moved[i] = vec3_distance(x + 3 * i, c->built + 3 * i);
    return PDYN_OK;
}
