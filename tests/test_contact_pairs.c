/* The list of close pairs: after any motion of few or many points it is what a search from the
 * regions alone finds, and no pair in contact is missing. */
#include "contact/contact_parts.h"
#include "scene_support.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 20000 /* faces, edges of the scene */ };

/* Two sheets above a ball, a bar that moves, and drops that do not exist yet. */
static const char scene[] =
    "{'duration': 10, 'frame_interval': 0.01, 'contact': {'thickness': 0.01}, 'bodies': [\n"
    "{'surface': {'grid': {'size': [0.5, 0.5], 'vertices': [8, 8]}, 'translate': [0.01, 0.16, "
    "0.02], 'area_density': 0.2}, 'constraints': [{'type': 'spring', 'stretching_stiffness': "
    "500}]},\n"
    "{'surface': {'grid': {'size': [0.5, 0.5], 'vertices': [9, 9]}, 'translate': [0.01, 0.165, "
    "0.02], 'area_density': 0.2}, 'constraints': [{'type': 'spring', 'stretching_stiffness': "
    "500}]},\n"
    "{'name': 'water', 'constraints': [{'type': 'fluid'}], 'particles': {'radius': 0.02, "
    "'budget': %d, 'fill': [{'box': {'minimum': [0, 0.2, 0], 'maximum': [0.08, 0.28, 0.08]"
    "}}],\n'inlets': [{'disc': {'center': [0, 0.5, 0], 'radius': 0.05}, 'direction': [0, -1, 0], "
    "'speed': 1}]}}],\n"
    "'solids': [{'name': 'ball', 'sphere': {'center': [0, 0, 0], 'radius': 0.15}},\n"
    "{'name': 'bar', 'capsule': {'from': [-0.2, 0.3, 0], 'to': [0.2, 0.3, 0], 'radius': 0.03}, "
    "'motion': [{'time': 0}, {'time': 1, 'translate': [0, -0.1, 0]}]}]}";

struct trial {
    pdyn_context *context;
    pdyn_sim *sim;
    struct contact *contact;
};

/* budget: particles that exist or not. */
static struct trial start(pdyn_context *x, int budget) {
    struct trial t = {.context = x};
    char text[2048];
    snprintf(text, sizeof text, scene, budget);
    t.sim = test_load(t.context, quoted(text));
    t.contact = t.sim->objective.contact;
    return t;
}

static void finish(struct trial *t) { test_close(t->sim); }

static int compare_keys(const void *a, const void *b) {
    const struct pair *p = a, *q = b;
    return (p->key > q->key) - (p->key < q->key);
}

/* A copy of the list, sorted by keys. */
static struct pair *copy_of_pairs(const struct contact *c) {
    struct pair *pair = malloc((size_t)c->pairs.count * sizeof *pair + 1);
    assert_non_null(pair);
    memcpy(pair, c->pairs.pair, (size_t)c->pairs.count * sizeof *pair);
    qsort(pair, (size_t)c->pairs.count, sizeof *pair, compare_keys);
    return pair;
}

/* The list is that of a search for the pairs of all points. */
static void check_list(struct contact *c) {
    struct pair *pair = copy_of_pairs(c);
    int pairs = c->pairs.count;
    assert_int_equal(contact_search_pairs(c), PDYN_OK);
    assert_int_equal(c->pairs.count, pairs);
    struct pair *all = copy_of_pairs(c);
    for (int k = 0; k < pairs; k++) {
        assert_true(pair[k].key == all[k].key);
        assert_true(pair[k].thickness == all[k].thickness);
    }
    free(pair), free(all);
}

static bool share_a_point(const int *a, int points, const int *b, int others) {
    for (int k = 0; k < points; k++)
        for (int m = 0; m < others; m++)
            if (a[k] == b[m]) return true;
    return false;
}

/* Whether the primitives are in contact: 1 or 0. a, b: their points. */
static int touch(const struct contact *c, const struct pair_kind *kind, const int *a,
                 const int *b) {
    int points = kind->first, one = c->group[a[0]], other = c->group[b[0]], all[4];
    const double *x[4], *rest[4];
    double unused[4], T = fmin(c->thickness[one], c->thickness[other]);
    if (share_a_point(a, points, b, 4 - points)) return 0;
    memcpy(all, a, (size_t)points * sizeof *a);
    memcpy(all + points, b, (size_t)(4 - points) * sizeof *b);
    pair_load(all, c->at, x);
    pair_load(all, c->rest, rest);
    if (one == other) T = fmin(T, 0.9 * sqrt(kind->closest(rest, unused)));
    return sqrt(kind->closest(x, unused)) < T;
}

static bool exists(const struct contact *c, int point) {
    if (c->group[point] < 0) return false;
    return point < c->vertices || point >= c->free || c->live[c->column[point]];
}

/* The boxes around primitives, and whether two are further apart along an axis than the points of
 * contacts may be. */
static void wrap(const struct contact *c, const int *point, int points, int count,
                 struct box *box) {
    for (int k = 0; k < count; k++) {
        box[k] = box_empty;
        for (int m = 0; m < points; m++) box_add(&box[k], c->at + 3 * point[points * k + m]);
    }
}
static bool apart(const struct box *a, const struct box *b, double T) {
    for (int k = 0; k < 3; k++)
        if (a->min[k] - b->max[k] > T || b->min[k] - a->max[k] > T) return true;
    return false;
}

/* The number of contacts, from all points and faces and all edges. A point touches one face of a
 * flat part, and sides within it touch nothing. */
static int count_contacts(const struct contact *c) {
    static struct box face[MOST], edge[MOST];
    static int touched[MOST]; /* by the first face of a flat part: the last point that touches it */
    double T = c->settings->thickness;
    int count = 0;
    assert_true(c->faces <= MOST && c->edges <= MOST);
    wrap(c, c->face, 3, c->faces, face);
    wrap(c, c->edge, 2, c->edges, edge);
    for (int f = 0; f < c->faces; f++) touched[f] = -1;
    for (int i = 0; i < c->points; i++) {
        struct box box;
        wrap(c, &i, 1, 1, &box);
        for (int f = 0; exists(c, i) && f < (i < c->vertices ? c->faces : c->free_faces); f++)
            if (touched[c->flat.part[f]] != i && !apart(&box, &face[f], T) &&
                touch(c, &pair_vertex_face, &i, c->face + 3 * f))
                touched[c->flat.part[f]] = i, count++;
    }
    for (int a = 0; a < c->free_edges; a++)
        for (int b = a + 1; b < c->edges; b++)
            if (!c->flat.edge[a] && !c->flat.edge[b] && !apart(&edge[a], &edge[b], T))
                count += touch(c, &pair_edge_edge, c->edge + 2 * a, c->edge + 2 * b);
    return count;
}

/* Moves every point k with k % every == 0 by up to `size`, m, in each direction; solids stay. */
static void move_points(struct contact *c, int every, double size, uint64_t *seed) {
    for (int i = 0; i < c->free; i++)
        for (int a = 0; i % every == 0 && a < 3; a++) c->at[3 * i + a] += size * test_random(seed);
}

static void test_motion(void **state) {
    (void)state;
    struct trial t = start(test_context(1), 38);
    struct contact *c = t.contact;
    uint64_t seed = 5;
    int few = 0, most = 0;
    for (int k = 0; k < 40; k++) {
        move_points(c, k % 10 ? 40 : 1, k % 2 ? 0.012 : 0.002, &seed);
        assert_int_equal(contact_update_pairs(c, c->at, NULL), PDYN_OK);
        few += !c->broad.all_changed;
        assert_int_equal(contact_find(c), PDYN_OK);
        int count = c->current.view.count;
        if (k % 3 == 0) assert_int_equal(count, count_contacts(c));
        else if (k % 3 == 1) check_list(c);
        if (count > most) most = count;
    }
    assert_true(few > 25 && most > 100);
    finish(&t);
}

/* In steps, with particles that come into being. */
static void check_steps(int budget) {
    struct trial t = start(test_context(1), budget);
    int live = 0;
    check_list(t.contact);
    for (int k = 0; k < 40; k++) {
        test_step(t.sim);
        if (k % 8 == 0) assert_int_equal(t.contact->current.view.count, count_contacts(t.contact));
        check_list(t.contact);
    }
    for (int i = t.contact->vertices; i < t.contact->free; i++) live += exists(t.contact, i);
    assert_in_range(live, 9, 46);
    finish(&t);
}

static void test_steps(void **state) {
    (void)state;
    check_steps(38);
}

/* Most points are particles that do not exist, from the first search on. */
static void test_absent(void **state) {
    (void)state;
    check_steps(5000);
}

/* After a search without memory, the next one finds all pairs, although no point has left its
 * region since. */
static void test_search_after_a_failure(void **state) {
    (void)state;
    struct counter calls;
    struct trial t = start(test_counting_context(1, &calls), 38);
    struct contact *c = t.contact;
    for (int k = 0; k < 3 * c->vertices; k++) c->at[k] *= 0.5;
    test_allow(&calls, 0);
    assert_int_equal(contact_update_pairs(c, c->at, NULL), PDYN_NO_MEMORY);
    test_allow(&calls, -1);
    assert_int_equal(contact_update_pairs(c, c->at, NULL), PDYN_OK);
    assert_true(c->pairs.count > 0);
    check_list(c);
    finish(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_motion), cmocka_unit_test(test_steps),
                                       cmocka_unit_test(test_absent),
                                       cmocka_unit_test(test_search_after_a_failure)};
    return cmocka_run_group_tests_name("contact pairs", tests, NULL, NULL);
}
