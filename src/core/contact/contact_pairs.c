/* Broad phase: the list of pairs that may come into contact. Pairs whose boxes around their regions
 * (contact_regions.c) overlap and that can come closer than their thickness are listed; the list is
 * complete while every point is in its region.
 *
 * Only the pairs of points with new regions are searched anew: most searches of an impact are for a
 * few of thousands of points. The set of pairs depends on the regions alone; their order depends on
 * threads and earlier lists, too. contact_find.c sorts the contacts. */
#include "contact_parts.h"

#include "base/machine_memory.h"
#include "geometry/bvh_join.h"
#include "projdyn/vec3.h"

#include <string.h>

/* ---- pairs ----------------------------------------------------------------------------------- */

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

/* Whether the pair is a particle of a fluid and a face that it passes. */
static bool is_passed(const struct contact *c, const struct pair *p) {
    return is_particle(c, p->point[0]) && c->permeable[c->group[p->point[3]]];
}

/* Distance in the rest shape, over the thickness, up to which two parts of a body count as joined:
 * the vertices along a seam, or the layers of a mesh that is folded flat. */
static const double joined = 1e-2;

/* Whether the pair can come closer than its thickness while its points are in their regions. Sets
 * its thickness, and a lower bound of its distance at pairs.seen: the distance where the regions
 * were set, less how far the points moved between the two (pairs.moved). Within a body the
 * thickness is less than the distance in the rest shape, so that the rest shape has no contact
 * forces; parts that are joined are no pair. */
static bool close_enough(const struct contact *c, struct pair *p) {
    int first = pair_kind_of(p->key)->first;
    bool same = c->group[p->point[0]] == c->group[p->point[3]];
    if (share_point(p->point, first) || is_passed(c, p)) return false;
    double distance = distance_in(p, c->broad.built);
    p->thickness = fmin(c->thickness[c->group[p->point[0]]], c->thickness[c->group[p->point[3]]]);
    double nearest = distance - pair_largest(p, c->broad.reach);
    if (nearest > p->thickness) return false;
    p->distance = distance - pair_largest(p, c->pairs.moved);
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

/* ---- the search ------------------------------------------------------------------------------ */

enum { TASKS = 4 };     /* of a parallel block */
enum { GATHERED = 64 }; /* pairs of a task before they go to the list */

struct search { /* of pairs of one kind of primitive with another one */
    struct bvh_join join;
    bool edges;
    int first[2]; /* numbers of the first boxes of the two trees */
};

enum { SEARCHES = 5 };

struct searches {
    struct contact *contact;
    struct search search[SEARCHES];
    int tasks; /* parts of searches */
    struct task {
        const struct search *search;
        struct group_pair part;
    } task[SEARCHES * BVH_PARTS];
    atomic_long found; /* new pairs, also those that the list has no room for */
    long limit;        /* pairs of the list: beyond, the search ends */
};

struct gathered { /* new pairs of a task */
    struct searches *all;
    const struct search *search;
    int count;
    struct pair pair[GATHERED];
};

/* Counts the gathered pairs, which are near each other, for the groups of one of them. */
static void count_groups(const struct gathered *g) {
    const struct contact *c = g->all->contact;
    int one = c->group[g->pair[0].point[0]], other = c->group[g->pair[0].point[3]];
    atomic_fetch_add(&c->pairs.of_group[one], g->count);
    if (other != one) atomic_fetch_add(&c->pairs.of_group[other], g->count);
}

/* Appends the gathered pairs to the list; where it has no room, they are counted only. false: there
 * are more than the limit. */
static bool add_to_list(struct gathered *g) {
    struct pair_list *list = &g->all->contact->pairs;
    long at = list->count + atomic_fetch_add(&g->all->found, g->count);
    count_groups(g);
    if (at + g->count <= list->room)
        memcpy(list->pair + at, g->pair, (size_t)g->count * sizeof *g->pair);
    at += g->count, g->count = 0;
    return at <= g->all->limit;
}

/* Gathers the pair of box a of the first tree and box b of the second one, if it can come close. */
static bool gather_pair(void *user, int a, int b) {
    struct gathered *g = user;
    a += g->search->first[0], b += g->search->first[1];
    bool swap = g->search->edges && b < a;
    struct pair *p = &g->pair[g->count];
    *p = make_pair(g->all->contact, g->search->edges, swap ? b : a, swap ? a : b);
    bool full = close_enough(g->all->contact, p) && ++g->count == GATHERED;
    return !full || add_to_list(g);
}

static void do_tasks(void *arg, int first, int last, int block) {
    struct searches *all = arg;
    (void)block;
    struct gathered g; /* 3 kB, not set to 0 */
    g.all = all, g.count = 0;
    for (int k = first; k < last; k++) {
        g.search = all->task[k].search;
        bvh_join_visit(&g.search->join, all->task[k].part, gather_pair, &g);
        if (g.count) add_to_list(&g);
    }
}

/* Solids act on fluids by their samples, and not on each other. */
static void list_tasks(struct contact *c, struct searches *all) {
    struct broad_phase *b = &c->broad;
    int solid_faces = c->free_faces, solid_edges = c->free_edges;
    struct search search[SEARCHES] = {
        {{{&b->vertex_tree, &b->face_tree[0]}}, false, {0, 0}},
        {{{&b->vertex_tree, &b->face_tree[1]}}, false, {0, solid_faces}},
        {{{&b->other_tree, &b->face_tree[0]}}, false, {c->vertices, 0}},
        {{{&b->edge_tree[0], &b->edge_tree[0]}}, true, {0, 0}},
        {{{&b->edge_tree[0], &b->edge_tree[1]}}, true, {0, solid_edges}},
    };
    memcpy(all->search, search, sizeof search);
    all->contact = c, all->tasks = 0;
    for (int k = 0; k < SEARCHES; k++) {
        struct group_pair part[BVH_PARTS];
        int parts = bvh_join_divide(&all->search[k].join, part);
        for (int m = 0; m < parts; m++)
            all->task[all->tasks++] = (struct task){&all->search[k], part[m]};
    }
}

/* ---- the list -------------------------------------------------------------------------------- */

/* The pairs have an array of their own: they stay where the others grow. */
static bool resize_arrays(struct contact *c, enum array_action action) {
    int blocks = pool_blocks(c->pairs.room, CONTACT_GRAIN);
    const struct array_entry table[] = {
        ARRAY(c->hits.hit, c->pairs.room),    ARRAY(c->hits.count, blocks),
        ARRAY(c->hits.sorted, c->pairs.room), ARRAY(c->path.candidate, c->pairs.room),
        ARRAY(c->path.candidates, blocks),    ARRAY(c->path.blocked, c->pairs.room),
        ARRAY(c->path.blocked_count, blocks),
    };
    return context_arrays(c->context, table, ARRAY_ROWS(table), action);
}

void contact_free_pairs(struct contact *c) {
    resize_arrays(c, ARRAYS_FREE);
    FREE_ARRAY(c->context, c->pairs.pair, c->pairs.room);
}

/* Bytes of a pair in all arrays with room for it. */
static const double pair_memory = sizeof(struct pair) + sizeof(struct hit) + sizeof(struct keyed) +
                                  sizeof(int) + sizeof(struct blocked);

/* The body or solid with the most new pairs. */
static const char *most_pairs(const struct contact *c) {
    int most = 0;
    for (int g = 1; g < c->groups; g++)
        if (c->pairs.of_group[g] > c->pairs.of_group[most]) most = g;
    return c->name[most];
}

static const int spare_room = 4; /* a list that grows gets room for a part of this more */

/* The largest number of pairs: those that the machine has memory for, as many systems grant more
 * memory than there is, and then stop the program without a message. */
static long largest_count(const struct contact *c) {
    double left = machine_memory() - (double)pdyn_bytes_in_use(c->context);
    double pairs = left / (pair_memory * (1.0 + 1.0 / spare_room));
    return (long)fmax(c->pairs.room, fmin(pairs, INT32_MAX / 4));
}

static pdyn_status too_many(const struct contact *c, long limit) {
    return set_error(
        PDYN_BAD_INPUT,
        "more than %ld pairs of a vertex and a triangle, or of two edges, most of them of "
        "\"%s\", can come closer than the thickness of %g m; there is no room for more than these, "
        "which take %.2g GB: expected a smaller \"thickness\" or coarser meshes",
        limit, most_pairs(c), c->settings->thickness, (double)limit * pair_memory * 1e-9);
}

/* Makes room for `count` pairs; those in the list stay. PDYN_NO_MEMORY: nothing has changed. */
static pdyn_status reserve(struct contact *c, int count) {
    if (count <= c->pairs.room) return PDYN_OK;
    struct contact grown = *c;
    grown.pairs.room = count + count / spare_room;
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

void contact_measure_moved(struct contact *c, const double *x) {
    for (int i = 0; i < c->points; i++)
        c->pairs.moved[i] = vec3_distance(x + 3 * i, c->pairs.seen + 3 * i);
}

/* Adds the new pairs to the list; again with more room if it has too little. */
static pdyn_status add_new(struct contact *c) {
    struct searches all;
    list_tasks(c, &all);
    all.limit = largest_count(c);
    for (;;) {
        atomic_init(&all.found, 0);
        for (int g = 0; g < c->groups; g++) atomic_init(&c->pairs.of_group[g], 0);
        pool_for(c->context->pool, all.tasks, TASKS, do_tasks, &all);
        long count = c->pairs.count + atomic_load(&all.found);
        if (count > all.limit) return too_many(c, all.limit);
        bool fits = count <= c->pairs.room;
        if (fits) c->pairs.count = (int)count;
        pdyn_status status = reserve(c, (int)count);
        if (fits || status != PDYN_OK) return status;
    }
}

/* Finds the pairs of all points that have changed anew; the others stay. */
static pdyn_status update_list(struct contact *c) {
    if (c->broad.all_changed)
        memcpy(c->pairs.seen, c->broad.built, 3 * (size_t)c->points * sizeof *c->pairs.seen);
    contact_measure_moved(c, c->broad.built);
    contact_update_trees(c);
    drop_changed(c);
    c->pairs.complete = false;
    pdyn_status status = add_new(c);
    c->pairs.complete = status == PDYN_OK;
    return status;
}

pdyn_status contact_search_pairs(struct contact *c) {
    c->broad.all_changed = true;
    for (int i = 0; i < c->points; i++) c->broad.changed[i] = true;
    return update_list(c);
}

pdyn_status contact_update_pairs(struct contact *c, const double *x, const double *step) {
    if (contact_update_regions(c, x, step)) {
        pdyn_status status = update_list(c);
        if (status != PDYN_OK) return status;
    }
    contact_measure_moved(c, x);
    return PDYN_OK;
}
