#include "factor.h"

#include <string.h>

void factor_start(struct factor *f, pdyn_context *context) {
    f->context = context;
    cholmod_start(&f->common);
    f->common.print = 0;
}

void factor_free(struct factor *f) {
    if (!f->context) return;
    panels_free(&f->panels);
    cholmod_free_factor(&f->factor, &f->common);
    cholmod_free_dense(&f->solution, &f->common);
    cholmod_free_dense(&f->work, &f->common);
    cholmod_free_dense(&f->scratch, &f->common);
    cholmod_finish(&f->common);
}

static pdyn_status fail(struct factor *f, const char *what) {
    return context_fail(
        f->context, f->common.status == CHOLMOD_OUT_OF_MEMORY ? PDYN_NO_MEMORY : PDYN_SOLVER_FAILED,
        "CHOLMOD could not %s a matrix of %d rows (status %d)", what, f->unknowns,
        f->common.status);
}

static cholmod_sparse sparse_view(const struct matrix *m) {
    size_t n = (size_t)(m->dim * m->particles);
    return (cholmod_sparse){.nrow = n,
                            .ncol = n,
                            .nzmax = (size_t)m->column_start[n],
                            .p = m->column_start,
                            .i = m->row,
                            .x = m->value,
                            .stype = -1,
                            .itype = CHOLMOD_INT,
                            .xtype = CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 0,
                            .packed = 1};
}

/* Minimum degree is quick to find; nested dissection takes ten times as long and gives the smaller
 * factors of large sheets, and subtrees of equal size. */
static void choose_orderings(cholmod_common *common, bool lasting) {
    common->nmethods = lasting ? 2 : 1;
    common->method[0].ordering = CHOLMOD_AMD;
    common->method[1].ordering = CHOLMOD_METIS;
}

pdyn_status factor_analyse(struct factor *f, const struct matrix *m, bool lasting) {
    cholmod_sparse A = sparse_view(m);
    f->unknowns = m->dim * m->particles, f->coupled = m->dim == 3;
    f->common.supernodal = f->coupled ? CHOLMOD_AUTO : CHOLMOD_SUPERNODAL;
    choose_orderings(&f->common, lasting);
    cholmod_free_factor(&f->factor, &f->common);
    f->factor = cholmod_analyze(&A, &f->common);
    if (!f->factor) return fail(f, "analyse");
    return f->coupled ? PDYN_OK : panels_build(&f->panels, f->context, f->factor);
}

pdyn_status factor_numbers(struct factor *f, const struct matrix *m) {
    cholmod_sparse A = sparse_view(m);
    if (!cholmod_factorize(&A, f->factor, &f->common) || f->common.status != CHOLMOD_OK)
        return fail(f, "factor");
    if (f->coupled) return PDYN_OK;
    pdyn_status status = panels_fill(&f->panels, f->factor);
    cholmod_change_factor(CHOLMOD_PATTERN, true, true, true, true, f->factor, &f->common);
    return status;
}

static pdyn_status solve_coupled(struct factor *f, const double *b, double *y) {
    size_t n = (size_t)f->unknowns;
    cholmod_dense rhs = {.nrow = n,
                         .ncol = 1,
                         .nzmax = n,
                         .d = n,
                         .x = (double *)b,
                         .xtype = CHOLMOD_REAL,
                         .dtype = CHOLMOD_DOUBLE};
    if (!cholmod_solve2(CHOLMOD_A, f->factor, &rhs, NULL, &f->solution, NULL, &f->work, &f->scratch,
                        &f->common))
        return fail(f, "solve with");
    memcpy(y, f->solution->x, n * sizeof *y);
    return PDYN_OK;
}

pdyn_status factor_solve(struct factor *f, const double *b, double *y) {
    if (f->coupled) return solve_coupled(f, b, y);
    panels_solve(&f->panels, b, y);
    return PDYN_OK;
}
