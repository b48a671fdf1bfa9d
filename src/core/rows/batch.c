/* Batches: a function here calls the operator of a type, or the loops over its rows (row_loops.h).
 */
#include "batch.h"

#include "row_loops.h"
#include "sph/surface_samples.h"

#include <string.h>

/* ---- operators: vectors that end with the values of samples ---------------------------------- */

/* u with the values of samples. A caller that has u in samples->input already saves a copy. */
static const double *with_samples(const struct batch *b, const double *u) {
    if (!b->samples) return u;
    samples_interpolate_active(b->samples, u);
    return b->samples->input;
}

/* The vector to which an operator adds; end_output distributes its samples and writes y. */
static double *begin_output(const struct batch *b, double *y) {
    if (!b->samples) return y;
    samples_clear(b->samples, y != b->samples->output);
    return b->samples->output;
}

static void end_output(const struct batch *b, double *y) {
    if (b->samples) samples_scatter(b->samples, y);
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* Whether elements come and go in every local step. */
static bool updates_always(const struct batch *b) {
    return b->type->update && b->type->flags & PDYN_EVERY_ITERATION;
}

void batch_set_step(struct batch *b, const struct batch_step *step) {
    b->view.h = step->h, b->view.time = step->time;
    b->view.length = step->length, b->view.extrapolation = step->extrapolation;
}

pdyn_status batch_begin(struct batch *b, const struct step_start *start,
                        const struct batch_step *step) {
    pdyn_status status = PDYN_OK;
    batch_set_step(b, step);
    if (b->op && b->type->matrix_free->begin) b->type->matrix_free->begin(b->op, step->length);
    if (b->type->update && !updates_always(b)) status = rows_update(b, start->x, start->v);
    if (status != PDYN_OK) return status;
    if (b->damper) rows_begin_damper(b, start);
    if (b->damper || !b->type->begin) return PDYN_OK;
    rows_begin(b, start);
    return rows_check_weights(b);
}

/* After the local step of an operator: sides, and D with the part of samples. */
static pdyn_status begin_one_sided(struct batch *b) {
    struct one_sided *s = &b->one_sided;
    pdyn_status status = one_sided_begin(s);
    if (status != PDYN_OK || !b->samples) return status;
    samples_lump(b->samples, s->at.weight_sum, b->lumped);
    s->D = b->lumped;
    return PDYN_OK;
}

pdyn_status batch_local(struct batch *b, const double *x, double *gradient) {
    if (b->op) {
        b->energy = b->type->matrix_free->local(b->op, x, begin_output(b, gradient));
        end_output(b, gradient);
        return begin_one_sided(b);
    }
    b->energy = 0.0;
    if (updates_always(b)) {
        pdyn_status status = rows_update(b, x, NULL);
        if (status != PDYN_OK) return status;
    }
    if (b->linear) {
        b->energy = linear_rows_energy(b->linear, x, gradient);
        return PDYN_OK;
    }
    b->energy = rows_project(b, x);
    rows_scatter(b, gradient);
    return PDYN_OK;
}

/* ---- the linear model ------------------------------------------------------------------------ */

pdyn_status batch_linearise(struct batch *b, double eps) {
    b->eps = eps;
    return b->op ? PDYN_OK : rows_linearise(b);
}

void batch_apply(struct batch *b, const double *u, double *y) {
    if (b->op) {
        struct one_sided *s = &b->one_sided;
        one_sided_apply(s, b->eps, with_samples(b, u), begin_output(b, y));
        end_output(b, y);
        one_sided_apply_projective(s, b->eps, 0, s->particles, u, y);
        return;
    }
    if (b->linear) {
        linear_rows_apply(b->linear, u, y);
        return;
    }
    rows_multiply(b, u);
    rows_scatter(b, y);
}

void batch_apply_remainder(struct batch *b, int first, int last, const double *u, double *y) {
    if (b->op) one_sided_apply_projective(&b->one_sided, b->eps, first, last, u, y);
    else batch_apply(b, u, y);
}

void batch_rate(struct batch *b, const bool *which, const double *u, double *rate) {
    b->type->matrix_free->rate(b->op, which, with_samples(b, u), rate);
}

void batch_force(struct batch *b, const double *multiplier, double *y) {
    b->type->matrix_free->force(b->op, multiplier, begin_output(b, y));
    end_output(b, y);
}

static bool has_sides(const struct batch *b) { return b->op && b->eps < 1.0; }

void batch_set_direction(struct batch *b, const double *u) {
    if (has_sides(b)) one_sided_set_direction(&b->one_sided, with_samples(b, u));
}

int batch_count_side_changes(struct batch *b) {
    return has_sides(b) ? one_sided_count_side_changes(&b->one_sided) : 0;
}

double batch_slope(struct batch *b, double t, double *curvature) {
    *curvature = 0.0;
    return b->op ? one_sided_slope(&b->one_sided, b->eps, t, curvature) : 0.0;
}

void batch_step_along(struct batch *b, double t, double *y) {
    if (!b->op) return;
    one_sided_step_along(&b->one_sided, b->eps, t, begin_output(b, y));
    end_output(b, y);
}

/* Blocks of samples go to the particles of their triangles. */
static void operator_diagonal(struct batch *b, double *blocks) {
    struct one_sided *s = &b->one_sided;
    if (b->samples) samples_clear_blocks(b->samples);
    one_sided_diagonal(s, b->eps, b->samples ? b->samples->blocks : blocks);
    if (b->samples) samples_scatter_blocks(b->samples, blocks);
    one_sided_diagonal_projective(s, b->eps, blocks);
}

void batch_diagonal(struct batch *b, double *blocks) {
    if (b->op) operator_diagonal(b, blocks);
    else if (b->linear) linear_rows_diagonal(b->linear, blocks);
    else rows_diagonal(b, blocks);
}

void batch_diagonal_remainder(struct batch *b, double *blocks) {
    if (b->op) one_sided_diagonal_projective(&b->one_sided, b->eps, blocks);
    else batch_diagonal(b, blocks);
}

/* ---- after a step ---------------------------------------------------------------------------- */

bool batch_pins(const struct batch *b, const pdyn_body *body) {
    return b->type->flags & PDYN_REACTION && b->view.body == body && !b->off;
}

bool batch_pins_particle(const struct batch *b, int particle) {
    int i = particle - b->touch_first;
    return b->type->flags & PDYN_REACTION && !b->off && i >= 0 && i < b->touch_count &&
           b->touch_start[i + 1] > b->touch_start[i];
}

bool batch_has_impacts(const struct batch *b) {
    return b->op || type_is_one_sided(b->type, b->params);
}

void batch_find_acceleration(struct batch *b, const struct velocity_change *change) {
    double *a = change->acceleration;
    int n = 3 * change->particles;
    memset(a, 0, (size_t)n * sizeof *a);
    if (b->op) {
        one_sided_forces(&b->one_sided, begin_output(b, a));
        end_output(b, a);
    } else rows_scatter(b, a);
    if (change->rigid) rigid_map_pull(change->rigid, a);
    for (int k = 0; k < n; k++) a[k] /= change->mass[k / 3];
    if (change->rigid) rigid_map_extend(change->rigid, a);
}

/* The rate after the step is not known where boundary points may take part: where the particle of a
 * constraint has some in its list, and for constraints that are no particle's. */
static void forget_solids(double *after, int count, const pdyn_neighbours *lists,
                          const pdyn_body *body) {
    for (int i = 0; i < count; i++) {
        int particle = body->first + i;
        bool known = i < body->count && lists->boundary_start[particle] == lists->end[particle];
        if (!known) after[i] = -INFINITY;
    }
}

static int operator_impacts(struct batch *b, const struct velocity_change *change, double *force) {
    struct one_sided *s = &b->one_sided;
    /* arrays of no use after the minimisation */
    double *slowed = s->rate, *acceleration = s->reached, *after = s->multiplier;
    batch_rate(b, s->acts, change->acceleration, acceleration);
    batch_rate(b, s->acts, change->slowed, slowed);
    batch_rate(b, s->acts, change->after, after);
    forget_solids(after, s->at.count, change->lists, b->view.body);
    struct rate_change rates = {.slowed = slowed,
                                .after = after,
                                .acceleration = acceleration,
                                .mass = b->view.body->mass[0],
                                .h = change->h,
                                .taken = change->taken,
                                .solved = change->solved};
    int count = one_sided_impacts(s, &rates, begin_output(b, force));
    end_output(b, force);
    return count;
}

int batch_impacts(struct batch *b, const struct velocity_change *change, double *force) {
    if (!batch_has_impacts(b)) return 0;
    batch_find_acceleration(b, change);
    for (int k = 0; change->yield && k < 3 * change->particles; k++)
        change->acceleration[k] *= change->yield[k / 3];
    return b->op ? operator_impacts(b, change, force) : rows_impacts(b, change, force);
}

/* Whether it has rows whose forces can be impacts. */
static bool has_impact_rows(const struct batch *b) {
    return batch_has_impacts(b) && !b->op && b->view.elements;
}

bool batch_impacts_between(const struct batch *b, double *force) {
    if (!has_impact_rows(b)) return false;
    rows_scatter_between(b, force);
    return true;
}

void batch_join_impacts(const struct batch *b, int *group) {
    if (has_impact_rows(b)) rows_join_between(b, group);
}

void batch_join_bodies(const struct batch *b, int *group) {
    const pdyn_body *body = b->view.body;
    bool within = !(b->type->flags & PDYN_CONTACT) && b->touch_first >= body->first &&
                  b->touch_first + b->touch_count <= body->first + body->count;
    if (b->view.elements && !within) rows_join(b, 0, b->view.element_row[b->view.elements], group);
}

void batch_keep_impacts(struct batch *b, const double *kept) {
    if (has_impact_rows(b)) rows_keep_impacts(b, kept);
}

void batch_limit(struct batch *b, const double *x, double *max_step) {
    if (b->op && b->type->matrix_free->limit) b->type->matrix_free->limit(b->op, x, max_step);
}

static double sum_stored(const struct batch *b) {
    double sum = 0.0;
    for (int i = 0; i < b->one_sided.at.count; i++) sum += one_sided_energy(&b->one_sided, i);
    return sum;
}

/* The forces of the step are stored first: `accept` may change the stiffness. */
void batch_accept(struct batch *b, double left_out, bool solved) {
    b->left_out = batch_has_impacts(b) ? left_out : 0.0;
    if (!b->op) return;
    const pdyn_operator *op = b->type->matrix_free;
    one_sided_store_forces(&b->one_sided, left_out, solved);
    if (op->stored) b->energy = sum_stored(b);
    if (op->accept) op->accept(b->op);
}

void batch_velocity(struct batch *b, double *v) {
    if (!b->op || !b->type->matrix_free->velocity) return;
    if (!b->samples) {
        b->type->matrix_free->velocity(b->op, v);
        return;
    }
    samples_interpolate_active(b->samples, v);
    b->type->matrix_free->velocity(b->op, b->samples->input);
    memcpy(v, b->samples->input, 3 * (size_t)b->samples->particles * sizeof *v);
}

void batch_mark_selected(const struct batch *b, bool *selected) {
    for (int i = 0; i < b->touch_count; i++)
        selected[b->touch_first + i] |= b->touch_start[i + 1] > b->touch_start[i];
}
