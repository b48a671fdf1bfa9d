/* The factor of CHOLMOD against dense elimination. */
#include "support.h"

#include "../src/solvers/cholmod_factor.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>

/* A sheet of n x n vertices held by two corners. */
static pdyn_sim *hang(pdyn_context *context, int n) {
    char text[1024];
    snprintf(
        text, sizeof text,
        SCENE("'duration': 100, 'time_step': {'fixed': 0.01}",
              GRID_SHEET("", "1, 1", "%d, %d", "'area_density': 0.2",
                         PAIR(PAIR(SPRINGS("400"), BENDING("1e-4")), PINS("'vertices': [0, %d]"))),
              ""),
        n, n, n - 1);
    return test_load(context, text);
}

/* The matrix in full, lower triangle, n x n by rows. */
static double *dense(const pdyn_matrix *m) {
    int n = m->size;
    double *A = calloc((size_t)n * (size_t)n, sizeof *A);
    assert_non_null(A);
    for (int j = 0; j < n; j++)
        for (int k = m->start[j]; k < m->start[j + 1]; k++)
            A[(size_t)m->row[k] * (size_t)n + (size_t)j] = m->value[k];
    return A;
}

/* x = A^-1 x for n x 3 numbers, by L L' in place of A. */
static void solve_dense(double *A, int n, double *x) {
    for (int i = 0; i < n; i++) {
        double *a = A + (size_t)i * (size_t)n;
        for (int j = 0; j <= i; j++) {
            const double *b = A + (size_t)j * (size_t)n;
            for (int k = 0; k < j; k++) a[j] -= a[k] * b[k];
            a[j] = i == j ? sqrt(a[j]) : a[j] / b[j];
        }
    }
    for (int i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < i; k++)
                x[3 * i + c] -= A[(size_t)i * (size_t)n + (size_t)k] * x[3 * k + c];
            x[3 * i + c] /= A[(size_t)i * (size_t)n + (size_t)i];
        }
    for (int i = n - 1; i >= 0; i--)
        for (int c = 0; c < 3; c++) {
            for (int k = i + 1; k < n; k++)
                x[3 * i + c] -= A[(size_t)k * (size_t)n + (size_t)i] * x[3 * k + c];
            x[3 * i + c] /= A[(size_t)i * (size_t)n + (size_t)i];
        }
}

/* Solves with the factor for two lengths of step, the layout found once. `lasting`: see
 * factor_analyse. Returns the solutions, 2 x particles x 3. */
static double *factor_twice(int threads, int n, bool lasting, bool compare) {
    pdyn_context *context = test_context(threads);
    pdyn_sim *sim = hang(context, n);
    struct objective *objective = &sim->objective;
    pdyn_services services = context_services(context);
    pdyn_model *model = &sim->model.model;
    pdyn_matrix matrix;
    struct factor factor = {0};
    int size = 3 * objective->particles;
    double *y = calloc(2 * (size_t)size, sizeof *y), *x = calloc((size_t)size, sizeof *x);
    assert_true(y && x);
    factor_start(&factor, &services);
    for (int k = 0; k < 2; k++) {
        uint64_t seed = 3;
        objective->h = k ? 0.001 : 0.02;
        assert_int_equal(solver_view_linearise(&sim->model, 1.0), PDYN_OK);
        assert_int_equal(model->matrix(model, &matrix), PDYN_OK);
        if (!k) assert_int_equal(factor_analyse(&factor, &matrix, lasting), PDYN_OK);
        assert_int_equal(factor_compute(&factor, &matrix), PDYN_OK);
        for (int i = 0; i < size; i++) x[i] = test_random(&seed);
        assert_int_equal(factor_solve(&factor, x, y + k * size), PDYN_OK);
        if (!compare) continue;
        double *A = dense(&matrix), norm = 0.0;
        solve_dense(A, objective->particles, x);
        for (int i = 0; i < size; i++) norm += x[i] * x[i];
        assert_true(test_distance(x, y + k * size, size) < 1e-11 * sqrt(norm));
        free(A);
    }
    factor_end(&factor);
    test_close(sim);
    free(x);
    return y;
}

/* The factor gives the solution of dense elimination. */
static void test_factor(void **state) {
    (void)state;
    for (int n = 2; n <= 32; n += n < 5 ? 1 : 9)
        for (int k = 0; k < 2; k++) free(factor_twice(1, n, k, true));
}

static void test_factor_threads(void **state) {
    (void)state;
    static const int threads[] = {2, 3, 8};
    size_t bytes = 2 * 3 * 40 * 40 * sizeof(double);
    double *one = factor_twice(1, 40, true, false);
    for (int k = 0; k < 3; k++) {
        double *other = factor_twice(threads[k], 40, true, false);
        assert_memory_equal(one, other, bytes);
        free(other);
    }
    free(one);
}

static int count_threads(void) {
    int threads = 0;
    DIR *tasks = opendir("/proc/self/task");
    assert_non_null(tasks);
    for (struct dirent *entry; (entry = readdir(tasks));) threads += entry->d_name[0] != '.';
    closedir(tasks);
    return threads;
}

/* A scene of one thread takes one thread, also for supernodes (the newton step). */
static void test_no_other_threads(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        SCENE("'duration': 1, 'solver': {'type': 'cholesky'}",
              GRID_SHEET("", "1, 1", "30, 30", "'area_density': 0.2",
                         PAIR(PAIR(SPRINGS("400"), BENDING("1e-4")), PINS("'vertices': [0, 29]"))),
              ""));
    int before = count_threads();
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
    assert_int_equal(count_threads(), before);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_factor),
        cmocka_unit_test(test_factor_threads),
        cmocka_unit_test(test_no_other_threads),
    };
    return cmocka_run_group_tests_name("cholesky", tests, NULL, NULL);
}
