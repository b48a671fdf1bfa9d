#include "row_arrays.h"

#include "projdyn/simd.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PARTICLES = 1024 }; /* of a parallel block */
enum { PIECE = 256 }; /* elements of one call of a callback, so that they stay in the L1 cache */

struct call { /* the arguments of a parallel loop over a batch */
    struct batch *batch;
    const double *in;
    double *out;
    double number; /* eps, or the length of a step */
};

struct impacts { /* the arguments of a parallel loop over the impacts of a batch */
    struct batch *batch;
    const struct velocity_change *change;
};

static void for_range(struct batch *batch, int count, int grain, pdyn_range_fn *fn,
                      const double *in, double *out, double number) {
    struct call call = {batch, in, out, number};
    pool_for(batch->context->pool, count, grain, fn, &call);
}

/* ---- operators: vectors that end with the values of samples ---------------------------------- */

/* u with the values of samples. A caller that has u in samples->input already saves a copy. */
static const double *extend(const struct batch *b, const double *u) {
    if (!b->samples) return u;
    samples_interpolate_active(b->samples, u);
    return b->samples->input;
}

/* The vector to which an operator adds; end_output distributes its samples and writes y. */
static double *begin_output(const struct batch *b, double *y) {
    if (!b->samples) return y;
    size_t all = 3 * (size_t)b->one_sided.particles;
    size_t own = y == b->samples->output ? 3 * (size_t)b->samples->particles : 0;
    memset(b->samples->output + own, 0, (all - own) * sizeof *y);
    return b->samples->output;
}

static void end_output(const struct batch *b, double *y) {
    if (b->samples) samples_scatter(b->samples, b->samples->output, y);
}

/* ---- the rows: u = G x, flux -> particles ---------------------------------------------------- */

/* u = sum over `width` entries from k on */
INLINE void gather_entries(const pdyn_batch *v, int k, int width, const double *x, v4 *u) {
    *u = (v4){0};
    for (int end = k + width; k < end; k++) {
        v4 at;
        memcpy(&at, x + 3 * (size_t)v->column[k], sizeof at);
        *u += v->coefficient[k] * at;
    }
}

/* u of row r; the loop over two entries is unrolled */
INLINE void gather_row(const struct batch *b, int r, const double *x, v4 *u) {
    const int *entry = b->view.row_entry + r;
    if (b->width == 2) gather_entries(&b->view, 2 * r, 2, x, u);
    else gather_entries(&b->view, entry[0], entry[1] - entry[0], x, u);
}

WIDE static void gather_rows(const struct batch *b, int first, int last, const double *x) {
    for (int r = first; r < last; r++) {
        v4 u;
        gather_row(b, r, x, &u);
        memcpy((double *)b->view.u + 3 * (size_t)r, &u, 3 * sizeof(double));
    }
}

/* out += G' flux, by particles, so that threads write to different places */
WIDE static void scatter_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        v4 sum = {0};
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            v4 flux;
            memcpy(&flux, b->flux + 4 * (size_t)b->touch[t].row, sizeof flux);
            sum += b->touch[t].coefficient * flux;
        }
        v4_add_to(c->out + 3 * (size_t)(b->touch_first + i), &sum);
    }
}

void batch_scatter(struct batch *b, double *y) {
    for_range(b, b->touch_count, PARTICLES, scatter_rows, NULL, y, 0.0);
}

/* ---- local step ------------------------------------------------------------------------------ */

/* flux = w (u - p) in row r; adds twice the energy of the row. */
INLINE void pull_row(const struct batch *b, int r, double w, v4 *energy) {
    v4 u, p, f; /* fourth lanes are undefined */
    memcpy(&u, b->view.u + 3 * (size_t)r, sizeof u);
    memcpy(&p, b->view.p + 3 * (size_t)r, sizeof p);
    u -= p;
    f = w * u;
    *energy += f * u;
    memcpy(b->flux + 4 * (size_t)r, &f, sizeof f);
}

/* flux of the elements [first, last). Returns their energy w/2 |u - p|^2. */
WIDE static double pull_rows(struct batch *b, int first, int last) {
    const pdyn_batch *v = &b->view;
    v4 energy = {0};
    for (int e = first; e < last; e++)
        if (b->single) pull_row(b, e, v->weight[e], &energy);
        else
            for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++)
                pull_row(b, r, v->weight[e], &energy);
    return 0.5 * (energy[0] + energy[1] + energy[2]);
}

/* Works in pieces whose u, p and flux stay in the L1 cache. */
static void local_rows(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct batch *b = c->batch;
    const pdyn_batch *v = &b->view;
    double energy = 0.0;
    for (int e = first, end; e < last; e = end) {
        end = last - e > PIECE ? e + PIECE : last;
        gather_rows(b, v->element_row[e], v->element_row[end], c->in);
        b->type->project(b->params, v, e, end);
        double squares = pull_rows(b, e, end);
        energy += b->type->energy && !b->off ? b->type->energy(b->params, v, e, end) : squares;
    }
    b->partial[block] = energy;
}

/* Whether elements come and go in every local step. */
static bool updates_always(const struct batch *b) {
    return b->type->update && b->type->flags & PDYN_EVERY_ITERATION;
}

pdyn_status batch_local(struct batch *b, const double *x, double time, double *gradient) {
    b->view.time = time;
    if (b->op) {
        b->energy = b->type->matrix_free->local(b->op, x, begin_output(b, gradient));
        end_output(b, gradient);
        return one_sided_begin(&b->one_sided);
    }
    b->energy = 0.0;
    if (updates_always(b)) {
        pdyn_status status = batch_update(b, x, NULL);
        if (status != PDYN_OK) return status;
    }
    if (b->linear) {
        b->energy = linear_rows_energy(b->linear, x, gradient);
        return PDYN_OK;
    }
    for_range(b, b->view.elements, BATCH_GRAIN, local_rows, x, NULL, 0.0);
    for (int k = 0; k < pool_blocks(b->view.elements, BATCH_GRAIN); k++) b->energy += b->partial[k];
    batch_scatter(b, gradient);
    return PDYN_OK;
}

/* ---- the beginning of a step ----------------------------------------------------------------- */

static void hold_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    gather_rows(b, b->view.element_row[first], b->view.element_row[last], c->in);
    b->type->damping_rest(b->params, &b->view, first, last);
}

static void weigh_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    double part = b->type->damping(b->params) / c->number;
    rows_weigh(b, first, last);
    for (int e = first; e < last; e++) b->view.weight[e] *= part;
}

void batch_weigh(struct batch *b, double h) {
    if (b->damper) for_range(b, b->view.elements, BATCH_GRAIN, weigh_rows, NULL, NULL, h);
}

/* in: x; out: v */
static void begin_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    int row = b->view.element_row[first], end = b->view.element_row[last];
    gather_rows(b, row, end, c->out);
    memcpy(b->view.p + 3 * (size_t)row, b->view.u + 3 * (size_t)row,
           3 * (size_t)(end - row) * sizeof(double));
    gather_rows(b, row, end, c->in);
    b->type->begin(b->params, &b->view, first, last);
    rows_weigh(b, first, last);
}

pdyn_status batch_open(struct batch *b, const double *x, const double *v,
                       const struct batch_step *step) {
    b->view.h = step->h, b->view.time = step->time;
    b->view.length = step->length, b->view.extrapolation = step->extrapolation;
    return b->type->update && !updates_always(b) ? batch_update(b, x, v) : PDYN_OK;
}

bool batch_begin(struct batch *b, const double *x, const double *v, double h) {
    b->view.h = h;
    if (b->damper) for_range(b, b->view.elements, BATCH_GRAIN, hold_rows, x, NULL, 0.0);
    batch_weigh(b, h);
    if (!b->damper && b->type->begin)
        for_range(b, b->view.elements, BATCH_GRAIN, begin_rows, x, (double *)v, 0.0);
    return !b->damper && b->type->begin;
}

/* ---- tangent --------------------------------------------------------------------------------- */

/* B = w (I - (1 - eps) J), in place of J, n x n numbers */
INLINE void damp_block(double *B, int n, double w, double eps) {
    for (int k = 0; k < n * n; k++) B[k] *= -w * (1.0 - eps);
    for (int k = 0; k < n; k++) B[k * n + k] += w;
}

WIDE static void damp_blocks(struct batch *b, int first, int last, double eps) {
    const pdyn_batch *v = &b->view;
    for (int e = first; e < last; e++) {
        int rows = v->element_row[e + 1] - v->element_row[e];
        double *B = b->block + b->block_start[e];
        if (rows == 1) damp_block(B, 3, v->weight[e], eps);
        else damp_block(B, 3 * rows, v->weight[e], eps);
    }
}

static void linearise_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    for (int e = first, end; e < last; e = end) {
        end = last - e > PIECE ? e + PIECE : last;
        double *J = b->block + b->block_start[e];
        memset(J, 0, (b->block_start[end] - b->block_start[e]) * sizeof *J);
        b->type->tangent(b->params, &b->view, e, end, J);
        damp_blocks(b, e, end, c->number);
    }
}

/* B = m m' + a I from J = s I - a a', in place of it: 4 numbers of each element, which has one row.
 */
WIDE static void damp_axes(struct batch *b, int first, int last, double eps) {
    double *B = b->block + b->block_start[first], root[PIECE];
    const double *w = b->view.weight + first;
    for (int k = 0; k < last - first; k++) root[k] = sqrt((1.0 - eps) * w[k]);
    for (int k = 0; k < last - first; k++, B += 4) {
        for (int a = 0; a < 3; a++) B[a] *= root[k];
        B[3] = w[k] * (1.0 - (1.0 - eps) * B[3]);
    }
}

/* As damp_axes, for elements of any number of rows. */
static void damp_wide(struct batch *b, int first, int last, double eps) {
    for (int e = first; e < last; e++) {
        double w = b->view.weight[e], *B = b->block + b->block_start[e];
        size_t n = b->block_start[e + 1] - b->block_start[e] - 1;
        for (size_t k = 0; k < n; k++) B[k] *= sqrt((1.0 - eps) * w);
        B[n] = w * (1.0 - (1.0 - eps) * B[n]);
    }
}

static void linearise_axes(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    for (int e = first, end; e < last; e = end) {
        end = last - e > PIECE ? e + PIECE : last;
        b->type->tangent_rank1(b->params, &b->view, e, end, b->block + b->block_start[e]);
        (b->wide ? damp_wide : damp_axes)(b, e, end, c->number);
    }
}

size_t batch_block_numbers(const struct batch *b) { return b->block_start[b->room.elements] + 1; }

pdyn_status batch_linearise(struct batch *b, double eps) {
    b->eps = eps;
    if (b->op || !batch_has_blocks(b) || !b->rows) return PDYN_OK;
    if (!b->block) b->block = NEW_ARRAY(b->context, batch_block_numbers(b), double);
    if (!b->block) return PDYN_NO_MEMORY;
    for_range(b, b->view.elements, BATCH_GRAIN,
              b->type->tangent_rank1 ? linearise_axes : linearise_rows, NULL, NULL, eps);
    return PDYN_OK;
}

/* flux = B u for element e, which has `rows` rows from `first` on; B = w I for eps = 1 */
INLINE void multiply_element(const struct batch *b, int e, int first, int rows, const double *x) {
    double *flux = b->flux + 4 * (size_t)first;
    const double *B = batch_has_blocks(b) ? b->block + b->block_start[e] : NULL;
    for (int s = 0; s < rows; s++) {
        v4 u, f, column;
        gather_row(b, first + s, x, &u);
        for (int r = 0; r < rows; r++) {
            if (s) memcpy(&f, flux + 4 * r, sizeof f);
            else f = (v4){0};
            if (!B && r == s) f += b->view.weight[e] * u;
            for (int a = 0; B && a < 3; a++) { /* B is symmetric: a row is a column */
                memcpy(&column, B + 3 * (3 * s + a) * rows + 3 * r, sizeof column);
                f += u[a] * column;
            }
            memcpy(flux + 4 * r, &f, sizeof f);
        }
    }
}

/* flux = B u for element e of one row with B = m m' + a I */
INLINE void multiply_axis(const struct batch *b, int e, const double *x) {
    v4 u, f, B;
    gather_row(b, e, x, &u);
    v4_load(&B, b->block, e);
    f = v4_dot(&B, &u) * B + B[3] * u;
    v4_store(b->flux, e, &f);
}

WIDE static void apply_axes(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int e = first; e < last; e++) multiply_axis(c->batch, e, c->in);
}

/* flux = B u for element e with B = m m' + a I */
INLINE void multiply_wide(const struct batch *b, int e, const double *x) {
    int first = b->view.element_row[e], last = b->view.element_row[e + 1];
    const double *m = b->block + b->block_start[e], a = m[3 * (size_t)(last - first)];
    v4 along = {0};
    for (int r = first; r < last; r++) {
        v4 u, part;
        gather_row(b, r, x, &u);
        memcpy(&part, m + 3 * (size_t)(r - first), sizeof part);
        along += part * u;
        u *= a;
        v4_store(b->flux, r, &u);
    }
    double dot = along[0] + along[1] + along[2];
    for (int r = first; r < last; r++) {
        v4 part;
        memcpy(&part, m + 3 * (size_t)(r - first), sizeof part);
        v4_add_to(b->flux + 4 * (size_t)r, &(v4){dot * part[0], dot * part[1], dot * part[2]});
    }
}

WIDE static void apply_wide(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int e = first; e < last; e++) multiply_wide(c->batch, e, c->in);
}

WIDE static void apply_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int e = first; e < last; e++)
        if (b->single) multiply_element(b, e, e, 1, c->in);
        else {
            int r = b->view.element_row[e];
            multiply_element(b, e, r, b->view.element_row[e + 1] - r, c->in);
        }
}

static pdyn_range_fn *apply_of(const struct batch *b) {
    if (!b->type->tangent_rank1 || !batch_has_blocks(b)) return apply_rows;
    return b->wide ? apply_wide : apply_axes;
}

void batch_apply(struct batch *b, const double *u, double *y) {
    if (b->op) {
        one_sided_apply(&b->one_sided, b->eps, extend(b, u), begin_output(b, y));
        end_output(b, y);
        return;
    }
    if (b->linear) {
        linear_rows_apply(b->linear, u, y);
        return;
    }
    for_range(b, b->view.elements, BATCH_GRAIN, apply_of(b), u, NULL, 0.0);
    batch_scatter(b, y);
}

void batch_apply_rest(struct batch *b, const double *u, double *y) {
    if (!b->op) {
        batch_apply(b, u, y);
    } else if (b->eps > 0.0) {
        one_sided_apply_held(&b->one_sided, b->eps, extend(b, u), begin_output(b, y));
        end_output(b, y);
    }
}

void batch_rate(struct batch *b, const bool *which, const double *u, double *rate) {
    b->type->matrix_free->rate(b->op, which, extend(b, u), rate);
}

void batch_force(struct batch *b, const double *multiplier, double *y) {
    b->type->matrix_free->force(b->op, multiplier, begin_output(b, y));
    end_output(b, y);
}

static bool has_sides(const struct batch *b) { return b->op && b->eps < 1.0; }

void batch_set_direction(struct batch *b, const double *u) {
    if (has_sides(b)) one_sided_set_direction(&b->one_sided, extend(b, u));
}

int batch_count_side_changes(struct batch *b) {
    return has_sides(b) ? one_sided_count_side_changes(&b->one_sided) : 0;
}

double batch_slope(struct batch *b, double t, double *curvature) {
    *curvature = 0.0;
    return b->op ? one_sided_slope(&b->one_sided, b->eps, t, curvature) : 0.0;
}

int batch_step_along(struct batch *b, double t, double *y) {
    if (!b->op) return 0;
    int changed = one_sided_step_along(&b->one_sided, b->eps, t, begin_output(b, y));
    end_output(b, y);
    return changed;
}

/* change->scratch = minus the acceleration by all forces of the batch at the last local step: the
 * gradient of its energy over the masses. */
static void find_acceleration(struct batch *b, const struct velocity_change *change) {
    double *a = change->scratch;
    int n = 3 * change->particles;
    memset(a, 0, (size_t)n * sizeof *a);
    if (b->op) {
        one_sided_forces(&b->one_sided, begin_output(b, a));
        end_output(b, a);
    } else batch_scatter(b, a);
    if (change->rigid) rigid_map_pull(change->rigid, a);
    for (int k = 0; k < n; k++) a[k] /= change->mass[k / 3];
    if (change->rigid) rigid_map_extend(change->rigid, a);
}

/* Replaces the flux of each row by its impact part. As in one_sided.c, the change of velocity is
 * the larger of two: by this row alone, and by all rows, because the contacts of a point share the
 * force that stops it. */
static void keep_impacts(void *arg, int first, int last, int block) {
    const struct impacts *c = arg;
    struct batch *b = c->batch;
    const pdyn_batch *v = &b->view;
    double count = 0.0, h = c->change->h;
    for (int r = v->element_row[first]; r < v->element_row[last]; r++) {
        v4 flux, slowed, acceleration;
        double softness = 0.0, part = 0.0;
        v4_load(&flux, b->flux, r);
        gather_row(b, r, c->change->slowed, &slowed);
        gather_row(b, r, c->change->scratch, &acceleration);
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
            softness += v->coefficient[k] * v->coefficient[k] / c->change->mass[v->column[k]];
        double force = sqrt(v4_dot(&flux, &flux));
        double weight = v->weight[b->entry_element[v->row_entry[r]]];
        if (force > 0.0) {
            double all = v4_dot(&flux, &acceleration) / force;
            part = impact_part(v4_dot(&flux, &slowed) / force, h * fmax(all, force * softness),
                               h * h * weight * softness);
        }
        flux *= part;
        v4_store(b->flux, r, &flux);
        count += part > 0.5;
    }
    b->partial[block] = count;
}

static int row_impacts(struct batch *b, const struct velocity_change *change, double *force) {
    struct impacts impacts = {b, change};
    double count = 0.0;
    pool_for(b->context->pool, b->view.elements, BATCH_GRAIN, keep_impacts, &impacts);
    for (int k = 0; k < pool_blocks(b->view.elements, BATCH_GRAIN); k++) count += b->partial[k];
    batch_scatter(b, force);
    return (int)count;
}

static int operator_impacts(struct batch *b, const struct velocity_change *change, double *force) {
    one_sided_rate_acceleration(&b->one_sided, extend(b, change->scratch));
    one_sided_rate_slowed(&b->one_sided, extend(b, change->slowed));
    int count = one_sided_impacts(&b->one_sided, change->mass[b->view.body->first], change->h,
                                  begin_output(b, force));
    end_output(b, force);
    return count;
}

int batch_impacts(struct batch *b, const struct velocity_change *change, double *force) {
    if (!b->op && !(b->type->flags & PDYN_ONE_SIDED)) return 0;
    find_acceleration(b, change);
    return b->op ? operator_impacts(b, change, force) : row_impacts(b, change, force);
}

void batch_limit(struct batch *b, const double *x, double *way) {
    if (b->op && b->type->matrix_free->limit) b->type->matrix_free->limit(b->op, x, way);
}

/* The forces of the step are stored first: `accept` may change the stiffness. */
void batch_accept(struct batch *b) {
    if (!b->op) return;
    one_sided_store_forces(&b->one_sided);
    if (b->type->matrix_free->accept) b->type->matrix_free->accept(b->op);
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

/* The part of m m' + a I between two rows with the parts m and n of m; a: 0 unless they are the
 * same. */
static void block_of_axis(const double *m, const double *n, double a, double B[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) B[3 * i + j] = m[i] * n[j] + (i == j ? a : 0.0);
}

void batch_block(const struct batch *b, int k, int m, double B[9]) {
    int e = b->entry_element[k], r0 = b->view.element_row[e],
        n = 3 * (b->view.element_row[e + 1] - r0);
    bool same = b->entry_row[k] == b->entry_row[m], blocks = batch_has_blocks(b);
    const double *own = blocks ? b->block + b->block_start[e] : NULL;
    if (blocks && b->type->tangent_rank1) {
        block_of_axis(own + 3 * (b->entry_row[k] - r0), own + 3 * (b->entry_row[m] - r0),
                      same ? own[n] : 0.0, B);
        return;
    }
    const double *from =
        blocks ? own + 3 * (b->entry_row[k] - r0) * n + 3 * (b->entry_row[m] - r0) : NULL;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            B[3 * i + j] = from ? from[i * n + j] : same && i == j ? b->view.weight[e] : 0.0;
}

/* ---- block diagonal -------------------------------------------------------------------------- */

/* Adds the contribution of entry k to the block of its particle: its pairs with those entries of
 * the same element that select the same particle. */
static void diagonal_of_entry(const struct batch *b, int k, double *block) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const pdyn_batch *v = &b->view;
    int e = b->entry_element[k], r0 = v->element_row[e], r1 = v->element_row[e + 1];
    if (!batch_has_blocks(b)) r0 = b->entry_row[k], r1 = r0 + 1; /* B = w I */
    for (int m = v->row_entry[r0]; m < v->row_entry[r1]; m++) {
        if (v->column[m] != v->column[k]) continue;
        double B[9], c = v->coefficient[k] * v->coefficient[m];
        batch_block(b, k, m, B);
        for (int a = 0; a < 6; a++) block[a] += c * B[3 * row[a] + column[a]];
    }
}

static void diagonal_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++)
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++)
            diagonal_of_entry(b, b->touch[t].entry, c->out + 6 * (size_t)(b->touch_first + i));
}

/* Adds to the blocks of particles [first, last) where each element is a row that selects no
 * particle twice. */
WIDE static void diagonal_single(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i), zz = 0.0, plain = 0.0;
        v4 low = {0}, high = {0}, part;
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            const struct touch *at = &b->touch[t];
            double square = at->coefficient * at->coefficient;
            if (!batch_has_blocks(b)) {
                plain += b->view.weight[at->row] * square;
                continue;
            }
            const double *B = b->block + 9 * (size_t)at->row;
            memcpy(&part, B, sizeof part), low += square * part;
            memcpy(&part, B + 4, sizeof part), high += square * part;
            zz += square * B[8];
        }
        out[0] += low[0] + plain, out[1] += low[1], out[2] += low[2];
        out[3] += high[0] + plain, out[4] += high[1], out[5] += zz + plain;
    }
}

/* As diagonal_single, for B = m m' + a I. */
WIDE static void diagonal_axes(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i), zz = 0.0, plain = 0.0;
        v4 x = {0}, y = {0}, B;
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            double square = b->touch[t].coefficient * b->touch[t].coefficient;
            v4_load(&B, b->block, b->touch[t].row);
            x += square * B[0] * B, y += square * B[1] * B;
            zz += square * B[2] * B[2], plain += square * B[3];
        }
        out[0] += x[0] + plain, out[1] += x[1], out[2] += x[2];
        out[3] += y[1] + plain, out[4] += y[2], out[5] += zz + plain;
    }
}

/* As diagonal_axes, for elements of any number of rows: the entries of a particle in an element
 * have the sum m of their parts of m, and add m m'. */
static void diagonal_wide(void *arg, int first, int last, int block) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i);
        for (int t = b->touch_start[i], end = b->touch_start[i + 1]; t < end;) {
            int e = b->entry_element[b->touch[t].entry], r0 = b->view.element_row[e];
            double m[3] = {0}, plain = 0.0;
            for (; t < end && b->entry_element[b->touch[t].entry] == e; t++) {
                double k = b->touch[t].coefficient;
                vec3_add(m, k, b->block + b->block_start[e] + 3 * (b->touch[t].row - r0));
                plain += k * k * b->block[b->block_start[e + 1] - 1];
            }
            for (int a = 0; a < 6; a++)
                out[a] += m[row[a]] * m[column[a]] + (row[a] == column[a] ? plain : 0.0);
        }
    }
}

/* The function that adds the blocks of a range of particles. */
static pdyn_range_fn *diagonal_of(const struct batch *b) {
    if (b->wide && batch_has_blocks(b)) return diagonal_wide;
    if (!b->single) return diagonal_rows;
    return b->type->tangent_rank1 && batch_has_blocks(b) ? diagonal_axes : diagonal_single;
}

typedef void one_sided_diagonal_fn(struct one_sided *s, double eps, double *blocks);

/* Adds the diagonal of an operator; blocks of samples go to the particles of their triangles. */
static void operator_diagonal(struct batch *b, one_sided_diagonal_fn *add, double *blocks) {
    if (!b->samples) {
        add(&b->one_sided, b->eps, blocks);
        return;
    }
    memset(b->samples->blocks, 0, 6 * (size_t)b->one_sided.particles * sizeof *blocks);
    add(&b->one_sided, b->eps, b->samples->blocks);
    samples_scatter_blocks(b->samples, b->samples->blocks, blocks);
}

void batch_diagonal(struct batch *b, double *blocks) {
    if (b->op) operator_diagonal(b, one_sided_diagonal, blocks);
    else if (b->linear) linear_rows_diagonal(b->linear, blocks);
    else for_range(b, b->touch_count, PARTICLES, diagonal_of(b), NULL, blocks, 0.0);
}

void batch_rest_diagonal(struct batch *b, double *blocks) {
    if (b->op) operator_diagonal(b, one_sided_held_diagonal, blocks);
    else batch_diagonal(b, blocks);
}

void batch_mark_held(const struct batch *b, bool *held) {
    for (int i = 0; i < b->touch_count; i++)
        held[b->touch_first + i] |= b->touch_start[i + 1] > b->touch_start[i];
}
