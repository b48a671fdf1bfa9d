/* Registration of plug-ins: which tables are refused; and the model that a solver gets. */
#include "support.h"

#include "base/registry.h"
#include "projdyn/module.h"

/* ---- tables that make no sense --------------------------------------------------------------- */

struct params {
    double stiffness, length;
    int count;
};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void fill(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    (void)par, (void)b, (void)x, (void)v, (void)room;
    return 0;
}

static bool is_linear(const void *par, const pdyn_batch *b) {
    (void)par, (void)b;
    return true;
}

static double damping(const void *par) { return ((const struct params *)par)->length; }

static const pdyn_param good_params[] = {
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), true, 0, 0, 1, "N/m", "its"}, {0}};

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par, (void)b, (void)first, (void)last, (void)J;
}

static const pdyn_constraint_type good = {.name = "mine",
                                          .summary = "does nothing",
                                          .params_size = sizeof(struct params),
                                          .params = good_params,
                                          .elements = elements,
                                          .rows = 1,
                                          .width = 1,
                                          .select = fill,
                                          .weight = fill,
                                          .project = fill};

static void refuse(const pdyn_plugin *plugin, const char *why) {
    pdyn_context *context = test_context(1);
    int before = context->plugins;
    assert_int_equal(pdyn_register(context, plugin), PDYN_BAD_INPUT);
    assert_error(why);
    assert_int_equal(context->plugins, before);
    pdyn_destroy(context);
}

static void refuse_type(pdyn_constraint_type type, const char *why) {
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    refuse(&plugin, why);
}

static void refuse_param(pdyn_param second, const char *why) {
    const pdyn_param params[] = {good_params[0], second, {0}};
    pdyn_constraint_type type = good;
    type.params = params;
    refuse_type(type, why);
}

/* In place of the parameters of a type without flags. */
static void refuse_table(pdyn_param_kind kind, double min, const char *why) {
    const pdyn_param params[] = {{"rows", kind, 0, false, 0, min, 1, "", ""}, {0}};
    pdyn_constraint_type type = good;
    type.params = params, type.params_size = sizeof(pdyn_table), type.flags = 0;
    refuse_type(type, why);
}

static void test_plugins(void **state) {
    (void)state;
    refuse(&(pdyn_plugin){PDYN_ABI + 1, "p", NULL, NULL}, "expected abi");
    refuse(&(pdyn_plugin){PDYN_ABI, "", NULL, NULL}, "no name");
    refuse(&(pdyn_plugin){PDYN_ABI, "p", NULL, NULL}, "no constraint and no solver");
    const pdyn_constraint_type *const twice[] = {&good, &good, NULL};
    refuse(&(pdyn_plugin){PDYN_ABI, "p", twice, NULL}, "the name \"mine\" is taken");
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(NULL, &registry_builtin), PDYN_BAD_CALL);
    assert_int_equal(pdyn_register(context, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_load_plugin(context, ""), PDYN_BAD_CALL);
    assert_int_equal(pdyn_load_plugin(context, "nowhere.so"), PDYN_BAD_INPUT);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_tables(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.name = "my constraint", refuse_type(t, "no name of 1 to 31");
    t = good, t.name = "spring", refuse_type(t, "the name \"spring\" is taken");
    t = good, t.name = "cg", refuse_type(t, "the name \"cg\" is taken");
    t = good, t.name = "auto", refuse_type(t, "the name \"auto\" is taken");
    t = good, t.summary = NULL, refuse_type(t, "no summary");
    t = good, t.params = NULL, refuse_type(t, "no table of parameters");
    t = good, t.project = NULL, refuse_type(t, "lacks one of");
    t = good, t.width = 0, refuse_type(t, "needs rows and width");
    t = good, t.damping = damping, refuse_type(t, "need each other");
    t = good, t.tangent = tangent, t.tangent_rank1 = tangent,
    refuse_type(t, "expected one of them at most");
    t.tangent_rank1 = NULL, t.flags = PDYN_NUMERIC_TANGENT;
    refuse_type(t, "PDYN_NUMERIC_TANGENT excludes tangent");
    t.tangent = NULL, t.rows = 13, refuse_type(t, "at most 12 rows");
    t = good, t.flags = PDYN_ON_PARTICLES | PDYN_ON_SURFACE, refuse_type(t, "no body is both");
    t = good, t.matrix_free = &(pdyn_operator){0}, refuse_type(t, "needs PDYN_ON_PARTICLES");
    t.flags = PDYN_ON_PARTICLES, refuse_type(t, "lacks a callback");
    t.begin = fill, refuse_type(t, "matrix_free excludes begin and damping");
    t = good, t.flags = PDYN_NEIGHBOURS, refuse_type(t, "needs PDYN_ON_PARTICLES");
    t = good, t.params_size = 4, refuse_type(t, "outside of params_size");
    t = good, t.end = fill, refuse_type(t, "need each other");
    t = good, t.end = fill, t.memory_size = 8, t.damping = damping, refuse_type(t, "excludes");
    t = good, t.flags = PDYN_EVERY_ITERATION, refuse_type(t, "need update");
    t = good, t.update = update, t.end = fill, refuse_type(t, "need each other");
    t = good, t.update = update, t.flags = PDYN_STEADY, refuse_type(t, "excludes PDYN_STEADY");
    t = good, t.flags = 2 * PDYN_STEADY, refuse_type(t, "a bit that module.h does not define");
    t = good, t.update = update, t.linear = is_linear, refuse_type(t, "update excludes");
    t = good, t.linear = is_linear, t.begin = fill, refuse_type(t, "linear excludes begin");
    t = good, t.update = update, t.begin = fill, t.flags = PDYN_EVERY_ITERATION;
    refuse_type(t, "excludes begin");
}

static void test_alternatives(void **state) {
    (void)state;
    static const pdyn_param params[] = {
        {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1, 0, 1, "N/m", "its"},
        {"length", PDYN_REAL, offsetof(struct params, length), false, 1, 0, 1, "m", "its"},
        {0}};
    pdyn_constraint_type t = good;
    t.alternatives = (const char *const[]){"stiffness", NULL};
    refuse_type(t, "an alternative is not a parameter, or a required one");
    t.params = params, t.alternatives = (const char *const[]){"stiffness", "width", NULL};
    refuse_type(t, "an alternative is not a parameter, or a required one");
    t.alternatives = (const char *const[]){"stiffness", "length", NULL};
    refuse_type(t, "more than one alternative has a default");
}

static void test_parameters(void **state) {
    (void)state;
    const size_t length = offsetof(struct params, length);
    refuse_param((pdyn_param){"type", PDYN_REAL, length, false, 0, 0, 1, "", ""}, "key of a scene");
    refuse_param((pdyn_param){"l", (pdyn_param_kind)17, length, false, 0, 0, 1, "", ""}, "kind");
    refuse_param((pdyn_param){"l", PDYN_REAL, length, false, 0, 0, 1, NULL, ""}, "no unit");
    refuse_param((pdyn_param){"l", PDYN_VECTOR, length, false, 0, 0, 1, "", ""}, "outside");
    refuse_param((pdyn_param){"l", PDYN_REAL, length, false, 0, 2, 1, "", ""}, "not ordered");
    refuse_param((pdyn_param){"l", PDYN_REAL, length, false, 2, 0, 1, "", ""}, "above its bounds");
    refuse_param((pdyn_param){"stiffness", PDYN_REAL, length, false, 0, 0, 1, "", ""}, "twice");
    refuse_param((pdyn_param){"l", PDYN_INT, 4, false, 0, 0, 1, "", ""}, "overlaps");
    refuse_table(PDYN_TABLE(PDYN_PER_TET, 3), 0, "needs PDYN_ON_VOLUME");
    refuse_table(PDYN_TABLE(PDYN_PER_VERTEX, 3), 0, "needs PDYN_ON_SURFACE or PDYN_ON_VOLUME");
    refuse_table(PDYN_TABLE(PDYN_ROWS, 0), 0, "no numbers");
    refuse_table(PDYN_TABLE(PDYN_ROWS, 1), 2, "not ordered");
    refuse_param((pdyn_param){"l", PDYN_INT, length, false, 9, 0, 1, "", ""}, "above its bounds");
    refuse_param((pdyn_param){"l", PDYN_INT, length, false, 0.5, 0, 1, "", ""}, "a fraction");
    refuse_table(PDYN_TABLE(PDYN_PER_TET, 256), 0, "kind");
}

/* ---- parameters computed from the scene ------------------------------------------------------ */

static pdyn_param_fault resolved;
static pdyn_scene_info seen;

static pdyn_param_fault resolve(void *par, const pdyn_scene_info *scene) {
    struct params *p = par;
    seen = *scene;
    p->stiffness *= 0.5;
    return resolved;
}

static void test_resolve(void **state) {
    (void)state;
    static pdyn_constraint_type type;
    static const pdyn_constraint_type *const types[] = {&type, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    static const char scene[] = SCENE(
        "'duration': 1, 'gravity': [0, 0, -10]",
        GRID_SHEET("", "1, 1", "3, 3", "'area_density': 1", "\n{'type': 'mine', 'stiffness': 1}"),
        "");
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    type = good, type.resolve = resolve;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    resolved = (pdyn_param_fault){"too soft", "stiffness"};
    assert_int_equal(pdyn_load_text(context, quoted(scene), "s", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context),
                        "s:2:31: bodies[0].constraints[0].stiffness: too soft");
    resolved.param = NULL;
    assert_int_equal(pdyn_load_text(context, quoted(scene), "s", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), "s:2:1: bodies[0].constraints[0]: too soft");
    resolved.message = NULL;
    sim = test_load(context, scene);
    pdyn_parameter_info p = pdyn_get_parameter(sim, 0, 0);
    assert_string_equal(p.name, "stiffness");
    assert_string_equal(p.unit, "N/m");
    assert_true(p.value == 0.5);
    assert_null(pdyn_get_parameter(sim, 0, 1).name);
    assert_true(seen.gravity[2] == -10.0 && seen.radius == 0.0 && fabs(seen.head - 1.0) < 1e-12);
    test_close(sim);
}

/* ---- rows that make no sense ----------------------------------------------------------------- */

static int column_of_all;
static double coefficient_of_all, weight_of_all;
static int elements_of_all, width_of_all = 1;

static int some_elements(const void *par, const pdyn_body *body) {
    (void)par, (void)body;
    return elements_of_all;
}

static void some_select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        b->column[e] = column_of_all, b->coefficient[e] = coefficient_of_all;
}

static void some_weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = weight_of_all;
}

static void project_to_nan(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        for (int k = 0; k < 3; k++) b->p[3 * e + k] = e == 1 ? NAN : 0.0;
}

static void tangent_to_nan(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par, (void)b;
    for (int k = 0; k < 9 * (last - first); k++) J[k] = NAN;
}

static const char sheet[] = SCENE("'duration': 1, 'solver': {'retries': 0}",
                                  GRID_SHEET("'name': 'b', ", "1, 1", "3, 3", "'area_density': 1",
                                             "{'type': 'mine', 'stiffness': 1}"),
                                  "");

static pdyn_status load_rows(pdyn_context *context, int count, int column, double coefficient,
                             double weight, pdyn_sim **sim) {
    static pdyn_constraint_type type;
    static const pdyn_constraint_type *const types[] = {&type, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    elements_of_all = count, column_of_all = column;
    coefficient_of_all = coefficient, weight_of_all = weight;
    type = good, type.elements = some_elements, type.select = some_select;
    type.weight = some_weight, type.width = width_of_all;
    if (coefficient_of_all == 1.0) type.project = project_to_nan;
    else type.tangent = tangent_to_nan;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    return pdyn_load_text(context, quoted(sheet), "sheet", NULL, 0, sim);
}

static void refuse_rows(int count, int column, double coefficient, double weight, const char *why) {
    pdyn_context *context = test_context(1);
    pdyn_sim *sim;
    assert_int_equal(load_rows(context, count, column, coefficient, weight, &sim), PDYN_BAD_INPUT);
    assert_error(why);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_rows(void **state) {
    (void)state;
    refuse_rows(
        -1, 0, 1.0, 1.0,
        "sheet:1:162: bodies[0].constraints[0]: constraint \"mine\" on body \"b\": it has -1 "
        "elements");
    refuse_rows(INT32_MAX, 0, 1.0, 1.0,
                "constraint \"mine\" on body \"b\": it has 2147483647 elements, expected 0 to");
    refuse_rows(2, 9, 1.0, 1.0, "element 0 selects particle 9, expected 0 to 8");
    refuse_rows(2, -1, 1.0, 1.0, "element 0 selects particle -1, expected 0 to 8");
    refuse_rows(2, 0, NAN, 1.0, "coefficient that is not finite");
    refuse_rows(2, 0, 1.0, -1.0, "element 0 has the weight -1, expected a finite one");
    refuse_rows(2, 0, 1.0, NAN, "expected a finite one of at least 0");
    width_of_all = INT32_MAX;
    refuse_rows(2, 0, 1.0, 1.0, "constraint \"mine\" on body \"b\": it has too many rows");
    width_of_all = 1;
}

/* Rows may select the particles of a body that a parameter names; the message says which they are.
 */
static void test_rows_of_other(void **state) {
    (void)state;
    static const pdyn_param to[] = {{"to", PDYN_OTHER, 0, true, 0, 0, 0, "", "the other body"},
                                    {0}};
    static const char two[] =
        SCENE("'duration': 1",
              PAIR(GRID_SHEET("'name': 'a', ", "1, 1", "3, 3",
                              "'area_density': 1, 'translate': [0, 1, 0]", ""),
                   GRID_SHEET("'name': 'b', ", "1, 1", "3, 3", "'area_density': 1",
                              "{'type': 'mine', 'to': 'a'}")),
              "");
    pdyn_constraint_type type = good;
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    pdyn_context *context = test_context(1);
    pdyn_sim *sim;
    type.elements = some_elements, type.select = some_select, type.weight = some_weight;
    type.params = to, type.params_size = sizeof(pdyn_other), type.resolve = NULL;
    elements_of_all = 1, coefficient_of_all = weight_of_all = 1.0;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    column_of_all = 8;
    assert_int_equal(pdyn_load_text(context, quoted(two), "two", NULL, 0, &sim), PDYN_OK);
    pdyn_free(sim);
    column_of_all = 18;
    assert_int_equal(pdyn_load_text(context, quoted(two), "two", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_error("selects particle 18, expected 9 to 17, or 0 to 8 of body \"a\"");
    pdyn_destroy(context);
}

/* A projection (coefficient 1) or a tangent (2) that is not finite ends the run with a message, a
 * tangent without shorter steps. */
static void test_not_finite(void **state) {
    (void)state;
    static const char *const what[] = {"energy", "tangent"};
    static const pdyn_status status[] = {PDYN_DIVERGED, PDYN_SOLVER_FAILED};
    static const char *const where[] = {": p of element 1 is not", ""};
    for (int k = 0; k < 2; k++) {
        pdyn_context *context = test_context(1);
        pdyn_sim *sim;
        char expected[128];
        assert_int_equal(load_rows(context, 2, 0, 1.0 + k, 1e6, &sim), PDYN_OK);
        assert_int_equal(pdyn_step(sim, NULL), status[k]);
        snprintf(expected, sizeof expected,
                 "the %s of constraint \"mine\" on body \"b\" is not finite%s", what[k], where[k]);
        assert_error(expected);
        test_close(sim);
    }
}

/* ---- a row that couples all vertices --------------------------------------------------------- */

static int one_element(const void *par, const pdyn_body *body) {
    (void)par, (void)body;
    return 1;
}

static void one_row(const void *par, const pdyn_batch *b, int e, int *rows, int *width) {
    (void)par, (void)e;
    *rows = 1, *width = b->body->count;
}

static void select_mean(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 0; k < last * b->body->count; k++)
        b->column[k] = b->body->first + k, b->coefficient[k] = 1.0 / b->body->count;
    (void)first;
}

static void project_to_place(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = 0.1;
}

/* H is dense: no factor of it is chosen, and preconditioners leave the row out. */
static void test_dense(void **state) {
    (void)state;
    static const char text[] =
        SCENE("'duration': 1",
              GRID_SHEET("'name': 'b', ", "1, 1", "19, 19", "'area_density': 1",
                         "{'type': 'mine', 'stiffness': 1}"),
              "");
    pdyn_constraint_type type = good;
    type.flags = PDYN_ANCHORED, type.elements = one_element, type.rows = type.width = 0,
    type.row_sizes = one_row;
    type.select = select_mean, type.weight = some_weight, type.project = project_to_place;
    weight_of_all = 1e6;
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    pdyn_matrix graph;
    struct warnings warned = {.text = "the matrix is dense"};
    pdyn_context *context = test_warned_context(1, &warned);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim = test_load(context, text);
    assert_false(sim->solver->direct);
    assert_int_equal(sim->model.model.graph(&sim->model.model, &graph), PDYN_OK);
    assert_int_equal(graph.start[graph.size], 19 * 19);
    test_step(sim);
    double mean[3] = {0.0};
    for (int k = 0; k < 3 * 19 * 19; k++) mean[k % 3] += sim->x[k] / (19 * 19);
    for (int k = 0; k < 3; k++) assert_true(fabs(mean[k] - 0.1) < 0.005);
    assert_int_equal(warned.count, 0);
    pdyn_free(sim);
    static const char *const factored[] = {"solver.type=cholesky", "solver.step=projective"};
    if (!test_lacks_solver(factored[0])) {
        sim = test_load_with(context, text, factored, 2);
        assert_int_equal(warned.count, 1);
        pdyn_free(sim);
    }
    pdyn_destroy(context);
}

/* ---- what a solver is given ------------------------------------------------------------------ */

static pdyn_model *model;
static bool silent; /* the solver fails without a text */

static pdyn_status create(void *self, pdyn_model *given) {
    (void)self;
    model = given;
    return PDYN_OK;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    (void)self, (void)b, (void)y, (void)stop, (void)iterations;
    if (silent) return PDYN_SOLVER_FAILED;
    return model->services->set_error(model->services->core, PDYN_SOLVER_FAILED, "no idea");
}

static void release(void *self) { (void)self; }

static const pdyn_global_solver lazy = {.name = "lazy",
                                        .summary = "solves nothing",
                                        .state_size = 1,
                                        .create = create,
                                        .solve = solve,
                                        .free = release};
static const pdyn_global_solver *const solvers[] = {&lazy, NULL};
static const pdyn_plugin lazy_plugin = {PDYN_ABI, "lazy", NULL, solvers};

static const char springs[] = SCENE("'duration': 1, 'solver': {'type': 'lazy'}",
                                    GRID_SHEET("", "1, 1", "4, 5", "'area_density': 1",
                                               PAIR(SPRINGS("100"), PINS("'vertices': [0]"))),
                                    "");

/* y = H u by the assembled matrix, of which only the lower triangle counts. */
static void multiply(const pdyn_matrix *m, const double *u, double *y) {
    int copies = 3 / m->dim;
    for (int k = 0; k < m->size * copies; k++) y[k] = 0.0;
    for (int c = 0; c < m->size; c++)
        for (int k = m->start[c]; k < m->start[c + 1]; k++)
            for (int a = 0; a < copies && m->row[k] >= c; a++) {
                int i = copies * m->row[k] + a, j = copies * c + a;
                y[i] += m->value[k] * u[j];
                if (i != j) y[j] += m->value[k] * u[i];
            }
}

/* The last error is that of the step, also where the solver sets no text. */
static void test_failing_solver(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &lazy_plugin), PDYN_OK);
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_load(context, springs);
        silent = k == 1;
        assert_int_equal(pdyn_step(sim, NULL), PDYN_SOLVER_FAILED);
        assert_string_equal(pdyn_last_error(context),
                            silent ? "the linear solver failed (\"lazy\")" : "no idea");
        pdyn_free(sim);
    }
    silent = false;
    pdyn_destroy(context);
}

/* Product, block diagonal and matrix agree, and the matrix counts its changes. */
static void test_model(void **state) {
    (void)state;
    static const int place[3] = {0, 3, 5}; /* positions of xx, yy, zz in a packed block */
    double u[61], y[61], z[61], blocks[120];
    uint64_t seed = 3;
    pdyn_context *context = test_context(2);
    assert_int_equal(pdyn_register(context, &lazy_plugin), PDYN_OK);
    pdyn_sim *sim = test_load(context, springs);
    assert_int_equal(model->particles, 20);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_SOLVER_FAILED);
    for (int k = 0; k < 60; k++) u[k] = test_random(&seed);
    for (int dim = 1; dim <= 3; dim += 2) {
        pdyn_matrix matrix, again;
        assert_int_equal(solver_view_linearise(&sim->model, dim == 1 ? 1.0 : 0.25), PDYN_OK);
        assert_int_equal(model->matrix(model, &matrix), PDYN_OK);
        assert_int_equal(matrix.dim, dim);
        model->product(model, u, y);
        multiply(&matrix, u, z);
        assert_true(test_distance(y, z, 60) <= 1e-12 * sqrt(model->dot(model, y, y)));
        model->diagonal(model, PDYN_WHOLE, blocks);
        for (int c = 0; c < matrix.size; c++)
            assert_true(fabs(matrix.value[matrix.start[c] + c % dim] -
                             blocks[6 * (c / dim) + place[c % dim]]) <= 1e-9 * fabs(y[0]));
        assert_int_equal(model->matrix(model, &again), PDYN_OK);
        assert_int_equal(again.pattern, matrix.pattern);
        assert_int_equal(again.values == matrix.values, dim == 1);
    }
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plugins),       cmocka_unit_test(test_tables),
        cmocka_unit_test(test_alternatives),  cmocka_unit_test(test_resolve),
        cmocka_unit_test(test_parameters),    cmocka_unit_test(test_rows),
        cmocka_unit_test(test_rows_of_other), cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_dense),         cmocka_unit_test(test_failing_solver),
        cmocka_unit_test(test_model),
    };
    return cmocka_run_group_tests_name("plugin", tests, NULL, NULL);
}
