/* Broad phase: the list of pairs that may come into contact. Pairs whose boxes around their regions
 * (contact_regions.c) overlap and that can come closer than their thickness are listed; the list is
 * complete while every point is in its region.
 *
 * Only the pairs of points with new regions are searched anew: most searches of an impact are for a
 * few of thousands of points. The list is sorted, so that it depends on the regions and not on
 * earlier lists: a resumed run makes it again from the regions. */
#include "contact_parts.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { QUERIES = 64 }; /* of a parallel block */

/* ---- the search ------------------------------------------------------------------------------ */

struct search { /* for the pairs of one point or edge, number a */
    struct contact *contact;
    bool edges;
    int a, base, block; /* base: number of the first box of the tree */
};

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

/* The share of its stiffness that a pair has: for edges the mollifier of Li et al. (2020), 0 where
 * they are parallel. There the closest points are not unique, and the moment of the force would
 * jump: a soft block whose edges lie along the diagonal of a plane had unsolved steps. A pair of a
 * vertex and a face has the same distance and carries the force. The directions are those at the
 * time at which the pair is listed. */
static double share_of(const struct contact *c, const struct pair *p) {
    const double *x[4];
    double d[2][3], normal[3];
    if (pair_kind_of(p->key) != &pair_edge_edge) return 1.0;
    pair_load(p->point, c->broad.built, x);
    for (int k = 0; k < 2; k++) vec3_subtract(d[k], x[2 * k + 1], x[2 * k]);
    vec3_cross(normal, d[0], d[1]);
    double squares = vec3_dot(d[0], d[0]) * vec3_dot(d[1], d[1]);
    double t = vec3_dot(normal, normal) / (parallel * squares);
    return t < 1.0 ? t * (2.0 - t) : 1.0;
}

/* Whether the pair is a particle of a fluid and a face that it passes. */
static bool is_passed(const struct contact *c, const struct pair *p) {
    int a = p->point[0];
    return a >= c->vertices && a < c->free && c->permeable[c->group[p->point[3]]];
}

/* Distance in the rest shape, over the thickness, up to which two parts of a body count as joined:
 * the vertices along a seam, or the layers of a mesh that is folded flat. */
static const double joined = 1e-2;

/* Whether the pair can come closer than its thickness while its points are in their regions; sets
 * its distance, thickness and share. moved: how far the points were from there in `seen`. Within a
 * body the thickness is less than the distance in the rest shape, so that the rest shape has no
 * contact forces; parts that are joined are no pair. */
static bool close_enough(const struct contact *c, struct pair *p) {
    int first = pair_kind_of(p->key)->first;
    bool same = c->group[p->point[0]] == c->group[p->point[3]];
    if (share_point(p->point, first) || is_passed(c, p)) return false;
    double distance = distance_in(p, c->broad.built);
    p->thickness = fmin(c->thickness[c->group[p->point[0]]], c->thickness[c->group[p->point[3]]]);
    double nearest = distance - pair_largest(p, c->broad.reach);
    if (nearest > p->thickness) return false;
    p->distance = distance - pair_largest(p, c->pairs.moved);
    p->share = share_of(c, p);
    if (!same) return true;
    double rest = distance_in(p, c->rest);
    if (rest <= joined * p->thickness) return false;
    p->thickness = fmin(p->thickness, 0.9 * rest);
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
    if (s->edges && c->flat.edge[s->base + id]) return;
    struct pair p = make_pair(c, s->edges, s->a, s->base + id);
    if (!close_enough(c, &p)) return;
    size_t at = c->found.start[s->block] + (size_t)c->found.count[s->block]++;
    if (at < c->found.start[s->block + 1]) c->found.pair[at] = p;
}

static void search_around(struct search *s, const struct box *box) {
    struct contact *c = s->contact;
    bool changed = s->edges ? c->broad.edge_changed[s->a] : c->broad.changed[s->a];
    const struct bvh *tree = s->edges  ? changed ? c->broad.edge_tree : c->broad.changed_edges
                             : changed ? c->broad.face_tree
                                       : c->broad.changed_faces;
    int group = c->group[s->edges ? c->edge[2 * s->a] : s->a];
    s->base = 0;
    bvh_visit_others(&tree[0], box, s->edges ? s->a + 1 : 0, group, visit, s);
    if (!s->edges && s->a >= c->vertices) return; /* solids act on fluids by their samples */
    s->base = s->edges ? c->free_edges : c->free_faces;
    bvh_visit(&tree[1], box, 0, visit, s);
}

/* Sorts the pairs of one query, those of a block from number `first` on, by their keys. */
static void sort_found(struct contact *c, int block, int first) {
    struct pair *pair = c->found.pair + c->found.start[block];
    size_t room = c->found.start[block + 1] - c->found.start[block];
    for (int k = first + 1; k < c->found.count[block] && (size_t)k < room; k++) {
        struct pair p = pair[k];
        int to = k;
        for (; to > first && pair[to - 1].key > p.key; to--) pair[to] = pair[to - 1];
        pair[to] = p;
    }
}

/* A range of queries: each point is a query, then each edge of a surface. */
static void search_block(void *arg, int first, int last, int block) {
    struct contact *c = arg;
    c->found.count[block] = 0;
    for (int q = first; q < last; q++) {
        bool edges = q >= c->points;
        int begin = c->found.count[block];
        struct search s = {.contact = c, .edges = edges, .a = edges ? q - c->points : q};
        struct box point;
        s.block = block;
        if (!edges && (c->group[q] < 0 || box_is_empty(&c->broad.region[q]))) continue;
        if (edges ? c->flat.edge[s.a] : c->flat.point[q]) continue;
        if (!edges) contact_wrap_regions(c, &q, 1, &point);
        search_around(&s, edges ? &c->broad.edge_box[s.a] : &point);
        sort_found(c, block, begin);
    }
}

/* Gives each block room for twice as many pairs as it has found. */
static pdyn_status make_block_room(struct contact *c) {
    size_t room = 0;
    for (int b = 0; b < c->found.blocks; b++) room += 64 + 2 * (size_t)c->found.count[b];
    struct pair *found =
        context_grow(c->context, c->found.pair, &c->found.room, room, sizeof *found);
    if (!found) return PDYN_NO_MEMORY;
    c->found.pair = found;
    for (int b = 0; b < c->found.blocks; b++)
        c->found.start[b + 1] = c->found.start[b] + 64 + 2 * (size_t)c->found.count[b];
    return PDYN_OK;
}

/* Makes room for the search before the first one. */
static pdyn_status prepare(struct contact *c) {
    if (c->found.pair) return PDYN_OK;
    c->found.blocks = pool_blocks(c->points + c->free_edges, QUERIES);
    if (!c->found.count) c->found.count = NEW_ARRAY(c->context, c->found.blocks, int);
    if (!c->found.start) c->found.start = NEW_ARRAY(c->context, c->found.blocks + 1, size_t);
    return c->found.count && c->found.start ? make_block_room(c) : PDYN_NO_MEMORY;
}

static bool is_complete(const struct contact *c) {
    bool complete = true;
    for (int b = 0; b < c->found.blocks; b++)
        complete &= c->found.start[b] + (size_t)c->found.count[b] <= c->found.start[b + 1];
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

/* The pairs have an array of their own: they stay where the others grow. */
static bool resize_arrays(struct contact *c, enum array_action action) {
    int blocks = pool_blocks(c->pairs.room, CONTACT_GRAIN);
    const struct array_entry table[] = {
        ARRAY(c->hits.hit, c->pairs.room),    ARRAY(c->hits.count, blocks),
        ARRAY(c->hits.start, blocks),         ARRAY(c->path.candidate, c->pairs.room),
        ARRAY(c->path.candidates, blocks),    ARRAY(c->path.blocked, c->pairs.room),
        ARRAY(c->path.blocked_count, blocks),
    };
    return context_arrays(c->context, table, ARRAY_ROWS(table), action);
}

void contact_free_pairs(struct contact *c) {
    resize_arrays(c, ARRAYS_FREE);
    FREE_ARRAY(c->context, c->pairs.pair, c->pairs.room);
}

/* Makes room for `count` pairs; those in the list stay. PDYN_NO_MEMORY: nothing has changed. */
static pdyn_status reserve(struct contact *c, int count) {
    if (count <= c->pairs.room) return PDYN_OK;
    struct contact grown = *c;
    grown.pairs.room = count + count / 4;
    grown.pairs.pair = NEW_ARRAY(c->context, grown.pairs.room, struct pair);
    if (!resize_arrays(&grown, ARRAYS_ALLOCATE) || !grown.pairs.pair) {
        contact_free_pairs(&grown);
        return PDYN_NO_MEMORY;
    }
    if (c->pairs.count)
        memcpy(grown.pairs.pair, c->pairs.pair, (size_t)c->pairs.count * sizeof(struct pair));
    contact_free_pairs(c);
    *c = grown;
    return PDYN_OK;
}

static void drop_changed(struct contact *c) {
    int kept = 0;
    for (int k = 0; !c->broad.all_changed && k < c->pairs.count; k++)
        if (!contact_has_changed(c, c->pairs.pair[k].point, 4))
            c->pairs.pair[kept++] = c->pairs.pair[k];
    c->pairs.count = kept;
}

/* Merges what the blocks found with the list, from the end; both are sorted by keys. */
static void merge(struct contact *c, int count) {
    int kept = c->pairs.count, to = c->pairs.count = kept + count;
    for (int b = c->found.blocks - 1; b >= 0; b--) {
        const struct pair *found = c->found.pair + c->found.start[b];
        for (int k = c->found.count[b] - 1; k >= 0; k--) {
            while (kept && c->pairs.pair[kept - 1].key > found[k].key)
                c->pairs.pair[--to] = c->pairs.pair[--kept];
            c->pairs.pair[--to] = found[k];
        }
    }
}

void contact_measure_moved(struct contact *c, const double *x) {
    for (int i = 0; i < c->points; i++)
        c->pairs.moved[i] = vec3_distance(x + 3 * i, c->pairs.seen + 3 * i);
}

/* Finds the pairs of all points that have changed anew; the others stay. */
static pdyn_status update_list(struct contact *c) {
    long count = 0;
    if (c->broad.all_changed)
        memcpy(c->pairs.seen, c->broad.built, 3 * (size_t)c->points * sizeof *c->pairs.seen);
    contact_measure_moved(c, c->broad.built);
    contact_update_trees(c);
    drop_changed(c);
    pdyn_status status = search(c);
    if (status != PDYN_OK) return status;
    for (int b = 0; b < c->found.blocks; b++) count += c->found.count[b];
    if (count + c->pairs.count > INT32_MAX / 4)
        return set_error(PDYN_DIVERGED, "contact: %ld pairs are close", count);
    status = reserve(c, c->pairs.count + (int)count);
    if (status == PDYN_OK) merge(c, (int)count);
    return status;
}

pdyn_status contact_list(struct contact *c) {
    c->broad.all_changed = true;
    for (int i = 0; i < c->points; i++) c->broad.changed[i] = true;
    return update_list(c);
}

pdyn_status contact_cover(struct contact *c, const double *x, const double *step) {
    if (contact_update_regions(c, x, step)) {
        pdyn_status status = update_list(c);
        if (status != PDYN_OK) return status;
    }
    contact_measure_moved(c, x);
    return PDYN_OK;
}
