/* E, its gradient and products with H: inertia, by loops over particles, then all batches. */
#include "objective.h"

#include "base/clock.h"
#include "contact/contact.h"
#include "projdyn/simd.h"
#include "projdyn/vec3.h"
#include "residual.h"

#include <math.h>
#include <string.h>

struct call {
    struct objective *objective;
    const double *a, *b;
    double *out;
    double scale;
};

/* Returns the number of blocks. */
static int for_particles(struct objective *o, pdyn_range_fn *fn, const double *a, double *out,
                         double scale) {
    struct call call = {.objective = o, .a = a, .out = out, .scale = scale};
    return pool_for_between(o->context->pool, 0, o->particles, PARTICLE_GRAIN, fn, &call);
}

double objective_partial_sum(const struct objective *o, int blocks) {
    double sum = 0.0;
    for (int k = 0; k < blocks; k++) sum += o->partial[k];
    return sum;
}

int objective_body_of(const struct objective *o, int particle) {
    int low = 0, high = o->bodies;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (o->body[middle].first <= particle) low = middle;
        else high = middle;
    }
    return low;
}

pdyn_status objective_add_batch(struct objective *o, const struct batch_def *def,
                                struct batch **added) {
    struct batch **last = &o->batch[o->batches];
    pdyn_status status = batch_create(o->context, def, last);
    if (status != PDYN_OK) return status;
    o->batches++;
    if (added) *added = *last;
    return PDYN_OK;
}

/* Counts as work: one pass over all rows, and `one_sided` passes over all one-sided constraints. */
static void count_work(struct objective *o, int one_sided) {
    for (int b = 0; b < o->batches; b++)
        objective_count(o, o->batch[b], o->batch[b]->op ? one_sided : 1);
}

/* Counts as work: the vector operations of an iteration of a linear solver on so many particles,
 * and the extension of vectors to the vertices of rigid bodies. */
static void count_vectors(struct objective *o, int particles) {
    int rigid = 0;
    for (int k = 0; o->rigid && k < o->rigid->bodies; k++) rigid += o->rigid->body[k].vertices;
    o->work += (int64_t)WORK_OF_VECTORS * (particles + rigid);
}

/* ---- energy and gradient --------------------------------------------------------------------- */

static void inertia(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    double energy = 0.0;
    for (int i = first; i < last; i++) {
        double w = objective_inertia(c->objective, i);
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            double d = c->a[k] - c->objective->s[k];
            c->out[k] = w * d;
            energy += 0.5 * w * d * d;
        }
    }
    c->objective->partial[block] = energy;
}

typedef void interpolate_fn(const struct surface_samples *samples, const double *x, double *out);

/* The points of SPH sums: particles, then samples of surfaces. */
static const double *with_samples(const struct objective *o, const double *x,
                                  interpolate_fn *interpolate) {
    if (!o->samples) return x;
    interpolate(o->samples, x, o->samples->x);
    return o->samples->x;
}

pdyn_status objective_share_lists(struct objective *o) {
    const pdyn_neighbours *view = neighbours_view(o->neighbours);
    pdyn_status status = PDYN_OK;
    int near_count;
    const int *near = neighbours_near(o->neighbours, &near_count);
    if (o->samples) samples_update_active(o->samples, view, near, near_count);
    for (int b = 0; status == PDYN_OK && b < o->batches; b++)
        status = batch_neighbours(o->batch[b], view);
    o->lists_revision = view->revision;
    return status;
}

pdyn_status objective_build_lists(struct objective *o, const double *x) {
    double start = clock_ms();
    pdyn_status status = neighbours_build(o->neighbours, with_samples(o, x, samples_interpolate));
    if (status == PDYN_OK) status = objective_share_lists(o);
    o->ms_neighbours += clock_ms() - start;
    return status;
}

static bool lists_are_complete(const struct objective *o, const double *x) {
    return !o->neighbours || neighbours_are_valid(o->neighbours, x);
}

pdyn_status objective_ensure_lists(struct objective *o, const double *x, const double **all) {
    *all = with_samples(o, x, samples_interpolate_near);
    return lists_are_complete(o, *all) ? PDYN_OK : objective_build_lists(o, x);
}

pdyn_status objective_local(struct objective *o, const double *x, double *energy,
                            double *gradient) {
    const double *all;
    pdyn_status status = objective_ensure_lists(o, x, &all);
    if (o->neighbours) neighbours_freeze_visibility(o->neighbours);
    if (status == PDYN_OK && o->contact) status = contact_local(o->contact, x);
    if (status != PDYN_OK) return status;
    double start = clock_ms();
    o->x = x;
    *energy = objective_partial_sum(o, for_particles(o, inertia, x, gradient, 0.0));
    residual_open(o, gradient);
    for (int b = 0; status == PDYN_OK && b < o->batches; b++) {
        struct batch *batch = o->batch[b];
        residual_open_load(o, batch, gradient);
        status = batch_local(batch, batch->samples ? all : x, gradient);
        residual_add_load(o, batch, gradient);
        *energy += batch->energy;
    }
    count_work(o, 1); /* of the constraints that this step has, which the batches know by now */
    if (o->rigid) rigid_map_update(o->rigid, x);
    objective_pull(o, gradient);
    o->ms_local += clock_ms() - start;
    return status;
}

pdyn_status objective_limit(struct objective *o, const double *x, double *max_step) {
    const double *all;
    pdyn_status status = objective_ensure_lists(o, x, &all);
    int samples = o->samples ? o->samples->count : 0;
    for (int i = 0; i < o->particles + samples; i++) max_step[i] = INFINITY;
    for (int b = 0; status == PDYN_OK && b < o->batches; b++)
        batch_limit(o->batch[b], all, max_step);
    if (samples) samples_limit_motion(o->samples, max_step);
    return status;
}

pdyn_status objective_begin(struct objective *o, const struct step_start *start) {
    const struct batch_step step = objective_step(o);
    pdyn_status status = PDYN_OK;
    bool weights_change = false;
    for (int b = 0; status == PDYN_OK && b < o->batches; b++) {
        status = batch_begin(o->batch[b], start, &step);
        weights_change |= o->batch[b]->weights_change;
    }
    o->weights_revision += weights_change;
    return status;
}

pdyn_status objective_end(struct objective *o) {
    pdyn_status status = PDYN_OK;
    for (int b = 0; status == PDYN_OK && b < o->batches; b++)
        status = batch_prepare_end(o->batch[b]);
    for (int b = 0; status == PDYN_OK && b < o->batches; b++) batch_end(o->batch[b]);
    return status;
}

/* ---- the operator H -------------------------------------------------------------------------- */

pdyn_status objective_linearise(struct objective *o, double eps) {
    pdyn_status status = PDYN_OK;
    o->eps = eps;
    for (int b = 0; status == PDYN_OK && b < o->batches; b++)
        status = batch_linearise(o->batch[b], eps);
    if (o->rigid && status == PDYN_OK)
        status = rigid_matrix_couple(o->rigid_matrix, o->batch, o->batches);
    return status;
}

bool objective_has_tangents(const struct objective *o) {
    for (int k = 0; k < o->batches; k++) {
        const struct batch *b = o->batch[k];
        if (b->op || (!b->linear && type_has_tangent(b->type))) return true;
    }
    return false;
}

unsigned objective_revision(const struct objective *o) {
    unsigned sum = 0;
    for (int b = 0; b < o->batches; b++) sum += o->batch[b]->revision;
    return sum;
}

WIDE static void apply_inertia(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        double w = objective_inertia(c->objective, i);
        for (int k = 3 * i; k < 3 * i + 3; k++) c->out[k] = w * c->a[k];
    }
}

const double *objective_extended(const struct objective *o, const double *u) {
    return o->rigid ? rigid_map_extended(o->rigid, 0, o->particles, u) : u;
}

void objective_pull(const struct objective *o, double *y) {
    if (o->rigid) rigid_map_pull(o->rigid, y);
}

void objective_apply(struct objective *o, const double *u, double *y) {
    u = objective_extended(o, u);
    count_vectors(o, o->particles);
    count_work(o, 2); /* of one-sided constraints the rates, then the forces */
    for_particles(o, apply_inertia, u, y, 0.0);
    for (int b = 0; b < o->batches; b++) batch_apply(o->batch[b], u, y);
    objective_pull(o, y);
}

void objective_apply_remainder(struct objective *o, int first, int last, const double *u,
                               double *y) {
    if (o->rigid) u = rigid_map_extended(o->rigid, first, last, u);
    count_vectors(o, last - first);
    count_work(o, 0);
    struct call call = {.objective = o, .a = u, .out = y};
    pool_for_between(o->context->pool, first, last, PARTICLE_GRAIN, apply_inertia, &call);
    for (int b = 0; b < o->batches; b++) batch_apply_remainder(o->batch[b], first, last, u, y);
    objective_pull(o, y);
}

/* Every block becomes the particle's inertia times `scale`. */
static void start_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    memset(c->out + 6 * (size_t)first, 0, 6 * (size_t)(last - first) * sizeof *c->out);
    for (int i = first; i < last; i++)
        vec3_add_identity(c->out + 6 * (size_t)i, c->scale * objective_inertia(c->objective, i));
}

typedef void add_diagonal_fn(struct batch *batch, double *blocks);

/* The block diagonal of a part of H; add: adds that of a batch. */
static void sum_diagonal(struct objective *o, pdyn_part part, add_diagonal_fn *add,
                         double *blocks) {
    for_particles(o, start_blocks, NULL, blocks, part == PDYN_WHOLE ? 1.0 : 0.0);
    for (int b = 0; b < o->batches; b++)
        if (part == PDYN_WHOLE || !batch_is_static(o->batch[b])) add(o->batch[b], blocks);
    if (!o->rigid) return;
    if (part == PDYN_WHOLE) rigid_matrix_factor(o->rigid_matrix, blocks);
    rigid_map_close_blocks(o->rigid, 1.0 / (o->h * o->h), blocks);
}

void objective_diagonal(struct objective *o, pdyn_part part, double *blocks) {
    sum_diagonal(o, part, batch_diagonal, blocks);
}

void objective_diagonal_remainder(struct objective *o, pdyn_part part, double *blocks) {
    sum_diagonal(o, part, batch_diagonal_remainder, blocks);
}

/* ---- the model along a direction ------------------------------------------------------------- */

void objective_set_direction(struct objective *o, const double *u) {
    for (int b = 0; b < o->batches; b++) batch_set_direction(o->batch[b], u);
}

int objective_count_side_changes(struct objective *o) {
    int changes = 0;
    for (int b = 0; b < o->batches; b++) changes += batch_count_side_changes(o->batch[b]);
    return changes;
}

static double sides_slope(struct objective *o, double t, double *curvature) {
    double sum = *curvature = 0.0;
    for (int b = 0; b < o->batches; b++) {
        double more;
        sum += batch_slope(o->batch[b], t, &more);
        *curvature += more;
    }
    return sum;
}

/* The search along a line ends where this part of the slope is left, less than the linear solve
 * that gave the direction leaves of its residual (round_tolerance of step/global_step.c). */
static const double line_slope_left = 0.01;

/* It ends after so many steps in any case: halvings leave a millionth of an interval by then. */
enum { MAX_LINE_STEPS = 20 };

/* The slope is linear in pieces and rises along the line: Newton's iteration on it, safeguarded by
 * an interval [low, high] that contains the minimum. */
double objective_line_minimum(struct objective *o, double descent, double curvature) {
    double bend, start = sides_slope(o, 0.0, &bend);
    double low = 0.0, high = INFINITY, t = descent / curvature;
    curvature -= bend;
    for (int k = 0; k < MAX_LINE_STEPS; k++) {
        double slope = sides_slope(o, t, &bend) - start + t * curvature - descent;
        if (fabs(slope) <= line_slope_left * descent) break;
        if (slope < 0.0) low = t;
        else high = t;
        t -= slope / (curvature + bend);
        if (!(t > low && t < high)) t = isfinite(high) ? 0.5 * (low + high) : 2.0 * low;
    }
    return t;
}

static void scale_block(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] *= c->scale;
}

void objective_step_along(struct objective *o, double t, double *y) {
    for_particles(o, scale_block, NULL, y, t);
    for (int b = 0; b < o->batches; b++) batch_step_along(o->batch[b], t, y);
    objective_pull(o, y);
}

/* ---- vectors --------------------------------------------------------------------------------- */

WIDE static void dot_block(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    c->objective->partial[block] = simd_dot(c->a + 3 * first, c->b + 3 * first, 3 * (last - first));
}

double objective_dot_between(struct objective *o, int first, int last, const double *a,
                             const double *b) {
    struct call call = {.objective = o, .a = a, .b = b};
    return objective_partial_sum(
        o, pool_for_between(o->context->pool, first, last, PARTICLE_GRAIN, dot_block, &call));
}

double objective_dot(struct objective *o, const double *a, const double *b) {
    return objective_dot_between(o, 0, o->particles, a, b);
}

WIDE static void axpy_block(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] += c->scale * c->a[k];
}

void objective_axpy(struct objective *o, double scale, const double *x, double *y) {
    for_particles(o, axpy_block, x, y, scale);
}
