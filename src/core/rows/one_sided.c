/* One-sided constraints of an operator: sides, products with H, the model along a direction, and
 * impacts. */
#include "one_sided.h"

#include "projdyn/vec3.h"

#include <math.h>

enum { GRAIN = 2048 };

struct call {
    struct one_sided *s;
    const double *u;
    double *out;
    double eps, t, left_out;
};

static bool resize_arrays(struct one_sided *s, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(s->reached, s->capacity),
        ARRAY(s->rate, s->capacity),
        ARRAY(s->mean, s->capacity),
        ARRAY(s->multiplier, s->capacity),
        ARRAY(s->acts, s->capacity),
        ARRAY(s->possible, s->capacity),
        ARRAY(s->partial, 2 * (size_t)pool_blocks(s->capacity, GRAIN)),
    };
    return context_arrays(s->context, table, ARRAY_ROWS(table), action);
}

void one_sided_free(struct one_sided *s) {
    resize_arrays(s, ARRAYS_FREE);
    s->capacity = s->means = 0;
}

static pdyn_status reserve(struct one_sided *s, int count) {
    if (count <= s->capacity) return PDYN_OK;
    one_sided_free(s);
    s->capacity = count;
    if (resize_arrays(s, ARRAYS_ALLOCATE)) return PDYN_OK;
    one_sided_free(s);
    return PDYN_NO_MEMORY;
}

static void for_constraints(pdyn_range_fn *fn, struct call call) {
    pool_for(call.s->context->pool, call.s->at.count, GRAIN, fn, &call);
}

/* The sum of what each block counted. */
static int sum_counts(const struct one_sided *s) {
    double sum = 0.0;
    for (int b = 0; b < pool_blocks(s->at.count, GRAIN); b++) sum += s->partial[b];
    return (int)sum;
}

static void set_sides(void *arg, int first, int last, int block) {
    (void)block;
    struct one_sided *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) {
        s->reached[i] = s->at.value[i];
        s->possible[i] = s->at.stiffness[i] > 0.0;
        s->acts[i] = s->possible[i] && s->at.value[i] > 0.0;
    }
}

pdyn_status one_sided_begin(struct one_sided *s) {
    s->at = s->op->one_sided(s->self);
    s->D = s->at.weight_sum;
    pdyn_status status = reserve(s, s->at.count);
    if (status == PDYN_OK) for_constraints(set_sides, (struct call){.s = s});
    return status;
}

/* ---- H --------------------------------------------------------------------------------------- */

static void add_projective(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const double *D = c->s->D;
    for (int i = first; i < last; i++)
        if (D[i] > 0.0) vec3_add(c->out + 3 * i, c->eps * D[i], c->u + 3 * i);
}

void one_sided_apply_projective(struct one_sided *s, double eps, int first, int last,
                                const double *u, double *y) {
    struct call call = {.s = s, .u = u, .out = y, .eps = eps};
    if (eps > 0.0) pool_for_between(s->context->pool, first, last, GRAIN, add_projective, &call);
}

static void multiply_stiffness(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct one_sided *s = c->s;
    for (int i = first; i < last; i++) s->multiplier[i] *= (1.0 - c->eps) * s->at.stiffness[i];
}

void one_sided_apply(struct one_sided *s, double eps, const double *u, double *y) {
    if (!(eps < 1.0)) return;
    s->op->rate(s->self, s->acts, u, s->multiplier);
    for_constraints(multiply_stiffness, (struct call){.s = s, .eps = eps});
    s->op->force(s->self, s->multiplier, y);
}

static void acting_stiffness(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct one_sided *s = c->s;
    for (int i = first; i < last; i++)
        s->multiplier[i] = s->acts[i] ? (1.0 - c->eps) * s->at.stiffness[i] : 0.0;
}

static void add_projective_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) vec3_add_identity(c->out + 6 * i, c->eps * c->s->D[i]);
}

void one_sided_diagonal_projective(struct one_sided *s, double eps, double *blocks) {
    struct call call = {.s = s, .out = blocks, .eps = eps};
    if (eps > 0.0) pool_for(s->context->pool, s->particles, GRAIN, add_projective_blocks, &call);
}

void one_sided_diagonal(struct one_sided *s, double eps, double *blocks) {
    for_constraints(acting_stiffness, (struct call){.s = s, .eps = eps});
    s->op->diagonal(s->self, s->multiplier, blocks);
}

/* ---- along a direction ----------------------------------------------------------------------- */

void one_sided_set_direction(struct one_sided *s, const double *u) {
    s->op->rate(s->self, s->possible, u, s->rate);
}

static bool acts_at(const struct one_sided *s, int i, double t) {
    return s->possible[i] && s->reached[i] + t * s->rate[i] > 0.0;
}

static void count_changes(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    double changes = 0.0;
    for (int i = first; i < last; i++) changes += acts_at(c->s, i, 1.0) != c->s->acts[i];
    c->s->partial[block] = changes;
}

int one_sided_count_side_changes(struct one_sided *s) {
    for_constraints(count_changes, (struct call){.s = s});
    return sum_counts(s);
}

static void add_slopes(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct one_sided *s = c->s;
    double slope = 0.0, curvature = 0.0;
    for (int i = first; i < last; i++) {
        double there = s->reached[i] + c->t * s->rate[i];
        double k = there > 0.0 ? s->at.stiffness[i] * s->rate[i] : 0.0;
        slope += k * there, curvature += k * s->rate[i];
    }
    s->partial[2 * block] = slope, s->partial[2 * block + 1] = curvature;
}

double one_sided_slope(struct one_sided *s, double eps, double t, double *curvature) {
    double sum = *curvature = 0.0;
    if (eps == 1.0) return 0.0;
    for_constraints(add_slopes, (struct call){.s = s, .t = t});
    for (int b = 0; b < pool_blocks(s->at.count, GRAIN); b++)
        sum += s->partial[2 * b], *curvature += s->partial[2 * b + 1];
    *curvature *= 1.0 - eps;
    return (1.0 - eps) * sum;
}

static void change_sides(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct one_sided *s = c->s;
    for (int i = first; i < last; i++) {
        double to = s->reached[i] + c->t * s->rate[i];
        double beyond = fmax(0.0, to) - (s->acts[i] ? to : 0.0);
        s->multiplier[i] = (1.0 - c->eps) * s->at.stiffness[i] * beyond;
        s->acts[i] = acts_at(s, i, c->t);
        s->reached[i] = to;
    }
}

void one_sided_step_along(struct one_sided *s, double eps, double t, double *y) {
    if (eps == 1.0) return;
    for_constraints(change_sides, (struct call){.s = s, .eps = eps, .t = t});
    s->op->force(s->self, s->multiplier, y);
}

/* ---- impacts --------------------------------------------------------------------------------- */

static double force_of(const struct one_sided *s, int i) {
    return s->acts[i] ? s->at.stiffness[i] * s->at.value[i] : 0.0;
}

static void compute_forces(void *arg, int first, int last, int block) {
    (void)block;
    struct one_sided *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) s->multiplier[i] = force_of(s, i);
}

static void store_forces(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct one_sided *s = c->s;
    for (int i = first; i < last; i++) {
        double impact = c->left_out > 0.0 ? s->multiplier[i] : 0.0;
        s->multiplier[i] = force_of(s, i);
        s->mean[i] = s->multiplier[i] - c->left_out * impact;
    }
}

void one_sided_store_forces(struct one_sided *s, double left_out, bool solved) {
    for_constraints(store_forces, (struct call){.s = s, .left_out = left_out});
    s->means = solved ? s->at.count : 0;
}

double one_sided_energy(const struct one_sided *s, int i) {
    if (s->op->stored) return s->op->stored(s->self, i);
    return 0.5 * s->multiplier[i] * fmax(0.0, s->at.value[i]);
}

void one_sided_persist(struct one_sided *s, struct snapshot_file *snapshot) {
    int means = s->means;
    snapshot_file_count(snapshot, &means, sizeof *s->mean,
                        "the number of forces of a constraint is out of range");
    if (snapshot->status == PDYN_OK) snapshot->status = reserve(s, means);
    if (snapshot->status != PDYN_OK) return;
    s->means = means;
    snapshot_file_numbers(snapshot, s->mean, (size_t)s->means,
                          "a force of a constraint is not finite");
}

void one_sided_forces(struct one_sided *s, double *y) {
    for_constraints(compute_forces, (struct call){.s = s});
    s->op->force(s->self, s->multiplier, y);
}

struct impacts { /* the arguments of a parallel loop */
    struct one_sided *s;
    const struct rate_change *change;
    bool comparable; /* with the forces of the step before: both steps are solved */
};

/* The pressure of an impact is many times that before. Pressures that vary less are none: they
 * would settle more slowly. */
static const double usual_rise = 4.0;

/* The part of the force, 0 to 1, beyond a usual rise in a step. */
static double risen_part(const struct impacts *c, int i, double force) {
    return c->comparable ? fmax(0.0, 1.0 - usual_rise * c->s->mean[i] / force) : 0.0;
}

/* The decrease of dC/dt in the step, at most so much that the impulse which is taken off ends the
 * separation after the step. More would make the particles approach, and give energy to water that
 * a sheet slows down in many steps. */
static double stopped_of(const struct rate_change *change, int i) {
    double separation = fmax(0.0, -change->after[i]), taken = change->taken;
    return change->slowed[i] * taken > separation ? separation / taken : change->slowed[i];
}

/* Two estimates of the rate change that the force causes in a step: `acceleration`, by all forces
 * of the batch, which may cancel each other; and by this constraint alone, with the mass of a
 * particle for everything that it moves, also for light surfaces. The larger one is used. Particles
 * behind those that touch have no approach speed, but the force on them rises. For them only the
 * second estimate is used, because it does not depend on how the liquid is divided into bodies. */
static double impact_of(const struct impacts *c, int i) {
    const struct one_sided *s = c->s;
    double value = s->at.value[i], force = force_of(s, i), h = c->change->h;
    if (force == 0.0) return 0.0;
    double alone = h * force * s->at.squares[i] / c->change->mass;
    double change = fmax(h * c->change->acceleration[i], alone);
    double rise = risen_part(c, i, force) * alone;
    return fmax(impact_part(stopped_of(c->change, i), change, h * change / value),
                impact_part(rise, alone, h * alone / value));
}

static void compute_impacts(void *arg, int first, int last, int block) {
    const struct impacts *c = arg;
    struct one_sided *s = c->s;
    double count = 0.0;
    for (int i = first; i < last; i++) {
        double part = impact_of(c, i);
        s->multiplier[i] = part * s->at.stiffness[i] * s->at.value[i];
        count += part > 0.5;
    }
    s->partial[block] = count;
}

int one_sided_impacts(struct one_sided *s, const struct rate_change *change, double *y) {
    struct impacts impacts = {s, change, change->solved && s->means == s->at.count};
    pool_for(s->context->pool, s->at.count, GRAIN, compute_impacts, &impacts);
    s->op->force(s->self, s->multiplier, y);
    return sum_counts(s);
}
