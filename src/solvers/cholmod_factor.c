#include "cholmod_factor.h"

#include <stdio.h>
#include <string.h>

void factor_start(struct factor *f, const pdyn_services *services) {
    f->services = services;
    cholmod_start(&f->common);
    f->common.print = 0;
    f->common.method[0].ordering = CHOLMOD_AMD, f->common.method[1].ordering = CHOLMOD_METIS;
}

void factor_end(struct factor *f) {
    if (!f->services) return;
    cholmod_free_factor(&f->analysed, &f->common);
    cholmod_free_factor(&f->factor, &f->common);
    cholmod_free_dense(&f->rhs, &f->common);
    cholmod_free_dense(&f->solution, &f->common);
    cholmod_free_dense(&f->work, &f->common);
    cholmod_free_dense(&f->scratch, &f->common);
    cholmod_finish(&f->common);
}

static pdyn_status fail(struct factor *f, const char *what) {
    char message[128];
    bool memory = f->common.status == CHOLMOD_OUT_OF_MEMORY;
    snprintf(message, sizeof message, "%sCHOLMOD could not %s a matrix of %d rows (status %d)",
             memory ? "out of memory: " : "", what, f->size, f->common.status);
    return f->services->set_error(f->services->core, memory ? PDYN_NO_MEMORY : PDYN_SOLVER_FAILED,
                                  message);
}

static cholmod_sparse sparse_view(const pdyn_matrix *m) {
    return (cholmod_sparse){.nrow = (size_t)m->size,
                            .ncol = (size_t)m->size,
                            .nzmax = (size_t)m->start[m->size],
                            .p = (int *)m->start,
                            .i = (int *)m->row,
                            .x = (double *)m->value,
                            .stype = -1,
                            .itype = CHOLMOD_INT,
                            .xtype = CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 0,
                            .packed = 1};
}

pdyn_status factor_analyse(struct factor *f, const pdyn_matrix *m, bool lasting) {
    cholmod_sparse A = sparse_view(m);
    size_t n = (size_t)m->size;
    f->dim = m->dim, f->size = m->size;
    /* minimum degree is quick to find; nested dissection takes ten times as long and gives smaller
     * factors of large sheets */
    f->common.nmethods = lasting ? 2 : 1;
    /* a large factor is quick to compute by supernodes; at dim 1 it is too sparse for solves by
     * dense kernels, and becomes a simplicial one without the zeros of supernodes */
    f->common.final_asis = false, f->common.final_super = m->dim == 3;
    f->common.final_resymbol = m->dim == 1;
    cholmod_free_factor(&f->analysed, &f->common);
    f->analysed = cholmod_analyze(&A, &f->common);
    /* columns: x, y and z of all particles where dim is 1 */
    cholmod_free_dense(&f->rhs, &f->common);
    f->rhs = cholmod_allocate_dense(n, m->dim == 1 ? 3 : 1, n, CHOLMOD_REAL, &f->common);
    return f->analysed && f->rhs ? PDYN_OK : fail(f, "analyse");
}

/* Of the OpenMP library of CHOLMOD; NULL: a CHOLMOD without OpenMP. */
int omp_get_max_active_levels(void) __attribute__((weak));
void omp_set_max_active_levels(int levels) __attribute__((weak));

/* CHOLMOD factors supernodes with four threads of its own, which no variable but OMP_THREAD_LIMIT
 * changes. Without active levels OpenMP makes none: a run has the threads that it is given. */
static bool factorize_on_this_thread(cholmod_sparse *A, struct factor *f) {
    int levels = omp_set_max_active_levels ? omp_get_max_active_levels() : 0;
    if (levels) omp_set_max_active_levels(0);
    bool good = cholmod_factorize(A, f->factor, &f->common);
    if (levels) omp_set_max_active_levels(levels);
    return good;
}

pdyn_status factor_compute(struct factor *f, const pdyn_matrix *m) {
    cholmod_sparse A = sparse_view(m);
    cholmod_free_factor(&f->factor, &f->common);
    f->factor = cholmod_copy_factor(f->analysed, &f->common);
    bool good = f->factor && factorize_on_this_thread(&A, f);
    return good && f->common.status == CHOLMOD_OK ? PDYN_OK : fail(f, "factor");
}

/* Copies between vectors (particles x 3) and columns. */
static void to_columns(const struct factor *f, const double *b) {
    double *x = f->rhs->x;
    size_t n = (size_t)f->size;
    if (f->dim == 3) memcpy(x, b, n * sizeof *x);
    else
        for (size_t k = 0; k < 3 * n; k++) x[k % 3 * n + k / 3] = b[k];
}

static void from_columns(const struct factor *f, double *y) {
    const double *x = f->solution->x;
    size_t n = (size_t)f->size;
    if (f->dim == 3) memcpy(y, x, n * sizeof *x);
    else
        for (size_t k = 0; k < 3 * n; k++) y[k] = x[k % 3 * n + k / 3];
}

pdyn_status factor_solve(struct factor *f, const double *b, double *y) {
    to_columns(f, b);
    if (!cholmod_solve2(CHOLMOD_A, f->factor, f->rhs, NULL, &f->solution, NULL, &f->work,
                        &f->scratch, &f->common))
        return fail(f, "solve with");
    from_columns(f, y);
    return PDYN_OK;
}
