/* Bounding volume hierarchy against a search over all pairs. */
#include "geometry/bvh_join.h"
#include "support.h"

static struct box random_box(uint64_t *seed, double size) {
    struct box box;
    for (int a = 0; a < 3; a++) {
        box.min[a] = test_random(seed);
        box.max[a] = box.min[a] + size * (1.0 + test_random(seed));
    }
    return box;
}

struct found {
    int count;
    bool has[1000];
};

static void note(void *user, int id) {
    struct found *found = user;
    assert_false(found->has[id]);
    found->has[id] = true;
    found->count++;
}

/* Boxes of one owner are left out, those of none are not. */
static void check_others(const struct bvh *tree, const struct box *box, const struct box *query) {
    for (int owner = -1; owner < 3; owner++) {
        struct found found = {0};
        int expected = 0;
        bvh_visit_others(tree, query, owner, note, &found);
        for (int i = 0; i < tree->count; i++)
            expected += box_overlaps(&box[i], query) && (owner < 0 || tree->owner[i] != owner);
        assert_int_equal(found.count, expected);
    }
}

static void check_set(int count, double size, uint64_t seed) {
    enum { ROOM = 1000 };
    pdyn_context *context = test_context(1);
    struct box box[ROOM];
    int owner[ROOM];
    struct bvh tree;
    for (int i = 0; i < count; i++) owner[i] = i / 100 % 4 - 1;
    for (int i = 0; i < count; i++) box[i] = random_box(&seed, i % 50 ? size : 2.0);
    assert_int_equal(bvh_create(context, count + 3, &tree), PDYN_OK);
    tree.owner = owner;
    for (int again = 0; again < 2; again++) {
        bvh_build(&tree, box, count);
        for (int q = 0; q < 100; q++) {
            struct box query = random_box(&seed, size);
            struct found found = {0};
            int expected = 0;
            bvh_visit(&tree, &query, note, &found);
            for (int i = 0; i < count; i++) {
                if (!box_overlaps(&box[i], &query)) continue;
                assert_true(found.has[i]);
                expected++;
            }
            assert_int_equal(found.count, expected);
            check_others(&tree, box, &query);
        }
        for (int i = 0; i < count; i++) box[i] = random_box(&seed, size);
    }
    bvh_free(context, &tree);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_queries(void **state) {
    (void)state;
    static const int counts[] = {0, 1, 3, 4, 5, 17, 64, 333, 1000};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        check_set(counts[k], 0.1, 1 + k);
        check_set(counts[k], 0.0, 2 + k);
        check_set(counts[k], 1.0, 3 + k);
    }
}

/* A hierarchy of every third box finds those and no other. */

enum { SIDE = 400 };

struct side { /* of a join */
    struct box box[SIDE];
    int owner[SIDE];
    bool changed[SIDE];
    struct bvh tree;
};

/* One box of ten is empty. */
static void move_some(struct side *side, int count, uint64_t *seed) {
    for (int i = 0; i < count; i++) {
        side->changed[i] = test_random(seed) < 0.1;
        if (!side->changed[i]) continue;
        side->box[i] = test_random(seed) < 0.1 ? box_empty : random_box(seed, 0.05);
    }
}

static void make_side(pdyn_context *context, struct side *side, int count, uint64_t *seed) {
    *side = (struct side){0};
    assert_int_equal(bvh_create(context, count, &side->tree), PDYN_OK);
    side->tree.owner = side->owner;
    for (int i = 0; i < count; i++) side->owner[i] = i / 40 % 3 - 1;
    for (int i = 0; i < count; i++) side->box[i] = random_box(seed, 0.05), side->changed[i] = true;
    move_some(side, count, seed);
    for (int i = 0; i < count; i++) side->changed[i] = true;
    bvh_build(&side->tree, side->box, count);
}

static bool note_pair(void *user, int a, int b) {
    ((unsigned char(*)[SIDE])user)[a][b]++;
    return true;
}

static bool stop_at_first(void *user, int a, int b) {
    (void)a, (void)b;
    return ++*(int *)user < 1;
}

/* Every pair of overlapping boxes with a change is found once. */
static void check_join(const struct side *a, const struct side *b) {
    static unsigned char found[SIDE][SIDE];
    struct group_pair part[BVH_PARTS];
    const struct bvh_join join = {{&a->tree, &b->tree}};
    int parts = bvh_join_divide(&join, part);
    memset(found, 0, sizeof found);
    assert_in_range(parts, 0, BVH_PARTS);
    for (int k = 0; k < parts; k++) {
        int visits = 0;
        bvh_join_visit(&join, part[k], note_pair, found);
        bvh_join_visit(&join, part[k], stop_at_first, &visits);
        assert_in_range(visits, 0, 1);
    }
    for (int i = 0; i < a->tree.count; i++)
        for (int k = a == b ? i : 0; k < b->tree.count; k++) {
            bool others = a->owner[i] < 0 || a->owner[i] != b->owner[k];
            bool expected = others && (a->changed[i] || b->changed[k]) &&
                            box_overlaps(&a->box[i], &b->box[k]) && !(a == b && i == k);
            int times = found[i][k] + (a == b && i != k ? found[k][i] : 0);
            assert_int_equal(times, expected);
        }
}

/* Hierarchies of different height, and of one with itself, as built and after changes. */
static void test_join(void **state) {
    (void)state;
    static const int counts[][2] = {{1, 1}, {400, 3}, {5, 400}, {64, 65}, {400, 399}, {0, 7}};
    static struct side a, b;
    pdyn_context *context = test_context(1);
    uint64_t seed = 5;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        make_side(context, &a, counts[k][0], &seed), make_side(context, &b, counts[k][1], &seed);
        for (int again = 0; again < 4; again++) {
            check_join(&a, &b), check_join(&a, &a);
            move_some(&a, counts[k][0], &seed), move_some(&b, counts[k][1], &seed);
            bvh_refit(&a.tree, a.box, a.changed), bvh_refit(&b.tree, b.box, b.changed);
        }
        bvh_free(context, &a.tree), bvh_free(context, &b.tree);
    }
    pdyn_destroy(context);
}

/* All boxes at one place. */
static void test_heap(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct box box[100];
    struct bvh tree;
    struct found found = {0};
    for (int i = 0; i < 100; i++) box[i] = (struct box){{1, 1, 1}, {1, 1, 1}};
    assert_int_equal(bvh_create(context, 100, &tree), PDYN_OK);
    bvh_build(&tree, box, 100);
    bvh_visit(&tree, &box[0], note, &found);
    assert_int_equal(found.count, 100);
    bvh_free(context, &tree);
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_queries),
        cmocka_unit_test(test_join),
        cmocka_unit_test(test_heap),
    };
    return cmocka_run_group_tests_name("boxes", tests, NULL, NULL);
}
