/* A sparse Cholesky factor of H by CHOLMOD: analysed when the pattern changes, factored when the
 * values do. With the projective step and static constraints both happen once for each length of
 * step, and a solve is two triangular ones with three right-hand sides; with the newton step the
 * values change in every iteration and x, y, z couple; where neighbours change, the pattern does
 * too.
 *
 * A constraint with an operator of its own is assembled from its rows, which a twin batch holds. */
#include "../core/assemble.h"
#include "../core/solver.h"

#include <string.h>
#include <suitesparse/cholmod.h>

struct cholesky {
    pdyn_context *context;
    struct system *system;
    struct batch **rows; /* system's batches: itself, or the rows twin of one with an operator */
    double *unused;      /* particles x 3: the twins' gradients */
    struct matrix matrix;
    unsigned lists;    /* revision of the neighbours that the pattern belongs to */
    unsigned revision; /* and that of the rows */
    double h;          /* s: the values belong to it; 0 before the first factor */
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *solution, *work, *scratch;
};

static void free_twins(struct cholesky *c) {
    for (int b = 0; b < c->system->batches; b++)
        if (c->rows[b] && c->rows[b] != c->system->batch[b]) {
            batch_free(c->rows[b]);
            c->rows[b] = NULL;
        }
}

static void release(void *self) {
    struct cholesky *c = self;
    if (!c->context) return;
    if (c->rows) free_twins(c);
    FREE_ARRAY(c->context, c->rows, c->system->batches);
    FREE_VECTOR(c->context, c->unused, c->system->particles);
    matrix_free(&c->matrix);
    cholmod_free_factor(&c->factor, &c->common);
    cholmod_free_dense(&c->solution, &c->common);
    cholmod_free_dense(&c->work, &c->common);
    cholmod_free_dense(&c->scratch, &c->common);
    cholmod_finish(&c->common);
}

static pdyn_status create(void *self, pdyn_context *context, struct system *system) {
    struct cholesky *c = self;
    c->context = context, c->system = system;
    cholmod_start(&c->common);
    c->common.print = 0;
    c->rows = NEW_ARRAY(context, system->batches, struct batch *);
    c->unused = NEW_VECTOR(context, system->particles);
    if ((system->batches && !c->rows) || !c->unused) return PDYN_NO_MEMORY;
    for (int b = 0; b < system->batches; b++)
        if (!system->batch[b]->op) c->rows[b] = system->batch[b];
    return PDYN_OK;
}

static pdyn_status fail(struct cholesky *c, const char *what) {
    return context_fail(
        c->context, c->common.status == CHOLMOD_OUT_OF_MEMORY ? PDYN_NO_MEMORY : PDYN_SOLVER_FAILED,
        "CHOLMOD could not %s a matrix of %d rows (status %d)", what,
        c->matrix.dim * c->matrix.particles, c->common.status);
}

/* Rows of the operators at the current lists and the x of the last local step. */
static pdyn_status update_twins(struct cholesky *c, bool lists_moved) {
    struct system *sys = c->system;
    if (!sys->changing) return PDYN_OK;
    if (lists_moved) free_twins(c);
    for (int b = 0; b < sys->batches; b++) {
        const struct batch *from = sys->batch[b];
        if (!from->op) continue;
        pdyn_status status =
            c->rows[b] ? PDYN_OK
                       : batch_create(c->context, from->type, from->params, from->view.body, NULL,
                                      neighbours_view(sys->neighbours), true, &c->rows[b]);
        if (status != PDYN_OK) return status;
        status = batch_local(c->rows[b], sys->x, sys->time, c->unused);
        if (status == PDYN_OK) status = batch_linearise(c->rows[b], sys->eps);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
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

/* Brings the factor up to date with H. */
static pdyn_status prepare(struct cholesky *c) {
    struct system *sys = c->system;
    int dim = sys->eps < 1.0 ? 3 : 1;
    bool moved = sys->changing && c->lists != sys->lists;
    bool pattern =
        c->matrix.dim != dim || (moved && dim == 3) || c->revision != system_revision(sys);
    if (!pattern && !moved && dim == 1 && c->h == sys->h) return PDYN_OK;
    pdyn_status status = update_twins(c, moved);
    if (status == PDYN_OK && pattern) status = matrix_pattern(&c->matrix, sys, c->rows, dim);
    if (status != PDYN_OK) return status;
    matrix_values(&c->matrix, sys, c->rows);
    cholmod_sparse A = sparse_view(&c->matrix);
    if (pattern) {
        cholmod_free_factor(&c->factor, &c->common);
        c->factor = cholmod_analyze(&A, &c->common);
        if (!c->factor) return fail(c, "analyse");
    }
    if (!cholmod_factorize(&A, c->factor, &c->common) || c->common.status != CHOLMOD_OK)
        return fail(c, "factor");
    c->h = sys->h, c->lists = sys->lists, c->revision = system_revision(sys);
    return PDYN_OK;
}

/* Column-wise for one unknown a particle and three right-hand sides, as it is for three unknowns.
 */
static size_t place(const struct matrix *m, size_t k) {
    return m->dim == 3 ? k : k % 3 * (size_t)m->particles + k / 3;
}

static pdyn_status solve(void *self, double *b, double *y, double tolerance, int max_iterations,
                         int *iterations) {
    (void)tolerance, (void)max_iterations;
    struct cholesky *c = self;
    pdyn_status status = prepare(c);
    if (status != PDYN_OK) return status;
    size_t n3 = 3 * (size_t)c->system->particles, columns = c->matrix.dim == 3 ? 1 : 3;
    cholmod_dense rhs = {.nrow = n3 / columns,
                         .ncol = columns,
                         .nzmax = n3,
                         .d = n3 / columns,
                         .x = c->unused,
                         .xtype = CHOLMOD_REAL,
                         .dtype = CHOLMOD_DOUBLE};
    for (size_t k = 0; k < n3; k++) c->unused[place(&c->matrix, k)] = b[k];
    if (!cholmod_solve2(CHOLMOD_A, c->factor, &rhs, NULL, &c->solution, NULL, &c->work, &c->scratch,
                        &c->common))
        return fail(c, "solve with");
    const double *x = c->solution->x;
    for (size_t k = 0; k < n3; k++) y[k] = x[place(&c->matrix, k)];
    *iterations = 1;
    return PDYN_OK;
}

const struct solver_type pdyn_solver_cholesky = {
    .name = "cholesky",
    .summary =
        "a sparse factor by CHOLMOD, kept while the matrix stays; for static constraints with the "
        "projective step",
    .direct = true,
    .state_size = sizeof(struct cholesky),
    .create = create,
    .solve = solve,
    .free = release,
};
