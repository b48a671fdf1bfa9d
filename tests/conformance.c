/* Every registered constraint type, with every registered solver: nothing here names one. A scene
 * is written from the type's own parameter table, so a new type is covered without a line of test.
 */
#include "support.h"

#include "assemble.h"
#include "registry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a small scene for any type -------------------------------------------------------------- */

static double value_for(const pdyn_param *p) {
    if (!p->required) return p->def;
    return fmin(p->max, fmax(p->min, 10.0));
}

static int write_params(char *text, int size, const pdyn_constraint_type *type) {
    int n = 0;
    for (const pdyn_param *p = type->params; p->name; p++) {
        if (p->kind == PDYN_VERTICES)
            n +=
                snprintf(text + n, (size_t)(size - n), ", \"%s\": {\"vertices\": [0, 4]}", p->name);
        if (p->kind == PDYN_REAL)
            n += snprintf(text + n, (size_t)(size - n), ", \"%s\": %.17g", p->name, value_for(p));
    }
    return n;
}

static const char *scene_for(const pdyn_constraint_type *type, const char *solver,
                             const char *step) {
    static char text[4096];
    char params[1024] = "";
    write_params(params, sizeof params, type);
    const char *surface = "\"surface\": {\"grid\": {\"size\": [0.4, 0.5], \"vertices\": [5, 6]}, "
                          "\"rotate\": [20, 30, 10],"
                          " \"area_density\": 0.3}";
    const char *particles =
        "\"particles\": {\"radius\": 0.05, \"fill\": [{\"box\": {\"minimum\": [0, 0, 0],"
        " \"maximum\": [0.41, 0.31, 0.31]}}]}";
    snprintf(text, sizeof text,
             "{\"duration\": 1, \"time_step\": {\"fixed\": 0.004}, \"frame_interval\": 0.004,"
             " \"solver\": {\"type\": \"%s\", \"step\": \"%s\", \"linear_tolerance\": 1e-12,"
             " \"tolerance\": 1e-6, \"linear_iterations\": 100000},"
             " \"bodies\": [{\"name\": \"b\", %s, \"constraints\": [{\"type\": \"%s\"%s}]}]}",
             solver, step, type->flags & PDYN_ON_PARTICLES ? particles : surface, type->name,
             params);
    return text;
}

struct trial { /* a type's scene at a random state, linearised */
    pdyn_context *context;
    pdyn_sim *sim;
    struct batch *batch, *rows; /* rows: the rows tier, the batch itself where it has no operator */
    int n;
    double *x, *gradient, *u, *y, *z;
};

static double *array(int n) {
    double *a = calloc((size_t)n + 1, sizeof *a); /* a vector has room for one more */
    assert_non_null(a);
    return a;
}

static struct trial start(const pdyn_constraint_type *type, const char *solver, double noise) {
    struct trial t = {.context = test_context(1)};
    uint64_t seed = 7;
    t.sim = test_load(t.context, scene_for(type, solver, "newton"));
    t.batch = t.rows = t.sim->system.batch[0];
    t.n = 3 * t.sim->system.particles;
    t.x = array(t.n), t.gradient = array(t.n), t.u = array(t.n), t.y = array(t.n), t.z = array(t.n);
    for (int k = 0; k < t.n; k++) {
        t.x[k] = t.sim->x[k] * 0.97 + noise * test_random(&seed);
        t.u[k] = test_random(&seed);
        t.sim->system.s[k] = t.sim->x[k] + 0.01 * test_random(&seed);
    }
    t.sim->system.h = 0.004;
    for (int k = 0; k < t.n; k++) t.sim->v[k] = test_random(&seed);
    system_begin(&t.sim->system, t.sim->x, t.sim->v);
    double energy;
    assert_int_equal(system_local(&t.sim->system, t.x, &energy, t.gradient), PDYN_OK);
    if (type->op)
        assert_int_equal(batch_create(t.context, type, t.batch->params, t.batch->view.body, NULL,
                                      neighbours_view(t.sim->neighbours), true, &t.rows),
                         PDYN_OK);
    return t;
}

static void finish(struct trial *t) {
    if (t->rows != t->batch) batch_free(t->rows);
    free(t->x), free(t->gradient), free(t->u), free(t->y), free(t->z);
    pdyn_free(t->sim);
    assert_int_equal(pdyn_bytes_in_use(t->context), 0);
    pdyn_destroy(t->context);
}

static double dot(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

static double norm(const double *a, int n) { return sqrt(dot(a, a, n)); }

static void each_type(void (*check)(const pdyn_constraint_type *type)) {
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t; t++) check(*t);
}

/* ---- the mathematics ------------------------------------------------------------------------- */

static double energy_at(struct trial *t, const double *x) {
    double energy, *scratch = array(t->n);
    assert_int_equal(system_local(&t->sim->system, x, &energy, scratch), PDYN_OK);
    free(scratch);
    return energy;
}

/* The gradient is that of the energy. Projections that are found by iteration are closest points
 * only to second order, hence the tolerance. */
static void check_gradient(const pdyn_constraint_type *type) {
    struct trial t = start(type, "auto", 0.002);
    double *moved = array(t.n), h = 1e-6;
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < t.n; k++) moved[k] = t.x[k] + sign * h * t.u[k];
        t.y[0] += sign * energy_at(&t, moved) / (2.0 * h);
    }
    double expected = dot(t.gradient, t.u, t.n);
    if (fabs(t.y[0] - expected) > 0.02 * fabs(expected) + 1e-7 * norm(t.gradient, t.n))
        fail_msg("%s: slope of the energy %g, by its gradient %g", type->name, t.y[0], expected);
    free(moved);
    finish(&t);
}

/* Projecting what is projected changes nothing, and a projection never lengthens a difference to
 * the manifold that it claims to remove: u - p vanishes at p. */
static void check_projection(const pdyn_constraint_type *type) {
    struct trial t = start(type, "auto", 0.002);
    batch_local(t.rows, t.x, 0.0, t.y);
    double *once = array(3 * t.rows->rows);
    memcpy(once, t.rows->view.p, 3 * (size_t)t.rows->rows * sizeof *once);
    memcpy((double *)t.rows->view.u, once, 3 * (size_t)t.rows->rows * sizeof *once);
    type->project(t.rows->params, &t.rows->view, 0, t.rows->view.elements);
    double scale = 1e-9 + norm(once, 3 * t.rows->rows);
    if (test_distance(once, t.rows->view.p, 3 * t.rows->rows) > 1e-6 * scale)
        fail_msg("%s: projecting twice moves by %g of %g", type->name,
                 test_distance(once, t.rows->view.p, 3 * t.rows->rows), scale);
    free(once);
    finish(&t);
}

/* H is symmetric and lies between M/h^2 and the projective A, for every eps. */
static void check_bounds(const pdyn_constraint_type *type) {
    struct trial t = start(type, "auto", 0.002);
    uint64_t seed = 99;
    double last = 0.0;
    for (int k = 0; k <= 4; k++) {
        assert_int_equal(system_linearise(&t.sim->system, 0.25 * k), PDYN_OK);
        for (int i = 0; i < t.n; i++) t.z[i] = test_random(&seed);
        double *hz = array(t.n);
        system_apply(&t.sim->system, t.u, t.y);
        system_apply(&t.sim->system, t.z, hz);
        assert_true(fabs(dot(t.z, t.y, t.n) - dot(t.u, hz, t.n)) <=
                    1e-10 * norm(t.y, t.n) * norm(t.z, t.n));
        double quadratic = dot(t.u, t.y, t.n), inertia = 0.0;
        for (int i = 0; i < t.n; i++)
            inertia += t.sim->system.mass[i / 3] * t.u[i] * t.u[i] / (0.004 * 0.004);
        assert_true(quadratic >= inertia * (1.0 - 1e-12));
        assert_true(quadratic >= last * (1.0 - 1e-12)); /* grows with the damping */
        last = quadratic;
        free(hz);
    }
    finish(&t);
}

/* The block diagonal is that of the product. */
static void check_diagonal(const pdyn_constraint_type *type) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    struct trial t = start(type, "auto", 0.002);
    assert_int_equal(system_linearise(&t.sim->system, 0.3), PDYN_OK);
    double *blocks = array(2 * t.n);
    system_diagonal(&t.sim->system, blocks);
    for (int i = 0; i < t.n; i++) {
        memset(t.z, 0, (size_t)t.n * sizeof *t.z);
        t.z[i] = 1.0;
        system_apply(&t.sim->system, t.z, t.y);
        for (int b = 0; b < 6; b++)
            if (column[b] == i % 3)
                assert_true(fabs(t.y[i / 3 * 3 + row[b]] - blocks[i / 3 * 6 + b]) <=
                            1e-10 * fabs(t.y[i]));
    }
    free(blocks);
    finish(&t);
}

/* The operator tier and the rows that it stands for are the same. */
static void check_tiers(const pdyn_constraint_type *type) {
    if (!type->op) return;
    struct trial t = start(type, "auto", 0.002);
    double *a = array(t.n), *b = array(t.n), *da = array(2 * t.n), *db = array(2 * t.n);
    batch_local(t.batch, t.x, 0.0, a);
    batch_local(t.rows, t.x, 0.0, b);
    assert_true(t.batch->energy > 0.0);
    assert_true(fabs(t.batch->energy - t.rows->energy) <= 1e-10 * t.rows->energy);
    assert_true(test_distance(a, b, t.n) <= 1e-10 * norm(b, t.n));
    /* undamped: the rows' damping counts pairs in the skin of the lists, too */
    memset(a, 0, (size_t)t.n * sizeof *a), memset(b, 0, (size_t)t.n * sizeof *b);
    assert_int_equal(batch_linearise(t.batch, 0.0), PDYN_OK);
    assert_int_equal(batch_linearise(t.rows, 0.0), PDYN_OK);
    batch_apply(t.batch, t.u, a), batch_apply(t.rows, t.u, b);
    assert_true(test_distance(a, b, t.n) <= 1e-9 * norm(b, t.n));
    batch_diagonal(t.batch, da), batch_diagonal(t.rows, db);
    assert_true(test_distance(da, db, 2 * t.n) <= 1e-9 * norm(db, 2 * t.n));
    free(a), free(b), free(da), free(db);
    finish(&t);
}

/* One matrix stands for rows that are linear. */
static void check_stiffness(const pdyn_constraint_type *type) {
    struct trial t = start(type, "auto", 0.002);
    struct batch *rows;
    double *da = array(2 * t.n), *db = array(2 * t.n), *ga = array(t.n), *gb = array(t.n);
    if (t.batch->stiffness) {
        assert_int_equal(batch_create(t.context, type, t.batch->params, t.batch->view.body, NULL,
                                      NULL, false, &rows),
                         PDYN_OK);
        batch_local(t.batch, t.x, 0.0, ga), batch_local(rows, t.x, 0.0, gb);
        assert_true(fabs(t.batch->energy - rows->energy) <= 1e-10 * rows->energy);
        assert_true(test_distance(ga, gb, t.n) <= 1e-10 * norm(gb, t.n));
        assert_int_equal(batch_linearise(t.batch, 0.0), PDYN_OK);
        assert_int_equal(batch_linearise(rows, 0.0), PDYN_OK);
        memset(t.y, 0, (size_t)t.n * sizeof *t.y), memset(t.z, 0, (size_t)t.n * sizeof *t.z);
        batch_apply(t.batch, t.u, t.y), batch_apply(rows, t.u, t.z);
        assert_true(test_distance(t.y, t.z, t.n) <= 1e-10 * norm(t.z, t.n));
        batch_diagonal(t.batch, da), batch_diagonal(rows, db);
        assert_true(test_distance(da, db, 2 * t.n) <= 1e-10 * norm(db, 2 * t.n));
        batch_free(rows);
    } else assert_true(!type->linear || !type->linear(t.batch->params, &t.batch->view));
    free(da), free(db), free(ga), free(gb);
    finish(&t);
}

/* The model along a direction: its slope is that of the gradient's change, with and without changes
 * of side; without, the change is the product. */
static void check_model(const pdyn_constraint_type *type) {
    if (!type->op) return;
    for (double scale = 1e-10; scale < 10.0; scale *= 1e10) {
        struct trial t = start(type, "auto", 0.002);
        double *y = array(t.n), *product = array(t.n), unused;
        for (int k = 0; k < t.n; k++) t.u[k] *= scale;
        batch_local(t.batch, t.x, 0.0, t.y);
        assert_int_equal(batch_linearise(t.batch, 0.0), PDYN_OK);
        batch_apply(t.batch, t.u, product);
        batch_aim(t.batch, t.u, y);
        double from = batch_slope(t.batch, 0.0, &unused), to = batch_slope(t.batch, 1.0, &unused);
        int changed = batch_go(t.batch, 1.0, y);
        assert_true(fabs(dot(t.u, y, t.n) - (to - from)) <= 1e-9 * (fabs(from) + fabs(to)));
        assert_true((changed == 0) == (scale < 0.5));
        assert_true(changed || test_distance(y, product, t.n) <= 1e-6 * norm(product, t.n));
        free(y), free(product);
        finish(&t);
    }
}

/* ---- the contract ---------------------------------------------------------------------------- */

/* Callbacks write to their own range only, and give the same rows each time. */
static void check_ranges(const pdyn_constraint_type *type) {
    struct trial t = start(type, "auto", 0.002);
    struct batch *b = t.rows;
    int half = b->view.elements / 2, first = b->view.element_row[half];
    batch_local(b, t.x, 0.0, t.y);
    double *p = b->view.p;
    for (int k = 0; k < 3 * b->rows; k++) p[k] = NAN;
    type->project(b->params, &b->view, half, b->view.elements);
    for (int k = 0; k < 3 * b->rows; k++) assert_int_equal(isnan(p[k]) != 0, k < 3 * first);
    double *c = array(b->entries);
    memcpy(c, b->view.coefficient, (size_t)b->entries * sizeof *c);
    type->select(b->params, &b->view, 0, b->view.elements);
    assert_memory_equal(c, b->view.coefficient, (size_t)b->entries * sizeof *c);
    for (int k = 0; k < b->entries; k++)
        assert_true(b->view.column[k] >= 0 && b->view.column[k] < t.sim->system.particles);
    for (int e = 0; e < b->view.elements; e++) assert_true(b->view.weight[e] >= 0.0);
    free(c);
    finish(&t);
}

/* ---- with every solver ----------------------------------------------------------------------- */

static bool fits(const pdyn_global_solver *solver, const pdyn_constraint_type *type) {
    struct trial t = start(type, "auto", 0.002);
    bool good = !solver->fits || solver->fits(&t.sim->model.view);
    finish(&t);
    return good;
}

/* All solvers give the solution of the same system to 1e-8. */
static void check_solvers(const pdyn_constraint_type *type) {
    double *first = NULL;
    for (int damped = 0; damped < 2; damped++) {
        for (const pdyn_global_solver *const *s = registry_builtin.solvers; *s; s++) {
            if (!fits(*s, type)) continue;
            struct trial t = start(type, (*s)->name, 0.002);
            const pdyn_goal goal = {.tolerance = 1e-13, .iterations = 100000};
            int iterations = 0;
            assert_int_equal(system_linearise(&t.sim->system, damped && !type->op ? 1.0 : 0.0),
                             PDYN_OK);
            memset(t.y, 0, (size_t)t.n * sizeof *t.y);
            memcpy(t.z, t.u, (size_t)t.n * sizeof *t.z);
            assert_int_equal((*s)->solve(t.sim->solver_state, t.z, t.y, &goal, &iterations),
                             PDYN_OK);
            system_apply(&t.sim->system, t.y, t.z);
            if (test_distance(t.z, t.u, t.n) > 1e-8 * norm(t.u, t.n))
                fail_msg("%s with %s: residual %g", type->name, (*s)->name,
                         test_distance(t.z, t.u, t.n) / norm(t.u, t.n));
            if (!first) {
                first = array(t.n);
                memcpy(first, t.y, (size_t)t.n * sizeof *first);
            }
            if (test_distance(first, t.y, t.n) > 1e-8 * norm(first, t.n))
                fail_msg("%s: %s differs by %g", type->name, (*s)->name,
                         test_distance(first, t.y, t.n) / norm(first, t.n));
            finish(&t);
        }
        free(first);
        first = NULL;
    }
}

/* Steps of both kinds run with every solver, and give the same bits for any number of threads. */
static void check_steps(const pdyn_constraint_type *type) {
    static const char *const steps[] = {"newton", "projective"};
    static const int threads[] = {1, 2, 3, 8};
    for (const pdyn_global_solver *const *s = registry_builtin.solvers; *s; s++)
        for (int k = 0; k < 2 && fits(*s, type); k++) {
            uint64_t hash[4];
            for (int n = 0; n < 4; n++) {
                pdyn_context *context = test_context(threads[n]);
                pdyn_sim *sim = test_load(context, scene_for(type, (*s)->name, steps[k]));
                for (int i = 0; i < 3; i++) test_step(context, sim);
                hash[n] = pdyn_state_hash(sim);
                pdyn_free(sim);
                pdyn_destroy(context);
                assert_true(hash[n] == hash[0]);
            }
        }
}

static void test_gradients(void **state) { (void)state, each_type(check_gradient); }
static void test_projections(void **state) { (void)state, each_type(check_projection); }
static void test_bounds(void **state) { (void)state, each_type(check_bounds); }
static void test_diagonals(void **state) { (void)state, each_type(check_diagonal); }
static void test_stiffness(void **state) { (void)state, each_type(check_stiffness); }
static void test_tiers(void **state) { (void)state, each_type(check_tiers); }
static void test_model(void **state) { (void)state, each_type(check_model); }
static void test_ranges(void **state) { (void)state, each_type(check_ranges); }
static void test_solvers(void **state) { (void)state, each_type(check_solvers); }
static void test_steps(void **state) { (void)state, each_type(check_steps); }

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gradients), cmocka_unit_test(test_projections),
        cmocka_unit_test(test_bounds),    cmocka_unit_test(test_diagonals),
        cmocka_unit_test(test_stiffness), cmocka_unit_test(test_tiers),
        cmocka_unit_test(test_ranges),    cmocka_unit_test(test_model),
        cmocka_unit_test(test_solvers),   cmocka_unit_test(test_steps),
    };
    return cmocka_run_group_tests_name("conformance", tests, NULL, NULL);
}
