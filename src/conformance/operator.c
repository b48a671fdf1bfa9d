/* Checks of an operator by the definitions of pdyn_operator: value, stiffness, squares, rate and
 * force belong to one energy; callbacks add to vectors; the model along a direction. */
#include "conformance.h"

#include <math.h>
#include <string.h>

enum { PROBES = 50 };

/* Zeroes the scratch vectors y and z. */
static void clear(struct trial *t) {
    memset(t->y, 0, (size_t)t->n * sizeof *t->y), memset(t->z, 0, (size_t)t->n * sizeof *t->z);
}

/* ---- definitions ----------------------------------------------------------------------------- */

/* Energy and gradient are those of stiffness/2 max(0, value)^2. multiplier: scratch. */
static void check_energy(struct check *check, struct trial *t, double *multiplier) {
    const pdyn_one_sided *s = &t->batch->one_sided.at;
    double energy = 0.0;
    clear(t);
    batch_local(t->batch, t->x, t->y);
    for (int i = 0; i < s->count; i++) {
        double reached = fmax(0.0, s->value[i]);
        multiplier[i] = s->stiffness[i] * reached, energy += 0.5 * multiplier[i] * reached;
    }
    batch_force(t->batch, multiplier, t->z);
    if (!(fabs(energy - t->batch->energy) <= 1e-9 * fabs(energy)))
        fault(check,
              "the operator's energy is %.6g J, expected %.6g J, the sum of stiffness/2 max(0, "
              "value)^2",
              t->batch->energy, energy);
    if (trial_differ(t->y, t->z, t->n, 1e-9))
        fault(check,
              "the operator's gradient is not the force of the multipliers stiffness x value");
}

/* squares_i = |grad C_i|^2, and rate_i = grad C_i . u, or 0 if i is not marked. multiplier: zeros.
 */
static void check_gradients(struct check *check, struct trial *t, double *multiplier, double *rate,
                            bool *which) {
    const pdyn_one_sided *s = &t->batch->one_sided.at;
    for (int i = 0; i < s->count; i++) which[i] = i % 2, rate[i] = 1.0;
    batch_rate(t->batch, which, t->u, rate);
    for (int k = 0; k < PROBES; k++) {
        int i = (int)((long)k * s->count / PROBES);
        if (i >= s->count || !(s->stiffness[i] > 0.0)) continue;
        clear(t);
        multiplier[i] = 1.0, batch_force(t->batch, multiplier, t->z), multiplier[i] = 0.0;
        double squares = trial_dot(t->z, t->z, t->n), expected = trial_dot(t->z, t->u, t->n);
        if (!(fabs(s->squares[i] - squares) <= 1e-9 * squares)) {
            fault(check, "constraint %d of the operator has squares = %.6g, expected %.6g", i,
                  s->squares[i], squares);
            return;
        }
        if (!which[i]) expected = 0.0;
        if (!(fabs(rate[i] - expected) <= 1e-9 * sqrt(squares) * trial_norm(t->u, t->n))) {
            fault(check, "rate of constraint %d, which is %s, is %.6g, expected %.6g", i,
                  which[i] ? "marked" : "not marked", rate[i], expected);
            return;
        }
    }
}

/* Whether `sum`, n numbers that were 1 before a callback, is not 1 + `alone`. */
static bool is_no_sum(const double *sum, const double *alone, int n) {
    double error = 0.0;
    for (int k = 0; k < n; k++) error = fmax(error, fabs(sum[k] - alone[k] - 1.0));
    return !(error <= 1e-9 * (1.0 + trial_norm(alone, n)));
}

static void set_ones(double *a, int n) {
    for (int k = 0; k < n; k++) a[k] = 1.0;
}

/* local, force and diagonal add to what they find. ones: of every constraint. */
static void check_additions(struct check *check, struct trial *t, const double *ones) {
    const pdyn_operator *op = check->type->matrix_free;
    static const char text[] = "%s overwrites the vector that it has to add to";
    clear(t), set_ones(t->y, t->n);
    batch_local(t->batch, t->x, t->z), batch_local(t->batch, t->x, t->y);
    if (is_no_sum(t->y, t->z, t->n)) fault(check, text, "local");
    clear(t), set_ones(t->y, t->n);
    batch_force(t->batch, ones, t->z), batch_force(t->batch, ones, t->y);
    if (is_no_sum(t->y, t->z, t->n)) fault(check, text, "force");
    memset(t->da, 0, 2 * (size_t)t->n * sizeof *t->da), set_ones(t->db, 2 * t->n);
    op->diagonal(t->batch->op, ones, t->da), op->diagonal(t->batch->op, ones, t->db);
    if (is_no_sum(t->db, t->da, 2 * t->n)) fault(check, text, "diagonal");
}

void check_operator(struct check *check, struct trial *t) {
    if (!check->type->matrix_free) return;
    size_t count = (size_t)t->batch->one_sided.at.count;
    double *multiplier = NEW_ARRAY(t->context, count, double);
    double *rate = NEW_ARRAY(t->context, count, double);
    bool *which = NEW_ARRAY(t->context, count, bool);
    if (multiplier && rate && which) {
        check_energy(check, t, multiplier);
        memset(multiplier, 0, count * sizeof *multiplier);
        check_gradients(check, t, multiplier, rate, which);
        set_ones(multiplier, (int)count);
        check_additions(check, t, multiplier);
    }
    FREE_ARRAY(t->context, multiplier, count);
    FREE_ARRAY(t->context, rate, count);
    FREE_ARRAY(t->context, which, count);
}

/* ---- the model along a direction ------------------------------------------------------------- */

/* The one-sided constraints along a direction w: the change of the energy's slope from 0 to w is
 * the work of the change of the force. Scale 1e-10 keeps all constraints on their sides; then the
 * change of the force is H w. Scale 1 must change some sides. */
void check_model(struct check *check, struct trial *t) {
    if (!check->type->matrix_free) return;
    for (double scale = 1e-10; scale < 10.0; scale *= 1e10) {
        double unused;
        for (int k = 0; k < t->n; k++) t->w[k] = scale * t->u[k];
        clear(t);
        batch_local(t->batch, t->x, t->y);
        if (batch_linearise(t->batch, 0.0) != PDYN_OK) return;
        clear(t);
        batch_apply(t->batch, t->w, t->z);
        memcpy(t->y, t->z, (size_t)t->n * sizeof *t->y);
        batch_set_direction(t->batch, t->w);
        double from = batch_slope(t->batch, 0.0, &unused), to = batch_slope(t->batch, 1.0, &unused);
        int changed = batch_count_side_changes(t->batch);
        batch_step_along(t->batch, 1.0, t->y);
        if (!(fabs(trial_dot(t->w, t->y, t->n) - (to - from)) <= 1e-9 * (fabs(from) + fabs(to))))
            fault(check, "the operator's rate and force do not belong to one gradient");
        if (!changed && trial_differ(t->y, t->z, t->n, 1e-6))
            fault(check, "the operator's force along a direction is not its product");
        if ((changed == 0) != (scale < 0.5))
            fault(check, "%d of the operator's constraints change sides on a way of %.0g m",
                  changed, scale);
    }
}
