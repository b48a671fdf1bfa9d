/* Checks that two realisations of a type agree: operator and rows, linear rows and their matrix. */
#include "conformance.h"

#include <math.h>
#include <string.h>

/* Zeroes the scratch vectors y, z, da and db. */
static void clear(struct trial *t) {
    memset(t->y, 0, (size_t)t->n * sizeof *t->y), memset(t->z, 0, (size_t)t->n * sizeof *t->z);
    memset(t->da, 0, 2 * (size_t)t->n * sizeof *t->da);
    memset(t->db, 0, 2 * (size_t)t->n * sizeof *t->db);
}

/* Compares energy, gradient, product and block diagonal of two batches of the same constraint, at
 * eps = 0: for eps > 0, rows count listed pairs beyond the support, too, and operators do not. */
static void compare(struct check *check, struct trial *t, struct batch *a, struct batch *b,
                    const char *what) {
    clear(t);
    batch_local(a, t->x, t->y), batch_local(b, t->x, t->z);
    if (!(fabs(a->energy - b->energy) <= 1e-10 * fabs(b->energy)))
        fault(check, "%s have different energies, %.10g and %.10g", what, a->energy, b->energy);
    if (trial_differ(t->y, t->z, t->n, 1e-10)) fault(check, "%s have different gradients", what);
    clear(t);
    if (batch_linearise(a, 0.0) != PDYN_OK || batch_linearise(b, 0.0) != PDYN_OK) return;
    batch_apply(a, t->u, t->y), batch_apply(b, t->u, t->z);
    if (trial_differ(t->y, t->z, t->n, 1e-9)) fault(check, "%s have different products H u", what);
    batch_diagonal(a, t->da), batch_diagonal(b, t->db);
    if (trial_differ(t->da, t->db, 2 * t->n, 1e-9))
        fault(check, "%s have different block diagonals", what);
}

void check_tiers(struct check *check, struct trial *t) {
    if (!check->type->matrix_free) return;
    compare(check, t, t->batch, t->rows, "the operator and the rows that it stands for");
}

/* Rows that `linear` calls linear agree with the matrix that core sums them to. */
void check_stiffness(struct check *check, struct trial *t) {
    struct batch *rows = NULL;
    if (!t->batch->linear) return;
    if (batch_create_rows(t->batch, &rows) == PDYN_OK)
        compare(check, t, t->batch, rows, "the rows that `linear` calls linear and their matrix");
    batch_free(rows);
}
