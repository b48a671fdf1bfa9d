#include "objective.h"

#include "base/clock.h"
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
static int for_particles(struct objective *sys, pdyn_range_fn *fn, const double *a, const double *b,
                         double *out, double scale) {
    struct call call = {sys, a, b, out, scale};
    return pool_for_between(sys->context->pool, 0, sys->particles, PARTICLE_GRAIN, fn, &call);
}

double objective_partial_sum(const struct objective *sys, int blocks) {
    double sum = 0.0;
    for (int k = 0; k < blocks; k++) sum += sys->partial[k];
    return sum;
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

/* The points of SPH sums: particles, then samples of surfaces. */
static const double *extend(const struct objective *sys, const double *x) {
    if (!sys->samples) return x;
    samples_interpolate(sys->samples, x, sys->samples->x);
    return sys->samples->x;
}

pdyn_status objective_share_lists(struct objective *sys) {
    const pdyn_neighbours *view = neighbours_view(sys->neighbours);
    pdyn_status status = PDYN_OK;
    if (sys->samples) samples_update_active(sys->samples, view);
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++)
        status = batch_neighbours(sys->batch[b], view);
    sys->lists = view->revision;
    return status;
}

/* Builds lists at x, which is extended by samples, and gives them to every batch. */
static pdyn_status build_lists(struct objective *sys, const double *x) {
    double start = clock_ms();
    pdyn_status status = neighbours_build(sys->neighbours, x);
    if (status == PDYN_OK) status = objective_share_lists(sys);
    sys->ms_neighbours += clock_ms() - start;
    return status;
}

pdyn_status objective_build_lists(struct objective *sys, const double *x) {
    return build_lists(sys, extend(sys, x));
}

static bool lists_are_complete(const struct objective *sys, const double *x) {
    return !sys->neighbours || neighbours_are_valid(sys->neighbours, x);
}

pdyn_status objective_ensure_lists(struct objective *sys, const double *x, const double **all) {
    *all = extend(sys, x);
    return lists_are_complete(sys, *all) ? PDYN_OK : build_lists(sys, *all);
}

pdyn_status objective_local(struct objective *sys, const double *x, double *energy,
                            double *gradient) {
    const double *all;
    pdyn_status status = objective_ensure_lists(sys, x, &all);
    if (sys->neighbours) neighbours_freeze_visibility(sys->neighbours);
    if (status == PDYN_OK && sys->contact) status = contact_local(sys->contact, x);
    if (status != PDYN_OK) return status;
    double start = clock_ms();
    sys->x = x;
    *energy = objective_partial_sum(sys, for_particles(sys, inertia, x, NULL, gradient, 0.0));
    residual_forget_loads(sys);
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++) {
        struct batch *batch = sys->batch[b];
        residual_open_load(sys, batch, gradient);
        status = batch_local(batch, batch->samples ? all : x, sys->time, gradient);
        residual_add_load(sys, batch, gradient);
        *energy += batch->energy;
    }
    if (sys->rigid) rigid_map_update(sys->rigid, x);
    objective_pull(sys, gradient);
    sys->ms_local += clock_ms() - start;
    return status;
}

pdyn_status objective_limit(struct objective *sys, const double *x, double *way) {
    const double *all;
    pdyn_status status = objective_ensure_lists(sys, x, &all);
    int samples = sys->samples ? sys->samples->count : 0;
    for (int i = 0; i < sys->particles + samples; i++) way[i] = INFINITY;
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++)
        batch_limit(sys->batch[b], all, way);
    if (samples) samples_limit_motion(sys->samples, way);
    return status;
}

pdyn_status objective_open(struct objective *sys, const double *x, const double *v) {
    pdyn_status status = PDYN_OK;
    const struct batch_step step = {sys->length, sys->extrapolation, sys->h, sys->time};
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++)
        status = batch_open(sys->batch[b], x, v, &step);
    return status;
}

void objective_set_damper_rest(struct objective *sys, const double *x, const double *before) {
    for (int b = 0; b < sys->batches; b++) batch_set_damper_rest(sys->batch[b], x, before);
}

void objective_begin(struct objective *sys, const double *x, const double *v) {
    bool moved = false;
    for (int b = 0; b < sys->batches; b++) moved |= batch_begin(sys->batch[b], x, v, sys->h);
    sys->weights += moved;
}

pdyn_status objective_end(struct objective *sys) {
    pdyn_status status = PDYN_OK;
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++) status = batch_end(sys->batch[b]);
    return status;
}

/* ---- the operator H -------------------------------------------------------------------------- */

pdyn_status objective_linearise(struct objective *sys, double eps) {
    pdyn_status status = PDYN_OK;
    sys->eps = eps;
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++)
        status = batch_linearise(sys->batch[b], eps);
    if (sys->rigid && status == PDYN_OK)
        status = rigid_matrix_couple(sys->rigid, sys->batch, sys->batches);
    return status;
}

unsigned objective_revision(const struct objective *sys) {
    unsigned sum = 0;
    for (int b = 0; b < sys->batches; b++) sum += sys->batch[b]->revision;
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

const double *objective_extended(const struct objective *sys, const double *u) {
    return sys->rigid ? rigid_map_extended(sys->rigid, u) : u;
}

void objective_pull(const struct objective *sys, double *y) {
    if (sys->rigid) rigid_map_pull(sys->rigid, y);
}

void objective_apply(struct objective *sys, const double *u, double *y) {
    u = objective_extended(sys, u);
    for_particles(sys, apply_inertia, u, NULL, y, 0.0);
    for (int b = 0; b < sys->batches; b++) batch_apply(sys->batch[b], u, y);
    objective_pull(sys, y);
}

void objective_apply_rest(struct objective *sys, int first, int last, const double *u, double *y) {
    u = objective_extended(sys, u);
    struct call call = {.objective = sys, .a = u, .out = y};
    pool_for_between(sys->context->pool, first, last, PARTICLE_GRAIN, apply_inertia, &call);
    for (int b = 0; b < sys->batches; b++) batch_apply_rest(sys->batch[b], u, y);
    objective_pull(sys, y);
}

/* ---- the model along a direction ------------------------------------------------------------- */

void objective_set_direction(struct objective *sys, const double *u) {
    for (int b = 0; b < sys->batches; b++) batch_set_direction(sys->batch[b], u);
}

int objective_count_side_changes(struct objective *sys) {
    int turns = 0;
    for (int b = 0; b < sys->batches; b++) turns += batch_count_side_changes(sys->batch[b]);
    return turns;
}

static double sides_slope(struct objective *sys, double t, double *curvature) {
    double sum = *curvature = 0.0;
    for (int b = 0; b < sys->batches; b++) {
        double more;
        sum += batch_slope(sys->batch[b], t, &more);
        *curvature += more;
    }
    return sum;
}

/* The slope is linear in pieces and rises along the line: Newton's iteration on it, safeguarded by
 * an interval [low, high] that contains the minimum. */
double objective_line_minimum(struct objective *sys, double descent, double curvature) {
    double bend, start = sides_slope(sys, 0.0, &bend);
    double low = 0.0, high = INFINITY, t = descent / curvature;
    curvature -= bend;
    for (int k = 0; k < 20; k++) {
        double slope = sides_slope(sys, t, &bend) - start + t * curvature - descent;
        if (fabs(slope) <= 0.01 * descent) break;
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

int objective_step_along(struct objective *sys, double t, double *y) {
    int changed = 0;
    for_particles(sys, scale_block, NULL, NULL, y, t);
    for (int b = 0; b < sys->batches; b++) changed += batch_step_along(sys->batch[b], t, y);
    objective_pull(sys, y);
    return changed;
}

/* Every block becomes the particle's inertia times `scale`. */
static void start_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    memset(c->out + 6 * (size_t)first, 0, 6 * (size_t)(last - first) * sizeof *c->out);
    for (int i = first; i < last; i++)
        for (int a = 0; a < 6; a += a ? 2 : 3)
            c->out[6 * (size_t)i + a] = c->scale * objective_inertia(c->objective, i);
}

typedef void add_diagonal_fn(struct batch *batch, double *blocks);

/* The block diagonal of a part of H; add: adds that of a batch. */
static void sum_diagonal(struct objective *sys, pdyn_part part, add_diagonal_fn *add,
                         double *blocks) {
    for_particles(sys, start_blocks, NULL, NULL, blocks, part == PDYN_WHOLE ? 1.0 : 0.0);
    for (int b = 0; b < sys->batches; b++)
        if (part == PDYN_WHOLE || !batch_is_static(sys->batch[b])) add(sys->batch[b], blocks);
    if (!sys->rigid) return;
    if (part == PDYN_WHOLE) rigid_matrix_factor(sys->rigid, blocks);
    rigid_map_close_blocks(sys->rigid, 1.0 / (sys->h * sys->h), blocks);
}

void objective_diagonal(struct objective *sys, pdyn_part part, double *blocks) {
    sum_diagonal(sys, part, batch_diagonal, blocks);
}

void objective_rest_diagonal(struct objective *sys, pdyn_part part, double *blocks) {
    sum_diagonal(sys, part, batch_rest_diagonal, blocks);
}

/* ---- vectors --------------------------------------------------------------------------------- */

WIDE static void dot_block(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    c->objective->partial[block] = simd_dot(c->a + 3 * first, c->b + 3 * first, 3 * (last - first));
}

double objective_dot_between(struct objective *sys, int first, int last, const double *a,
                             const double *b) {
    struct call call = {.objective = sys, .a = a, .b = b};
    return objective_partial_sum(
        sys, pool_for_between(sys->context->pool, first, last, PARTICLE_GRAIN, dot_block, &call));
}

double objective_dot(struct objective *sys, const double *a, const double *b) {
    return objective_dot_between(sys, 0, sys->particles, a, b);
}

WIDE static void axpy_block(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] += c->scale * c->a[k];
}

void objective_axpy(struct objective *sys, double scale, const double *x, double *y) {
    for_particles(sys, axpy_block, x, NULL, y, scale);
}
