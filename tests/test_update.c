/* Elements that come and go, of a type that a plug-in could have: what they are given, what they
 * leave to the next step, and what is refused. */
#include "support.h"

#include "projdyn/module.h"
#include "rows/batch.h"

#include <string.h>

/* ---- a floor whose elements are the points below it ------------------------------------------ */

struct params {
    double height;
};

static const pdyn_param params[] = {
    {"height", PDYN_REAL, offsetof(struct params, height), false, 0, -10, 10, "m", "of the floor"},
    {0}};

struct point { /* data of an element */
    int particle;
    double steps; /* for which the point has been below the floor, when the step begins */
};

static int below(const void *par, const pdyn_batch *b, const double *x, const double *v, int room) {
    double height = ((const struct params *)par)->height;
    int count = 0;
    (void)v;
    for (int i = b->body->first; i < b->body->first + b->body->count; i++) {
        if (x[3 * i + 1] >= height) continue;
        if (count < room) ((struct point *)b->data)[count].particle = i;
        if (count < room && b->key) b->key[count] = 1000u - (uint64_t)i;
        count++;
    }
    return count;
}

static void choose(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        struct point *point = (struct point *)b->data + e;
        b->column[e] = point->particle, b->coefficient[e] = 1.0;
        if (b->memory) point->steps = ((const double *)b->memory)[e];
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 5000.0;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) {
        memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *b->u);
        b->p[3 * e + 1] = fmax(b->u[3 * e + 1], ((const struct params *)par)->height);
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    for (int e = first; e < last; e++, J += 9)
        J[0] = J[8] = 1.0,
        J[4] = b->u[3 * e + 1] < ((const struct params *)par)->height ? 0.0 : 1.0;
}

static void end(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        ((double *)b->memory)[e] = ((const struct point *)b->data)[e].steps + 1.0;
}

static const pdyn_constraint_type always = {.name = "floor",
                                            .summary = "holds points above a height",
                                            .flags = PDYN_ANCHORED | PDYN_EVERY_ITERATION,
                                            .params_size = sizeof(struct params),
                                            .params = params,
                                            .data_size = sizeof(struct point),
                                            .update = below,
                                            .rows = 1,
                                            .width = 1,
                                            .select = choose,
                                            .weight = weight,
                                            .project = project,
                                            .tangent = tangent};

static pdyn_constraint_type type;
static const pdyn_constraint_type *const types[] = {&type, NULL};
static const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};

#define SHEET(solver)                                                                              \
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.01}, \"frame_interval\": 0.01, \"solver\":"    \
    " {" solver "}, \"bodies\": [{\"name\": \"b\", \"surface\": {\"grid\": {\"size\": [1, 1],"     \
    " \"vertices\": [7, 7]}, \"rotate\": [10, 0, 5], \"translate\": [0, 0.1, 0],"                  \
    " \"area_density\": 1}, \"constraints\": [{\"type\": \"spring\", \"stretching_stiffness\":"    \
    " 500}, {\"type\": \"floor\"}]}]}"

static const struct batch *floor_of(const pdyn_sim *sim) { return sim->objective.batch[1]; }

/* ---- every local step ------------------------------------------------------------------------ */

static int most_of(int a, int b) { return a > b ? a : b; }

/* Points enter the floor, are held, and leave it; a warmed-up step allocates nothing. */
static void test_comes_and_goes(void **state) {
    (void)state;
    struct counter counter;
    int most = 0;
    type = always;
    pdyn_context *context = test_counting_context(2, &counter);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim = test_load(context, SHEET("\"tolerance\": 1e-8, \"outer_iterations\": 50"));
    assert_int_equal(floor_of(sim)->view.elements, 0);
    for (int k = 0; k < 40; k++) {
        test_step(sim);
        most = most_of(most, floor_of(sim)->view.elements);
    }
    assert_true(most > 10);
    for (int i = 0; i < 49; i++) assert_true(sim->x[3 * i + 1] > -0.02);
    test_allow(&counter, 0);
    for (int k = 0; k < 5; k++) test_step(sim);
    test_allow(&counter, -1);
    for (int i = 0; i < 49; i++) sim->v[3 * i + 1] = 5.0;
    for (int k = 0; k < 3; k++) test_step(sim);
    assert_int_equal(floor_of(sim)->view.elements, 0);
    test_close(sim);
}

static pdyn_status load_and_step(const void *what) {
    pdyn_sim *sim = NULL;
    pdyn_context *context = *(pdyn_context *const *)what;
    pdyn_status status = pdyn_load_text(context, SHEET(""), "sheet", NULL, 0, &sim);
    for (int k = 0; k < 15 && status == PDYN_OK; k++) status = pdyn_step(sim, NULL);
    if (status == PDYN_OK) assert_true(floor_of(sim)->view.elements > 0);
    pdyn_free(sim);
    return status;
}

/* Memory that fails at any moment is an error, also where elements come. */
static void test_no_memory(void **state) {
    (void)state;
    struct counter counter;
    type = always, type.flags = PDYN_ANCHORED;
    type.memory_size = sizeof(double), type.end = end;
    pdyn_context *context = test_counting_context(1, &counter);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    assert_true(test_failing_allocations(context, &counter, load_and_step, &context) > 50);
    pdyn_destroy(context);
}

/* Solvers find the same, whether they factor or not. */
static void test_solvers(void **state) {
    (void)state;
    static const char *const scene[] = {
        SHEET("\"type\": \"cg\", \"tolerance\": 1e-9, \"outer_iterations\": 100"),
        SHEET("\"type\": \"hybrid\", \"tolerance\": 1e-9, \"outer_iterations\": 100"),
        SHEET("\"type\": \"cholesky\", \"tolerance\": 1e-9, \"outer_iterations\": 100"),
        SHEET("\"type\": \"cholesky\", \"step\": \"projective\", \"tolerance\": 1e-9,"
              " \"outer_iterations\": 3000")};
    double x[3 * 49];
    type = always;
    for (int k = 0; k < 4; k++) {
        if (test_lacks_solver(scene[k])) continue;
        pdyn_context *context = test_context(1);
        assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
        pdyn_sim *sim = test_load(context, scene[k]);
        for (int step = 0; step < 15; step++) assert_true(test_step(sim).step_residual < 1e-8);
        if (k == 0) memcpy(x, sim->x, sizeof x);
        assert_true(floor_of(sim)->view.elements > 0);
        assert_true(test_distance(x, sim->x, 3 * 49) < 1e-6);
        test_close(sim);
    }
}

/* ---- the beginning of a step, and memory ----------------------------------------------------- */

static pdyn_context *remembering_context(void) {
    pdyn_context *context = test_context(1);
    type = always;
    type.flags = PDYN_ANCHORED, type.memory_size = sizeof(double), type.end = end;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    return context;
}

/* An element finds what was left under its key, though it is another element of the batch; one that
 * is new, or was away for a step, finds nothing. */
static void test_memory(void **state) {
    (void)state;
    pdyn_context *context = remembering_context();
    pdyn_sim *sim = test_load(context, SHEET("\"tolerance\": 1e-6"));
    double expected[49] = {0};
    int looked = 0;
    for (int k = 0; k < 30; k++) {
        bool was_below[49];
        if (k == 20) sim->x[1] = 0.3, sim->x[4] = -0.01; /* one leaves, one comes */
        for (int i = 0; i < 49; i++) was_below[i] = sim->x[3 * i + 1] < 0.0;
        test_step(sim);
        const pdyn_batch *view = &floor_of(sim)->view;
        for (int e = 0; e < view->elements; e++) {
            const struct point *point = (const struct point *)view->data + e;
            assert_true(was_below[point->particle]);
            assert_true(point->steps == expected[point->particle]);
            looked += point->steps > 0.0;
        }
        for (int i = 0; i < 49; i++) expected[i] = was_below[i] ? expected[i] + 1.0 : 0.0;
    }
    assert_true(looked > 20);
    test_close(sim);
}

/* What elements leave is part of a saved state. */
static void test_saved(void **state) {
    (void)state;
    pdyn_context *context = remembering_context();
    pdyn_sim *one = test_load(context, SHEET("\"tolerance\": 1e-6"));
    pdyn_sim *other = test_load(context, SHEET("\"tolerance\": 1e-6"));
    for (int k = 0; k < 20; k++) test_step(one);
    assert_int_equal(pdyn_save(one, "state"), PDYN_OK);
    assert_int_equal(pdyn_restore(other, "state"), PDYN_OK);
    for (int k = 0; k < 3; k++) test_step(one), test_step(other);
    assert_true(pdyn_state_hash(one) == pdyn_state_hash(other));
    const pdyn_batch *a = &floor_of(one)->view, *b = &floor_of(other)->view;
    assert_true(a->elements > 0 && a->elements == b->elements);
    assert_memory_equal(a->memory, b->memory, (size_t)a->elements * sizeof(double));
    pdyn_free(one), pdyn_free(other);
    pdyn_destroy(context);
    test_remove_file("state");
}

/* ---- what is refused ------------------------------------------------------------------------- */

static int count_of_all, particle_of_all;
static double weight_of_all;

static int some(const void *par, const pdyn_batch *b, const double *x, const double *v, int room) {
    (void)par, (void)b, (void)x, (void)v, (void)room;
    return count_of_all;
}

static void some_select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = particle_of_all, b->coefficient[e] = 1.0;
}

static void some_weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = weight_of_all;
}

static void refuse_type(const char *why) {
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim = test_load(context, SHEET(""));
    assert_int_equal(pdyn_step(sim, NULL), PDYN_BAD_INPUT);
    assert_error(why);
    test_close(sim);
}

static void refuse(int count, int particle, double heavy, const char *why) {
    count_of_all = count, particle_of_all = particle, weight_of_all = heavy;
    type = always, type.update = some, type.select = some_select, type.weight = some_weight;
    refuse_type(why);
}

static int one(const void *par, const pdyn_body *body) {
    (void)par, (void)body;
    return 1;
}

static void begin_nothing(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

static void weight_in_steps(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = b->h > 0.0 ? weight_of_all : 1.0;
}

/* Weights that follow from `begin`. */
static void refuse_in_begin(double heavy, const char *why) {
    particle_of_all = 0, weight_of_all = heavy;
    type = always, type.flags = PDYN_ANCHORED, type.update = NULL, type.elements = one;
    type.select = some_select, type.weight = weight_in_steps, type.begin = begin_nothing;
    refuse_type(why);
}

static void test_refused(void **state) {
    (void)state;
    refuse(-1, 0, 1.0, "constraint \"floor\" on body \"b\": it has -1 elements");
    refuse(INT32_MAX, 0, 1.0, "constraint \"floor\" on body \"b\": it has too many rows");
    refuse(2, 49, 1.0, "element 0 selects particle 49, expected 0 to 48");
    refuse(2, -1, 1.0, "element 0 selects particle -1, expected 0 to 48");
    refuse(2, 0, NAN, "element 0 has the weight nan, expected a finite one");
    refuse_in_begin(-1.0, "element 0 has the weight -1, expected a finite one of at least 0");
    refuse_in_begin(INFINITY, "element 0 has the weight inf, expected a finite one");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_comes_and_goes), cmocka_unit_test(test_solvers),
        cmocka_unit_test(test_no_memory),      cmocka_unit_test(test_memory),
        cmocka_unit_test(test_saved),          cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests_name("update", tests, test_enter_directory, test_leave_directory);
}
