/* Bounding volume hierarchy against a search over all pairs. */
#include "geometry/bvh.h"
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
static void check_others(const struct bvh *tree, const struct box *box, const struct box *query,
                         int from) {
    for (int owner = -1; owner < 3; owner++) {
        struct found found = {0};
        int expected = 0;
        bvh_visit_others(tree, query, from, owner, note, &found);
        for (int i = from; i < tree->count; i++)
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
        bvh_build(&tree, box, count, NULL);
        for (int q = 0; q < 100; q++) {
            struct box query = random_box(&seed, size);
            struct found found = {0};
            int from = q % 3 * count / 3, expected = 0;
            bvh_visit(&tree, &query, from, note, &found);
            for (int i = from; i < count; i++) {
                if (!box_overlaps(&box[i], &query)) continue;
                assert_true(found.has[i]);
                expected++;
            }
            assert_int_equal(found.count, expected);
            check_others(&tree, box, &query, from);
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
static void test_chosen(void **state) {
    (void)state;
    enum { COUNT = 500 };
    pdyn_context *context = test_context(1);
    struct box box[COUNT];
    bool chosen[COUNT];
    uint64_t seed = 7;
    struct bvh tree;
    for (int i = 0; i < COUNT; i++) box[i] = random_box(&seed, 0.1), chosen[i] = i % 3 == 1;
    assert_int_equal(bvh_create(context, COUNT, &tree), PDYN_OK);
    bvh_build(&tree, box, COUNT, chosen);
    for (int q = 0; q < 50; q++) {
        struct box query = random_box(&seed, 0.2);
        struct found found = {0};
        int expected = 0;
        bvh_visit(&tree, &query, 100, note, &found);
        for (int i = 100; i < COUNT; i++) {
            bool overlaps = chosen[i] && box_overlaps(&box[i], &query);
            assert_int_equal(found.has[i], overlaps);
            expected += overlaps;
        }
        assert_int_equal(found.count, expected);
    }
    bvh_free(context, &tree);
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
    bvh_build(&tree, box, 100, NULL);
    bvh_visit(&tree, &box[0], 10, note, &found);
    assert_int_equal(found.count, 90);
    bvh_free(context, &tree);
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_queries),
        cmocka_unit_test(test_chosen),
        cmocka_unit_test(test_heap),
    };
    return cmocka_run_group_tests_name("boxes", tests, NULL, NULL);
}
