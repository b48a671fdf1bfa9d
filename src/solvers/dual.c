/* Solver "dual": conjugate gradients on the multipliers (pressures) of all matrix-free constraints.
 * With G the gradients of its constraints, K their stiffness and A the remainder of H, the model of
 * E is minimal where
 *
 *     d = A^-1 (b - G' (lambda - K max(0, C))),     b: with the forces of the last local step
 *
 *     C + G d - K^-1 lambda = 0, or less where lambda = 0,     lambda >= 0
 *
 * which is S lambda = rhs with S = K^-1 + G A^-1 G' and bounds: the pressure equation of
 * incompressible SPH (Ihmsen et al. 2014, Bender and Koschier 2015), made compliant by K. Of a
 * fluid alone, A = M/h^2 + eps D is diagonal (D: pdyn_one_sided.weight_sum). Beside rows (cloth,
 * contact), A^-1 is an iteration of its own (remainder_solve.h), with a tolerance of 0.3 within the
 * iteration and of 0.1 at its ends.
 *
 * Multipliers are kept from step to step, so that a fluid at rest starts at its solution. They
 * satisfy the equation of motion exactly, however early the iteration ends; what remains is an
 * error of the constraints. In the unknowns x (cg.c) it is the other way round: the error of a
 * stiff constraint is a large force. Only the displacement d leaves the solver: frames and reports
 * have the pressure k max(0, C) of the last iterate, not lambda.
 *
 * Bounds: multipliers may become negative during the iteration, up to a share of the step. Beyond
 * it they are clipped, and conjugate directions start again. */
#include "memory.h"
#include "multipliers.h"
#include "remainder_solve.h"

#include <math.h>
#include <string.h>

/* Share of a step, in the norm of S's diagonal, that may lie beyond the bounds. */
static const double max_beyond = 0.05;

enum { GRAIN = 2048 }; /* particles of a parallel block */

/* Beside rows: tolerances of solves with A at the ends of a solve and within it; beside cloth and
 * solids, too, reduction of the gradient's estimate in a solve, at least, and the largest number of
 * iterations of a solve. The model changes from one outer iteration to the next, and more of these
 * is worth more. */
static const double end_tolerance = 0.1, inner_tolerance = 0.3, max_reduction = 0.1;
enum { MAX_COUPLED = 10 };

/* Factor of these tolerances: 1 in the first solves of a step, then less from solve to solve, down
 * to `finest`. With a stiff fluid the error of an inexact solve exceeds what the solve gains. */
enum { ROUGH_SOLVES = 7 };
static const double refinement = 0.5, finest = 0.03;

struct part { /* the scalar constraints of one matrix-free constraint */
    pdyn_one_sided at;
    const pdyn_body *body;
    int first; /* in the arrays over all of them */
};

struct dual {
    pdyn_model *model;
    bool limited; /* solves end early, because A^-1 takes many iterations: cloth or solids */
    struct remainder_solve remainder; /* A^-1 */
    double *u, *rhs; /* particles x 3: displacement by p; right side of a solve with A. NULL: not
                        coupled */
    int products;    /* with A in this solve */
    int solves;      /* in this step, this one included */
    double rough;    /* factor of the tolerances beside rows in this solve */
    int parts;       /* matrix-free constraints of the model; theirs follow each other below */
    struct part *part;
    struct multipliers m;
    struct multipliers_step last; /* what the last multipliers_advance returned */
    double *d;                    /* particles x 3: the displacement by the multipliers */
    double target;                /* of the gradient's estimate, N */
};

static void release(void *self) {
    struct dual *s = self;
    if (!s->model) return;
    multipliers_reserve(&s->m, 0);
    FREE(s->model->services, s->part, s->parts);
    FREE(s->model->services, s->u, vector_size(s->model));
    FREE(s->model->services, s->rhs, vector_size(s->model));
    remainder_solve_free(&s->remainder);
}

static int suits(const pdyn_model *model, const char **reason) {
    bool alone = !model->elements_count && !model->dynamic_count && !model->solve_bodies;
    *reason = "it has no fluid, whose pressures would be the unknowns";
    if (!model->one_sided_count) return 0;
    *reason = "fluids act alone: their pressures are the unknowns";
    if (model->newton && alone) return 40;
    bool with_bodies = model->newton && model->solve_bodies && !model->elements_count;
    if (with_bodies) *reason = "pressures are the unknowns beside rigid bodies";
    return with_bodies ? 25 : 1;
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct dual *s = self;
    s->model = model, s->parts = model->one_sided_count, s->m.services = model->services;
    s->part = NEW(model->services, s->parts, struct part);
    if (!s->part) return PDYN_NO_MEMORY;
    pdyn_status status = remainder_solve_create(&s->remainder, model);
    if (status != PDYN_OK || !s->remainder.coupled) return status;
    s->limited = model->elements_count || !model->solve_bodies;
    s->u = NEW(model->services, vector_size(model), double);
    s->rhs = NEW(model->services, vector_size(model), double);
    return s->u && s->rhs ? PDYN_OK : PDYN_NO_MEMORY;
}

/* ---- products with G and A ------------------------------------------------------------------- */

struct call {
    const struct dual *s;
    double scale;
    const double *in;
    double *out;
};

static void for_particles(struct dual *s, pdyn_range_fn *fn, double scale, const double *in,
                          double *out) {
    struct call call = {s, scale, in, out};
    s->model->services->parallel_for(s->model->services->core, s->model->particles, GRAIN, fn,
                                     &call);
}

/* q = G u for the constraints in the solve */
static void compute_rate(struct dual *s, const double *u) {
    for (int k = 0; k < s->parts; k++) {
        int first = s->part[k].first;
        s->model->rate(s->model, k, s->m.in_solve + first, u, s->m.q + first);
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

/* out = b - G' p, b: NULL for 0 */
static void compute_force(struct dual *s, const double *b, double *out) {
    memset(out, 0, 3 * (size_t)s->model->particles * sizeof *out);
    for (int k = 0; k < s->parts; k++) s->model->force(s->model, k, s->m.p + s->part[k].first, out);
    for_particles(s, subtract_from, 0.0, b, out);
}

/* d = A^-1 (b - G' p), to `tolerance` (remainder_solve.h) */
static void compute_displacement(struct dual *s, const double *b, double tolerance, double *d) {
    double *force = s->remainder.coupled ? s->rhs : d;
    compute_force(s, b, force);
    s->products += remainder_solve_apply(&s->remainder, force, d, tolerance);
}

/* d = 0 for particles in no row */
static void clear_free(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const bool *in_rows = c->s->remainder.model->in_rows;
    for (int k = 3 * first; k < 3 * last; k++) c->out[k] = in_rows[k / 3] ? c->out[k] : 0.0;
}

/* d += A^-1 (b - G' p - A d), from 0 for particles in no row: their solve is exact */
static void correct_displacement(struct dual *s, const double *b) {
    pdyn_model *A = s->remainder.model;
    compute_force(s, b, s->rhs);
    for_particles(s, clear_free, 0.0, NULL, s->d);
    A->product(A, s->d, s->u);
    A->for_particles(A, GRAIN, add_scaled, &(struct call){s, -1.0, s->u, s->rhs});
    s->products += remainder_solve_apply(&s->remainder, s->rhs, s->u, s->rough * end_tolerance);
    for_particles(s, add_scaled, 1.0, s->u, s->d);
}

/* q = S p. Returns p . q and, in *gp, g . p. */
static double multiply(struct dual *s, double *gp) {
    double *u = s->remainder.exact ? s->d : s->u;
    compute_displacement(s, NULL, s->rough * inner_tolerance, u);
    compute_rate(s, u);
    return multipliers_add_compliance(&s->m, gp);
}

/* lambda += scale p, and what follows from it. */
static void advance(struct dual *s, double scale) {
    s->last = multipliers_advance(&s->m, scale);
    if (!s->remainder.exact) for_particles(s, add_scaled, scale, s->u, s->d);
}

/* Clips negative multipliers. */
static void clip_multipliers(struct dual *s) {
    double unused;
    multipliers_find_clipping(&s->m);
    multiply(s, &unused);
    advance(s, 1.0);
}

/* ---- the solve ------------------------------------------------------------------------------- */

static void start(struct dual *s, const double *b) {
    for (int k = 0; k < s->parts; k++)
        multipliers_start(&s->m, s->part[k].first, &s->part[k].at, s->part[k].body, s->model->eps,
                          s->remainder.mobility);
    compute_displacement(s, b, s->rough * end_tolerance, s->d);
    compute_rate(s, s->d);
    multipliers_compute_residual(&s->m);
    s->last = multipliers_advance(&s->m, 0.0);
    if (s->limited) s->target = fmin(s->target, s->rough * max_reduction * sqrt(s->last.gradient));
}

static void iterate(struct dual *s, int max_iterations, int *iterations) {
    double before = 0.0, gp;
    while (s->last.gradient > s->target * s->target && *iterations < max_iterations) {
        double gz = s->last.gz;
        multipliers_update_direction(&s->m, before > 0.0 ? gz / before : 0.0);
        before = gz;
        double curvature = multiply(s, &gp);
        if (!(curvature > 0.0)) return; /* g is 0, or not finite */
        advance(s, gp / curvature);
        ++*iterations;
        if (s->last.beyond > max_beyond * s->last.all) clip_multipliers(s), before = 0.0;
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
    pdyn_status status = multipliers_reserve(&s->m, find_parts(s));
    if (status != PDYN_OK) return status;
    s->d = y;
    s->target = stop->rel_tol * sqrt(s->model->dot(s->model, b, b));
    *iterations = s->products = 0;
    s->solves = stop->first_of_step ? 1 : s->solves + 1;
    s->rough = fmax(finest, pow(refinement, fmax(0.0, s->solves - ROUGH_SOLVES)));
    remainder_solve_update(&s->remainder, stop->first_of_step);
    start(s, b);
    int most = stop->max_iterations;
    if (s->limited) most = (int)fmin(most, MAX_COUPLED / s->rough);
    iterate(s, most, iterations);
    multipliers_find_change(&s->m);
    if (s->remainder.exact) compute_displacement(s, b, 0.0, s->d);
    else correct_displacement(s, b);
    *iterations += s->products;
    return PDYN_OK;
}

static void forget(void *self) {
    struct multipliers *m = &((struct dual *)self)->m;
    if (m->lambda) memset(m->lambda, 0, (size_t)m->count * sizeof *m->lambda);
}

static pdyn_status persist(void *self, pdyn_snapshot *snapshot) {
    struct dual *s = self;
    return multipliers_persist(&s->m, s->model->particles, snapshot);
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
