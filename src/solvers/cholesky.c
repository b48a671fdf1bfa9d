/* A sparse Cholesky factor of H by CHOLMOD: analysed when the pattern changes, factored when the
 * values do. With the projective step and static constraints both happen once for each length of
 * step, and a solve is two triangular ones with three right-hand sides; with the newton step the
 * values change in every iteration and x, y, z couple; where neighbours change, the pattern does
 * too.
 *
 * A constraint with an operator of its own is assembled from its rows, which a twin batch holds. */
#include "../core/solver.h"
#include "factor.h"

struct cholesky {
    pdyn_context *context;
    struct system *system;
    struct batch **rows; /* system's batches: itself, or the rows twin of one with an operator */
    double *unused;      /* particles x 3: the twins' gradients */
    struct matrix matrix;
    unsigned lists;    /* revision of the neighbours that the pattern belongs to */
    unsigned revision; /* and that of the rows */
    double h;          /* s: the values belong to it, 0 before the first factor, */
    unsigned weights;  /* and to these weights */
    struct factor factor;
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
    factor_free(&c->factor);
}

static pdyn_status create(void *self, pdyn_context *context, struct system *system) {
    struct cholesky *c = self;
    c->context = context, c->system = system;
    factor_start(&c->factor, context);
    c->rows = NEW_ARRAY(context, system->batches, struct batch *);
    c->unused = NEW_VECTOR(context, system->particles);
    if ((system->batches && !c->rows) || !c->unused) return PDYN_NO_MEMORY;
    for (int b = 0; b < system->batches; b++)
        if (!system->batch[b]->op) c->rows[b] = system->batch[b];
    return PDYN_OK;
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

/* Brings the factor up to date with H. */
static pdyn_status prepare(struct cholesky *c) {
    struct system *sys = c->system;
    int dim = sys->eps < 1.0 ? 3 : 1;
    bool moved = sys->changing && c->lists != sys->lists;
    bool pattern =
        c->matrix.dim != dim || (moved && dim == 3) || c->revision != system_revision(sys);
    if (!pattern && !moved && dim == 1 && c->h == sys->h && c->weights == sys->weights)
        return PDYN_OK;
    pdyn_status status = update_twins(c, moved);
    if (status == PDYN_OK && pattern) status = matrix_pattern(&c->matrix, sys, c->rows, dim);
    if (status != PDYN_OK) return status;
    matrix_values(&c->matrix, sys, c->rows);
    if (pattern) status = factor_analyse(&c->factor, &c->matrix, !sys->changing);
    if (status == PDYN_OK) status = factor_numbers(&c->factor, &c->matrix);
    if (status != PDYN_OK) return status;
    c->h = sys->h, c->weights = sys->weights;
    c->lists = sys->lists, c->revision = system_revision(sys);
    return PDYN_OK;
}

static pdyn_status solve(void *self, double *b, double *y, const struct solve_goal *goal,
                         int *iterations) {
    (void)goal;
    struct cholesky *c = self;
    *iterations = 1;
    pdyn_status status = prepare(c);
    return status == PDYN_OK ? factor_solve(&c->factor, b, y) : status;
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
