/* Multipliers of the solver "dual": loops over all constraints, memory and saved state. */
#include "multipliers.h"

#include "memory.h"

#include <math.h>

/* Constraints below minus this (a relative density, for a fluid) stay out of a solve; the next
 * local step evaluates them again. */
static const double max_room = 0.1;

/* GRAIN: constraints of a parallel block. SUMS: partial sums of a block. MAX_PER_PARTICLE: a saved
 * state has at most so many multipliers for each particle. */
enum { GRAIN = 2048, SUMS = 4, MAX_PER_PARTICLE = 16 };

/* ---- memory ---------------------------------------------------------------------------------- */

static void *resize(const struct multipliers *m, void *array, size_t bytes, bool allocate) {
    return m->services->allocate(m->services->core, array, allocate ? 0 : bytes,
                                 allocate ? bytes : 0);
}

/* Allocates or frees the arrays. */
static bool resize_arrays(struct multipliers *m, bool allocate) {
    size_t count = (size_t)m->count, sums = SUMS * (size_t)block_count(m->count, GRAIN);
    double **const numbers[] = {&m->lambda, &m->value, &m->stiffness, &m->squares,
                                &m->g,      &m->p,     &m->q,         &m->inverse};
    m->in_solve = resize(m, m->in_solve, count * sizeof *m->in_solve, allocate);
    m->sums = resize(m, m->sums, sums * sizeof *m->sums, allocate);
    bool good = m->in_solve && m->sums;
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        *numbers[k] = resize(m, *numbers[k], count * sizeof **numbers[k], allocate);
        good &= *numbers[k] != NULL;
    }
    return good;
}

pdyn_status multipliers_reserve(struct multipliers *m, int count) {
    if (count == m->count) return PDYN_OK;
    resize_arrays(m, false);
    m->count = count;
    if (!count || resize_arrays(m, true)) return PDYN_OK;
    resize_arrays(m, false);
    m->count = 0;
    return PDYN_NO_MEMORY;
}

/* ---- loops ----------------------------------------------------------------------------------- */

struct call {
    struct multipliers *m;
    double scale;
    int first; /* of a matrix-free constraint: */
    const pdyn_one_sided *at;
    const pdyn_body *body;
    const double *mobility;
};

static void for_all(struct multipliers *m, pdyn_range_fn *fn, double scale) {
    struct call call = {.m = m, .scale = scale};
    m->services->parallel_for(m->services->core, m->count, GRAIN, fn, &call);
}

static double sum_of(const struct multipliers *m, int which) {
    double sum = 0.0;
    for (int b = 0; b < block_count(m->count, GRAIN); b++) sum += m->sums[SUMS * b + which];
    return sum;
}

/* fmax without its rules for NaN, which make it a function call. */
static double larger(double a, double b) { return a > b ? a : b; }

static double change_of(const struct multipliers *m, int i) {
    return m->lambda[i] - m->stiffness[i] * larger(0.0, m->value[i]);
}

static void start(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct multipliers *m = c->m;
    for (int k = first; k < last; k++) {
        int i = c->first + k, particle = c->body->first + (k < c->body->count ? k : 0);
        double w = c->scale * c->at->stiffness[k];
        m->value[i] = c->at->value[k], m->squares[i] = c->at->squares[k];
        m->stiffness[i] = w, m->in_solve[i] = w > 0.0;
        if (!m->in_solve[i]) m->lambda[i] = 0.0;
        m->inverse[i] =
            m->in_solve[i] ? 1.0 / (1.0 / w + c->mobility[particle] * m->squares[i]) : 0.0;
        m->p[i] = change_of(m, i);
    }
}

void multipliers_start(struct multipliers *m, int first, const pdyn_one_sided *at,
                       const pdyn_body *body, double eps, const double *mobility) {
    struct call call = {m, 1.0 - eps, first, at, body, mobility};
    m->services->parallel_for(m->services->core, at->count, GRAIN, start, &call);
}

static void compute_residual(void *arg, int first, int last, int block) {
    (void)block;
    struct multipliers *m = ((const struct call *)arg)->m;
    for (int i = first; i < last; i++) {
        m->g[i] = m->value[i] + m->q[i];
        if (m->in_solve[i]) m->g[i] -= m->lambda[i] / m->stiffness[i];
        m->in_solve[i] = m->in_solve[i] && (m->lambda[i] > 0.0 || m->g[i] > -max_room);
        m->p[i] = m->q[i] = 0.0;
    }
}

void multipliers_compute_residual(struct multipliers *m) { for_all(m, compute_residual, 0.0); }

static void advance(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct multipliers *m = c->m;
    double beyond = 0.0, all = 0.0, gradient = 0.0, gz = 0.0;
    for (int i = first; i < last; i++) {
        if (!m->in_solve[i]) continue;
        double step = c->scale * m->p[i], inverse = m->inverse[i];
        double l = m->lambda[i] += step, g = m->g[i] -= c->scale * m->q[i];
        if (l < 0.0) beyond += l * l / inverse;
        all += step * step / inverse;
        if (l == 0.0 && g <= 0.0) continue;
        double missing = larger(m->stiffness[i] * g, -l);
        gradient += missing * missing * m->squares[i];
        gz += g * g * inverse;
    }
    double *sums = m->sums + SUMS * block;
    sums[0] = beyond, sums[1] = all, sums[2] = gradient, sums[3] = gz;
}

struct multipliers_step multipliers_advance(struct multipliers *m, double scale) {
    for_all(m, advance, scale);
    return (struct multipliers_step){sum_of(m, 0), sum_of(m, 1), sum_of(m, 2), sum_of(m, 3)};
}

static void update_direction(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct multipliers *m = c->m;
    for (int i = first; i < last; i++) {
        bool allowed = m->in_solve[i] && (m->lambda[i] != 0.0 || m->g[i] > 0.0);
        m->p[i] = allowed ? m->g[i] * m->inverse[i] + c->scale * m->p[i] : 0.0;
    }
}

void multipliers_update_direction(struct multipliers *m, double scale) {
    for_all(m, update_direction, scale);
}

static void add_compliance(void *arg, int first, int last, int block) {
    struct multipliers *m = ((const struct call *)arg)->m;
    double gp = 0.0, pq = 0.0;
    for (int i = first; i < last; i++) {
        m->q[i] = m->in_solve[i] ? m->p[i] / m->stiffness[i] - m->q[i] : 0.0;
        gp += m->g[i] * m->p[i], pq += m->p[i] * m->q[i];
    }
    m->sums[SUMS * block] = gp, m->sums[SUMS * block + 1] = pq;
}

double multipliers_add_compliance(struct multipliers *m, double *gp) {
    for_all(m, add_compliance, 0.0);
    *gp = sum_of(m, 0);
    return sum_of(m, 1);
}

static void find_clipping(void *arg, int first, int last, int block) {
    (void)block;
    struct multipliers *m = ((const struct call *)arg)->m;
    for (int i = first; i < last; i++) m->p[i] = larger(0.0, -m->lambda[i]);
}

void multipliers_find_clipping(struct multipliers *m) { for_all(m, find_clipping, 0.0); }

static void find_change(void *arg, int first, int last, int block) {
    (void)block;
    struct multipliers *m = ((const struct call *)arg)->m;
    for (int i = first; i < last; i++) {
        m->lambda[i] = larger(0.0, m->lambda[i]);
        m->p[i] = change_of(m, i);
    }
}

void multipliers_find_change(struct multipliers *m) { for_all(m, find_change, 0.0); }

/* ---- saved states ---------------------------------------------------------------------------- */

static pdyn_status fail_invalid(const struct multipliers *m, const char *message) {
    return m->services->set_error(m->services->core, PDYN_BAD_INPUT, message);
}

pdyn_status multipliers_persist(struct multipliers *m, int particles, pdyn_snapshot *snapshot) {
    int count = m->count;
    bool valid = true;
    snapshot->bytes(snapshot, &count, sizeof count);
    if (snapshot->reading && (count < 0 || count / MAX_PER_PARTICLE > particles))
        return fail_invalid(m, "not a saved state of this scene: the number of multipliers is out "
                               "of range");
    if (snapshot->reading && multipliers_reserve(m, count) != PDYN_OK) return PDYN_NO_MEMORY;
    if (count) snapshot->bytes(snapshot, m->lambda, (size_t)count * sizeof *m->lambda);
    if (!snapshot->reading) return PDYN_OK;
    for (int i = 0; i < count; i++) valid &= m->lambda[i] >= 0.0 && isfinite(m->lambda[i]);
    return valid ? PDYN_OK
                 : fail_invalid(m, "not a saved state of this scene: a multiplier is negative or "
                                   "not finite");
}
