/* Solver "dual": conjugate gradients on the multipliers (pressures) of all matrix-free constraints.
 * With G the gradients of its constraints, K their stiffness and A the rest of H, the model of E is
 * minimal where
 *
 *     d = A^-1 (b - G' (lambda - K max(0, C))),     b: with the forces of the last local step
 *
 *     C + G d - K^-1 lambda = 0, or less where lambda = 0,     lambda >= 0
 *
 * which is S lambda = rhs with S = K^-1 + G A^-1 G' and bounds: the pressure equation of
 * incompressible SPH (Ihmsen et al. 2014, Bender and Koschier 2015), made compliant by K. Of a
 * fluid alone, A = M/h^2 + eps D is diagonal (D: pdyn_one_sided.held). Beside rows (cloth,
 * contact), A^-1 is an iteration of its own (rest_solve.h), to 0.3 of its residual within the
 * iteration and to 0.1 at its ends.
 *
 * Multipliers are kept from step to step, so that a fluid at rest starts at its solution. They
 * satisfy the equation of motion exactly, however early the iteration ends; what remains is an
 * error of the constraints. In the unknowns x (cg.c) it is the other way round: the error of a
 * stiff constraint is a large force.
 *
 * Bounds: multipliers may become negative during the iteration, up to a share of the step. Beyond
 * it they are clipped, and conjugate directions start again. */
#include "memory.h"
#include "projdyn/module.h"
#include "rest_solve.h"

#include <math.h>
#include <string.h>

/* Share of a step, in the norm of S's diagonal, that may lie beyond the bounds. */
static const double max_beyond = 0.05;

/* Constraints below minus this (a relative density, for a fluid) stay out of a solve; the next
 * local step evaluates them again. */
static const double max_room = 0.1;

/* GRAIN: constraints or particles of a parallel block. SUMS: partial sums of a block.
 * MAX_PER_PARTICLE: a saved state has at most so many multipliers for each particle. */
enum { GRAIN = 2048, SUMS = 4, MAX_PER_PARTICLE = 16 };

/* Beside rows: reduction of the residual of A at the ends of a solve and within it; beside cloth
 * and solids, too, reduction of the gradient's estimate in a solve, at least, and the largest
 * number of iterations of a solve.
 * The model changes from one outer iteration to the next, and more of these is worth more. */
static const double end_tolerance = 0.1, inner_tolerance = 0.3, max_reduction = 0.1;
enum { MAX_COUPLED = 10 };

struct part { /* the scalar constraints of one matrix-free constraint */
    pdyn_one_sided at;
    const pdyn_body *body;
    int first; /* in the arrays over all of them */
};

struct dual {
    pdyn_model *model;
    bool limited; /* solves end early, because A^-1 takes many iterations: cloth or solids */
    struct rest_solve rest; /* A^-1 */
    double *u, *rhs; /* particles x 3: displacement by p; right side of a solve with A. NULL: not
                        coupled */
    int products;    /* with A in this solve */
    int parts;       /* matrix-free constraints of the model; theirs follow each other below */
    struct part *part;
    int count;
    double *multiplier; /* count: lambda, kept from step to step */
    double *value;      /* count: C at the last local step */
    double *stiffness;  /* count: K of the damped model, N/m */
    double *squares;    /* count: |grad C|^2 */
    double *g;          /* count: C + G d - lambda / k: the residual */
    double *p, *q;      /* count: direction; S times it */
    double *inverse;    /* count: of S's diagonal */
    bool *in;           /* count: takes part in the solve */
    double *d;          /* particles x 3: the displacement by the multipliers */
    double *sums;       /* SUMS partial sums for each parallel block */
    double target;      /* of the gradient's estimate, N */
};

struct call {
    struct dual *s;
    const struct part *part;
    double scale;
    const double *in;
    double *out;
};

/* Allocates or frees the arrays of `count` constraints. */
static bool resize_constraints(struct dual *s, bool allocate) {
    const pdyn_services *services = s->model->services;
    size_t count = (size_t)s->count, sums = SUMS * (size_t)block_count(s->count, GRAIN);
    struct {
        void **array;
        size_t bytes;
    } all[] = {
        {(void **)&s->multiplier, count * sizeof *s->multiplier},
        {(void **)&s->value, count * sizeof *s->value},
        {(void **)&s->stiffness, count * sizeof *s->stiffness},
        {(void **)&s->squares, count * sizeof *s->squares},
        {(void **)&s->g, count * sizeof *s->g},
        {(void **)&s->p, count * sizeof *s->p},
        {(void **)&s->q, count * sizeof *s->q},
        {(void **)&s->inverse, count * sizeof *s->inverse},
        {(void **)&s->in, count * sizeof *s->in},
        {(void **)&s->sums, sums * sizeof *s->sums},
    };
    bool good = true;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        *all[k].array =
            services->allocate(services->core, *all[k].array, allocate ? 0 : all[k].bytes,
                               allocate ? all[k].bytes : 0);
        good &= *all[k].array != NULL;
    }
    return good;
}

/* The number of constraints is known after the first local step. After a failure there are none. */
static pdyn_status reserve(struct dual *s, int count) {
    if (count == s->count) return PDYN_OK;
    resize_constraints(s, false);
    s->count = count;
    if (!count || resize_constraints(s, true)) return PDYN_OK;
    resize_constraints(s, false);
    s->count = 0;
    return PDYN_NO_MEMORY;
}

static void release(void *self) {
    struct dual *s = self;
    if (!s->model) return;
    reserve(s, 0);
    FREE(s->model->services, s->part, s->parts);
    FREE(s->model->services, s->u, vector_size(s->model));
    FREE(s->model->services, s->rhs, vector_size(s->model));
    rest_solve_free(&s->rest);
}

static int suits(const pdyn_model *model, const char **reason) {
    bool alone = !model->elements_count && !model->dynamic_count && !model->solve_bodies;
    *reason = "fluids act alone: their pressures are the unknowns";
    if (!model->one_sided_count) return 0;
    if (model->newton && alone) return 40;
    bool with_bodies = model->newton && model->solve_bodies && !model->elements_count;
    if (with_bodies) *reason = "pressures are the unknowns beside rigid bodies";
    return with_bodies ? 25 : 1;
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct dual *s = self;
    s->model = model, s->parts = model->one_sided_count;
    s->part = NEW(model->services, s->parts, struct part);
    if (!s->part) return PDYN_NO_MEMORY;
    pdyn_status status = rest_solve_create(&s->rest, model);
    if (status != PDYN_OK || !s->rest.coupled) return status;
    s->limited = model->elements_count || !model->solve_bodies;
    s->u = NEW(model->services, vector_size(model), double);
    s->rhs = NEW(model->services, vector_size(model), double);
    return s->u && s->rhs ? PDYN_OK : PDYN_NO_MEMORY;
}

/* ---- loops over constraints and particles ---------------------------------------------------- */

static void for_all(struct dual *s, int count, pdyn_range_fn *fn, double scale, const double *in,
                    double *out) {
    struct call call = {s, NULL, scale, in, out};
    s->model->services->parallel_for(s->model->services->core, count, GRAIN, fn, &call);
}

static double sum_of(const struct dual *s, int which) {
    double sum = 0.0;
    for (int b = 0; b < block_count(s->count, GRAIN); b++) sum += s->sums[SUMS * b + which];
    return sum;
}

/* fmax without its rules for NaN, which make it a function call. */
static double larger(double a, double b) { return a > b ? a : b; }

/* y += G' multiplier */
static void add_force(struct dual *s, const double *multiplier, double *y) {
    for (int k = 0; k < s->parts; k++)
        s->model->force(s->model, k, multiplier + s->part[k].first, y);
}

/* q = G u for the constraints in the solve */
static void compute_rate(struct dual *s, const double *u) {
    for (int k = 0; k < s->parts; k++) {
        int first = s->part[k].first;
        s->model->rate(s->model, k, s->in + first, u, s->q + first);
    }
}

/* out = (b or 0) - out */
static void subtract_from(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] = (c->in ? c->in[k] : 0.0) - c->out[k];
}

/* out += scale in */
static void add_scaled(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] += c->scale * c->in[k];
}

/* out = b - G' multiplier, b: NULL for 0 */
static void compute_force(struct dual *s, const double *b, const double *multiplier, double *out) {
    memset(out, 0, 3 * (size_t)s->model->particles * sizeof *out);
    add_force(s, multiplier, out);
    for_all(s, s->model->particles, subtract_from, 0.0, b, out);
}

/* d = A^-1 (b - G' multiplier), to rel_tol */
static void compute_displacement(struct dual *s, const double *b, const double *multiplier,
                                 double rel_tol, double *d) {
    double *force = s->rest.coupled ? s->rhs : d;
    compute_force(s, b, multiplier, force);
    s->products += rest_solve_apply(&s->rest, force, d, rel_tol);
}

/* d = 0 for particles in no row */
static void clear_free(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const bool *in_rows = c->s->rest.model->in_rows;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] = in_rows[k / 3] ? c->out[k] : 0.0;
}

/* d += A^-1 (b - G' multiplier - A d), from 0 for particles in no row: their solve is exact */
static void correct_displacement(struct dual *s, const double *b, const double *multiplier) {
    pdyn_model *rest = s->rest.model;
    compute_force(s, b, multiplier, s->rhs);
    for_all(s, s->model->particles, clear_free, 0.0, NULL, s->d);
    rest->product(rest, s->d, s->u);
    rest->for_particles(rest, GRAIN, add_scaled, &(struct call){s, NULL, -1.0, s->u, s->rhs});
    s->products += rest_solve_apply(&s->rest, s->rhs, s->u, end_tolerance);
    for_all(s, s->model->particles, add_scaled, 1.0, s->u, s->d);
}

/* lambda - K max(0, C): the change of the force of constraint i relative to the last local step. */
static double multiplier_change(const struct dual *s, int i) {
    return s->multiplier[i] - s->stiffness[i] * larger(0.0, s->value[i]);
}

static void start_constraints(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct dual *s = c->s;
    const struct part *part = c->part;
    const pdyn_body *body = part->body;
    for (int k = first; k < last; k++) {
        int i = part->first + k, particle = body->first + (k < body->count ? k : 0);
        double w = (1.0 - s->model->eps) * part->at.stiffness[k];
        s->value[i] = part->at.value[k], s->squares[i] = part->at.squares[k];
        s->stiffness[i] = w, s->in[i] = w > 0.0;
        if (!s->in[i]) s->multiplier[i] = 0.0;
        s->inverse[i] =
            s->in[i] ? 1.0 / (1.0 / w + s->rest.mobility[particle] * s->squares[i]) : 0.0;
        s->p[i] = multiplier_change(s, i);
    }
}

/* g at the start, where q = G d. Constraints far below 0 are left out of the solve. */
static void compute_residual(void *arg, int first, int last, int block) {
    (void)block;
    struct dual *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) {
        s->g[i] = s->value[i] + s->q[i];
        if (s->in[i]) s->g[i] -= s->multiplier[i] / s->stiffness[i];
        s->in[i] = s->in[i] && (s->multiplier[i] > 0.0 || s->g[i] > -max_room);
        s->p[i] = 0.0;
    }
}

/* lambda += scale p, g -= scale q. Partial sums, squared: the part of the step beyond the bounds,
 * the step, the estimate of the model's gradient; and g . z. */
static void step_along_direction(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct dual *s = c->s;
    double beyond = 0.0, all = 0.0, gradient = 0.0, gz = 0.0;
    for (int i = first; i < last; i++) {
        if (!s->in[i]) continue;
        double step = c->scale * s->p[i], D = s->inverse[i];
        double l = s->multiplier[i] += step, g = s->g[i] -= c->scale * s->q[i];
        if (l < 0.0) beyond += l * l / D;
        all += step * step / D;
        if (l == 0.0 && g <= 0.0) continue;
        double missing = larger(s->stiffness[i] * g, -l);
        gradient += missing * missing * s->squares[i];
        gz += g * g * D;
    }
    double *sums = s->sums + SUMS * block;
    sums[0] = beyond, sums[1] = all, sums[2] = gradient, sums[3] = gz;
}

/* p = z + scale p; 0 where lambda = 0 and C < 0 stays so */
static void update_direction(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct dual *s = c->s;
    for (int i = first; i < last; i++) {
        bool allowed = s->in[i] && (s->multiplier[i] != 0.0 || s->g[i] > 0.0);
        s->p[i] = allowed ? s->g[i] * s->inverse[i] + c->scale * s->p[i] : 0.0;
    }
}

/* q, which is -G A^-1 G' p, becomes S p. Partial sums: g . p, p . q */
static void add_compliance(void *arg, int first, int last, int block) {
    struct dual *s = ((const struct call *)arg)->s;
    double gp = 0.0, pq = 0.0;
    for (int i = first; i < last; i++) {
        s->q[i] = s->in[i] ? s->p[i] / s->stiffness[i] - s->q[i] : 0.0;
        gp += s->g[i] * s->p[i], pq += s->p[i] * s->q[i];
    }
    s->sums[SUMS * block] = gp, s->sums[SUMS * block + 1] = pq;
}

/* q = S p */
static void multiply(struct dual *s) {
    double *u = s->rest.exact ? s->d : s->u;
    compute_displacement(s, NULL, s->p, inner_tolerance, u);
    compute_rate(s, u);
    for_all(s, s->count, add_compliance, 0.0, NULL, NULL);
}

/* lambda += scale p, and what follows from it. */
static void advance(struct dual *s, double scale) {
    for_all(s, s->count, step_along_direction, scale, NULL, NULL);
    if (!s->rest.exact) for_all(s, s->model->particles, add_scaled, scale, s->u, s->d);
}

/* p = the step from lambda to the bounds */
static void compute_clipping(void *arg, int first, int last, int block) {
    (void)block;
    struct dual *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) s->p[i] = larger(0.0, -s->multiplier[i]);
}

/* Clips negative multipliers, and updates g. */
static void clip_multipliers(struct dual *s) {
    for_all(s, s->count, compute_clipping, 0.0, NULL, NULL);
    multiply(s);
    advance(s, 1.0);
}

/* p = change of the multipliers, clipped */
static void compute_change(void *arg, int first, int last, int block) {
    (void)block;
    struct dual *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) {
        s->multiplier[i] = larger(0.0, s->multiplier[i]);
        s->p[i] = multiplier_change(s, i);
    }
}

/* ---- the solve ------------------------------------------------------------------------------- */

static void start(struct dual *s, const double *b) {
    const pdyn_services *services = s->model->services;
    for (int k = 0; k < s->parts; k++) {
        struct call call = {.s = s, .part = &s->part[k]};
        services->parallel_for(services->core, s->part[k].at.count, GRAIN, start_constraints,
                               &call);
    }
    compute_displacement(s, b, s->p, end_tolerance, s->d);
    compute_rate(s, s->d);
    for_all(s, s->count, compute_residual, 0.0, NULL, NULL);
    memset(s->q, 0, (size_t)s->count * sizeof *s->q);
    for_all(s, s->count, step_along_direction, 0.0, NULL, NULL);
    if (s->limited) s->target = fmin(s->target, max_reduction * sqrt(sum_of(s, 2)));
}

static void iterate(struct dual *s, int max_iterations, int *iterations) {
    double before = 0.0;
    while (sum_of(s, 2) > s->target * s->target && *iterations < max_iterations) {
        double gz = sum_of(s, 3);
        for_all(s, s->count, update_direction, before > 0.0 ? gz / before : 0.0, NULL, NULL);
        before = gz;
        multiply(s);
        double curvature = sum_of(s, 1);
        if (!(curvature > 0.0)) return; /* g is 0, or not finite */
        advance(s, sum_of(s, 0) / curvature);
        ++*iterations;
        if (sum_of(s, 0) > max_beyond * sum_of(s, 1)) clip_multipliers(s), before = 0.0;
    }
}

/* Returns the number of constraints of all parts. */
static int find_parts(struct dual *s) {
    int count = 0;
    for (int k = 0; k < s->parts; k++) {
        struct part *part = &s->part[k];
        part->at = s->model->one_sided(s->model, k, &part->body);
        part->first = count, count += part->at.count;
    }
    return count;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct dual *s = self;
    pdyn_status status = reserve(s, find_parts(s));
    if (status != PDYN_OK) return status;
    s->d = y;
    s->target = stop->rel_tol * sqrt(s->model->dot(s->model, b, b));
    *iterations = s->products = 0;
    rest_solve_update(&s->rest, stop->first_of_step);
    start(s, b);
    int most =
        s->limited && stop->max_iterations > MAX_COUPLED ? MAX_COUPLED : stop->max_iterations;
    iterate(s, most, iterations);
    for_all(s, s->count, compute_change, 0.0, NULL, NULL);
    if (s->rest.exact) compute_displacement(s, b, s->p, 0.0, s->d);
    else correct_displacement(s, b, s->p);
    *iterations += s->products;
    return PDYN_OK;
}

static void forget(void *self) {
    struct dual *s = self;
    if (s->multiplier) memset(s->multiplier, 0, (size_t)s->count * sizeof *s->multiplier);
}

static pdyn_status fail_invalid(const struct dual *s, const char *message) {
    const pdyn_services *services = s->model->services;
    return services->set_error(services->core, PDYN_BAD_INPUT, message);
}

static pdyn_status persist(void *self, pdyn_snapshot *snapshot) {
    struct dual *s = self;
    int count = s->count;
    bool valid = true;
    snapshot->bytes(snapshot, &count, sizeof count);
    if (snapshot->reading && (count < 0 || count / MAX_PER_PARTICLE > s->model->particles))
        return fail_invalid(s, "not a saved state of this scene: the number of multipliers is out "
                               "of range");
    if (snapshot->reading && reserve(s, count) != PDYN_OK) return PDYN_NO_MEMORY;
    if (count) snapshot->bytes(snapshot, s->multiplier, (size_t)count * sizeof *s->multiplier);
    if (!snapshot->reading) return PDYN_OK;
    for (int i = 0; i < count; i++) valid &= s->multiplier[i] >= 0.0 && isfinite(s->multiplier[i]);
    return valid ? PDYN_OK
                 : fail_invalid(s, "not a saved state of this scene: a multiplier is negative or "
                                   "not finite");
}

const pdyn_global_solver pdyn_solver_dual = {
    .name = "dual",
    .summary = "conjugate gradients on the pressures of the fluid, kept from step to step; for a "
               "fluid alone, and for stiff fluids beside cloth and solids",
    .dual = true,
    .state_size = sizeof(struct dual),
    .suits = suits,
    .create = create,
    .solve = solve,
    .forget = forget,
    .free = release,
    .persist = persist,
};
