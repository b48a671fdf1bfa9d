/* State of elements that always exist: the plastic strain of examples/plugin/plastic.c over
 * repeated steps, other parameters and saved states. */
#include "support.h"

#include "projdyn/control.h"
#include "projdyn/module.h"
#include "projdyn/vec3.h"
#include "rows/batch.h"

#include <stdio.h>
#include <string.h>

extern const pdyn_plugin pdyn_plugin_table;

/* Pins draw the right border of a square by a tenth of its side, and back. */
static const char scene[] =
    "{'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.01}, 'frame_interval': 0.01, "
    "'bodies': [{'name': 'sheet', 'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, "
    "'area_density': 1}, 'constraints': [{'type': 'plastic', 'stiffness': 1000, 'yield': 0.02}, "
    "{'type': 'pin', 'vertices': {'box': {'minimum': [-1, -1, -1], 'maximum': [-0.4, 1, 1]}}}, "
    "{'type': 'pin', 'vertices': {'box': {'minimum': [0.4, -1, -1], 'maximum': [1, 1, 1]}}, "
    "'path': [[0, 0, 0, 0], [0.3, 0.1, 0, 0], [0.6, 0, 0, 0]]}]}]}";

static pdyn_context *make_context(void) {
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &pdyn_plugin_table), PDYN_OK);
    return context;
}

/* Follows the strain of each edge, and compares what the edges have kept. Returns the largest. */
static double follow(const pdyn_sim *sim, double *kept) {
    const pdyn_batch *b = &sim->objective.batch[0]->view;
    double largest = 0.0;
    for (int e = 0; e < b->elements; e++) {
        const int *end = b->body->edge + 2 * e;
        double rest = vec3_distance(b->body->rest + 3 * end[0], b->body->rest + 3 * end[1]);
        double strain = vec3_distance(sim->x + 3 * end[0], sim->x + 3 * end[1]) / rest - 1.0;
        kept[e] = fmin(fmax(kept[e], strain - 0.02), strain + 0.02);
        assert_true(fabs(kept[e] - ((const double *)b->memory)[e]) < 1e-9);
        largest = fmax(largest, fabs(kept[e]));
    }
    return largest;
}

/* The solver of the simulation, of which every seventh call fails. */
static const pdyn_global_solver *own;
static int calls;

static pdyn_status fail_sometimes(void *self, double *b, double *y, const pdyn_stop *stop,
                                  int *iterations) {
    pdyn_status status = own->solve(self, b, y, stop, iterations);
    return ++calls % 7 ? status : PDYN_DIVERGED;
}

/* An attempt that fails leaves no trace. Edges that were stretched by a tenth are too long in the
 * end, and are compressed. */
static void test_repeated(void **state) {
    (void)state;
    double kept[64] = {0.0}, largest = 0.0;
    int retries = 0;
    pdyn_context *context = make_context();
    pdyn_sim *sim = test_load(context, scene);
    pdyn_global_solver failing = *(own = sim->solver);
    failing.solve = fail_sometimes, sim->solver = &failing;
    while (pdyn_time(sim) < 0.595) {
        retries += test_step(sim).retries;
        largest = fmax(largest, follow(sim, kept));
    }
    assert_true(retries > 3);
    assert_true(largest > 0.075 && largest < 0.085);
    test_close(sim);
}

/* Other parameters leave the memory. */
static void test_parameters(void **state) {
    (void)state;
    double before[64], *memory;
    pdyn_context *context = make_context();
    pdyn_sim *sim = test_load(context, scene);
    while (pdyn_time(sim) < 0.3) test_step(sim);
    memory = sim->objective.batch[0]->view.memory;
    memcpy(before, memory, (size_t)sim->objective.batch[0]->view.elements * sizeof *before);
    assert_int_equal(pdyn_set_parameter(sim, 0, "stiffness", (const double[]){2000.0}, 1), PDYN_OK);
    for (int e = 0; e < sim->objective.batch[0]->view.elements; e++)
        assert_true(memory[e] == before[e]);
    test_close(sim);
}

/* After the state is restored, steps give the same bits as without. */
static void test_saved(void **state) {
    (void)state;
    pdyn_context *context = make_context();
    pdyn_sim *first = test_load(context, scene), *second = test_load(context, scene);
    for (int k = 0; k < 25; k++) test_step(first);
    assert_int_equal(pdyn_save(first, "state"), PDYN_OK);
    assert_int_equal(pdyn_restore(second, "state"), PDYN_OK);
    for (int k = 0; k < 20; k++) test_step(first), test_step(second);
    assert_true(pdyn_state_hash(first) == pdyn_state_hash(second));
    pdyn_free(first), pdyn_free(second);
    pdyn_destroy(context);
    test_remove_file("state");
}

/* Edges grow by half of their length per second. */
static void grow(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) ((double *)b->memory)[e] += 0.5 * b->length;
}

/* State may give energy: no step of a free sheet that grows is refused, and none is warned of. */
static void test_growth(void **state) {
    (void)state;
    pdyn_constraint_type type = *pdyn_plugin_table.constraints[0];
    type.end = grow;
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "growth", types, NULL};
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim =
        test_load(context, "{'duration': 1, 'gravity': [0, 0, 0], 'bodies': [{'name': 'sheet', "
                           "'surface': {'grid': {'size': [1, 1], 'vertices': [5, 5]}, "
                           "'area_density': 1}, 'constraints': [{'type': 'plastic', "
                           "'stiffness': 1000}]}]}");
    while (pdyn_time(sim) < 0.3) assert_int_equal(test_step(sim).retries, 0);
    assert_null(pdyn_get_warning(sim, 0).code);
    test_close(sim);
}

static void begin_nothing(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

static void weight_of_time(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = b->time < 0.095 ? 1000.0 : 2000.0;
}

/* The counter of the values of H. */
static unsigned values_of(pdyn_sim *sim) {
    pdyn_matrix matrix;
    assert_int_equal(sim->model.model.matrix(&sim->model.model, &matrix), PDYN_OK);
    return matrix.values;
}

/* Weights that `begin` leaves as they are do not change H: a factor lasts until one changes. */
static void expect_values(void (*begin)(const void *, const pdyn_batch *, int, int)) {
    pdyn_constraint_type type = *pdyn_plugin_table.constraints[0];
    type.begin = begin, type.weight = weight_of_time;
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "weights", types, NULL};
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    char projective[1024];
    snprintf(projective, sizeof projective, "{'solver': {'step': 'projective'}, %s", scene + 1);
    pdyn_sim *sim = test_load(context, projective);
    for (int k = 0; k < 5; k++) test_step(sim);
    unsigned before = values_of(sim);
    while (pdyn_time(sim) < 0.085) test_step(sim);
    assert_int_equal(values_of(sim), before);
    test_step(sim);
    assert_int_equal(values_of(sim), before + 1);
    while (pdyn_time(sim) < 0.15) test_step(sim);
    assert_int_equal(values_of(sim), before + 1);
    test_close(sim);
}

static void test_same_weights(void **state) {
    (void)state;
    expect_values(begin_nothing);
    expect_values(weight_of_time);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_repeated),
                                       cmocka_unit_test(test_parameters),
                                       cmocka_unit_test(test_saved), cmocka_unit_test(test_growth),
                                       cmocka_unit_test(test_same_weights)};
    return cmocka_run_group_tests_name("state", tests, test_enter_directory, test_leave_directory);
}
