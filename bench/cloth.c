/* Speed and error of a sheet: 1 m, n x n vertices, 0.2 kg/m^2, two corners pinned, springs along
 * the edges, bending, h = 1/60 s; one step from s, 20 steps into the fall.
 *
 *     cloth N STIFFNESS                     one step by several methods
 *     cloth run N STIFFNESS OUTER LINEAR    1 s with limited iterations per step
 *
 * Prints rows of CSV (without arguments: the header). Stretching stiffness in N/m. Error:
 * |x - x*| / |s - x*|, x* the minimum of E. Times are processor time of one thread, the shortest of
 * several runs, methods in turn, without analysis and factorisation. `plain` is the reference:
 * classic Projective Dynamics in plain C, a loop over springs, cholmod_solve2 with its defaults
 * (`plain_simplicial`: without supernodes, for a slow BLAS). */
#include "base/clock.h"
#include "bench.h"
#include "objective/assembly.h"
#include "sim/sim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

enum { FALL = 20, ITERATIONS = 10, POINTS = 400 };

static void *allocate(size_t count, size_t size) {
    void *block = calloc(count, size);
    if (!block) die("out of memory");
    return block;
}

static pdyn_sim *load(pdyn_context *context, int n, double stiffness, const char *solver) {
    return load_text(context,
                     "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'integrator': "
                     "'euler', 'fixed': %.17g}, "
                     "'solver': {%s}, 'bodies': [{'surface': {'grid': {'size': [1, 1], "
                     "'vertices': [%d, %d]}, 'area_density': 0.2}, 'constraints': [{'type': "
                     "'spring', 'stretching_stiffness': %g}, {'type': 'bending', "
                     "'bending_rigidity': 1e-4}, {'type': 'pin', 'vertices': {'vertices': [0, "
                     "%d]}}]}]}",
                     1.0 / 60.0, solver, n, n, stiffness, n - 1);
}

/* Copies the state of a simulation to another one, as if before its first step. */
static void copy_state(const pdyn_sim *from, pdyn_sim *to) {
    memcpy(to->x, from->x, objective_bytes(&from->objective));
    memcpy(to->v, from->v, objective_bytes(&from->objective));
    to->time = from->time, to->frame = from->frame, to->last_h = 0.0;
    to->eps = to->scene.settings.newton ? 0.0 : 1.0;
}

static double distance(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

/* ---- plain C --------------------------------------------------------------------------------- */

struct plain {
    const pdyn_sim *sim;
    const struct batch *spring, *pin;
    int n;
    double *b, *x; /* n x 3 by columns */
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *solution, *work, *scratch;
};

static struct plain *plain_create(pdyn_sim *sim, int supernodal) {
    struct plain *p = allocate(1, sizeof *p);
    struct matrix m = {0};
    *p = (struct plain){.sim = sim, .n = sim->objective.particles};
    p->spring = sim->objective.batch[0], p->pin = sim->objective.batch[2];
    p->b = allocate(3 * (size_t)p->n, sizeof *p->b);
    p->x = allocate(3 * (size_t)p->n, sizeof *p->x);
    cholmod_start(&p->common);
    p->common.supernodal = supernodal;
    sim->objective.h = 1.0 / 60.0;
    if (matrix_pattern(&m, &sim->objective, sim->objective.batch, 1) != PDYN_OK) die("no matrix");
    matrix_values(&m, &sim->objective, sim->objective.batch, true);
    cholmod_sparse A = {.nrow = (size_t)p->n,
                        .ncol = (size_t)p->n,
                        .nzmax = (size_t)m.column_start[p->n],
                        .p = m.column_start,
                        .i = m.row,
                        .x = m.value,
                        .stype = -1,
                        .itype = CHOLMOD_INT,
                        .xtype = CHOLMOD_REAL,
                        .dtype = CHOLMOD_DOUBLE,
                        .packed = 1};
    p->factor = cholmod_analyze(&A, &p->common);
    if (!p->factor || !cholmod_factorize(&A, p->factor, &p->common)) die("no factor");
    matrix_free(&m);
    return p;
}

static void plain_free(struct plain *p) {
    cholmod_free_factor(&p->factor, &p->common);
    cholmod_free_dense(&p->solution, &p->common);
    cholmod_free_dense(&p->work, &p->common);
    cholmod_free_dense(&p->scratch, &p->common);
    cholmod_finish(&p->common);
    free(p->b), free(p->x), free(p);
}

/* b = M/h^2 s + sum of w G' p; flat bending has p = 0. */
static void plain_local(struct plain *p) {
    const struct objective *objective = &p->sim->objective;
    const pdyn_batch *spring = &p->spring->view, *pin = &p->pin->view;
    const double *length = spring->data;
    int n = p->n;
    for (int i = 0; i < n; i++)
        for (int a = 0; a < 3; a++)
            p->b[a * n + i] = objective_inertia(objective, i) * objective->s[3 * i + a];
    for (int e = 0; e < spring->elements; e++) {
        int i = spring->column[2 * e], j = spring->column[2 * e + 1];
        double d[3], l = 0.0;
        for (int a = 0; a < 3; a++) d[a] = p->x[a * n + j] - p->x[a * n + i], l += d[a] * d[a];
        double f = spring->weight[e] * length[e] / sqrt(l);
        for (int a = 0; a < 3; a++) p->b[a * n + i] -= f * d[a], p->b[a * n + j] += f * d[a];
    }
    for (int e = 0; e < pin->elements; e++)
        for (int a = 0; a < 3; a++)
            p->b[a * n + pin->column[e]] += pin->weight[e] * pin->p[3 * e + a];
}

/* Solves one step from s, in ms; *error: |x - x*| / |s - x*| after it. */
static double plain_step(struct plain *p, const double *best, double start, double *error) {
    const double *s = p->sim->objective.s;
    int n = p->n;
    double begin = clock_cpu_ms(), sum = 0.0;
    for (int k = 0; k < 3 * n; k++) p->x[k % 3 * n + k / 3] = s[k];
    for (int it = 0; it < ITERATIONS; it++) {
        plain_local(p);
        cholmod_dense rhs = {.nrow = (size_t)n,
                             .ncol = 3,
                             .nzmax = 3 * (size_t)n,
                             .d = (size_t)n,
                             .x = p->b,
                             .xtype = CHOLMOD_REAL,
                             .dtype = CHOLMOD_DOUBLE};
        if (!cholmod_solve2(CHOLMOD_A, p->factor, &rhs, NULL, &p->solution, NULL, &p->work,
                            &p->scratch, &p->common))
            die("no solution");
        memcpy(p->x, p->solution->x, 3 * (size_t)n * sizeof *p->x);
    }
    double ms = clock_cpu_ms() - begin;
    for (int k = 0; k < 3 * n; k++)
        sum += (p->x[k % 3 * n + k / 3] - best[k]) * (p->x[k % 3 * n + k / 3] - best[k]);
    *error = sqrt(sum) / start;
    return ms;
}

/* ---- our steps ------------------------------------------------------------------------------- */

struct trace { /* of one step */
    const double *best;
    double start;         /* |s - x*| */
    double begin, paused; /* ms; time of the observer is subtracted */
    int points, linear;
    struct point {
        double ms, error;
        int outer, linear;
    } point[POINTS];
    int size;
};

static void note(void *user, const pdyn_iteration *it) {
    struct trace *t = user;
    double now = clock_cpu_ms();
    t->linear += it->linear_iterations;
    if (t->points < POINTS)
        t->point[t->points++] =
            (struct point){now - t->begin - t->paused, distance(it->x, t->best, t->size) / t->start,
                           it->iteration, t->linear};
    t->paused += clock_cpu_ms() - now;
}

static void trace_step(pdyn_sim *sim, const pdyn_sim *state, struct trace *t) {
    copy_state(state, sim);
    t->points = t->linear = 0, t->paused = 0.0;
    pdyn_observe(sim, note, t);
    t->begin = clock_cpu_ms();
    take_step(sim);
}

/* The first point with an error of at most `error`, or the last point. */
static const struct point *reached(const struct trace *t, double error) {
    int k = 0;
    while (k + 1 < t->points && t->point[k].error > error) k++;
    return &t->point[k];
}

/* ---- one step -------------------------------------------------------------------------------- */

struct row {
    const char *method;
    double ms, error;
    int outer, linear;
};

static void keep(struct row *row, const char *method, const struct point *p) {
    if (row->method && row->ms <= p->ms) return;
    *row = (struct row){method, p->ms, p->error, p->outer, p->linear};
}

static void print(const struct row *r, int n, double stiffness) {
    printf("%s,%d,%g,%.3f,%.5f,%d,%d\n", r->method, n, stiffness, r->ms, r->error, r->outer,
           r->linear);
}

/* The newton step with the two-level preconditioner and with block Jacobi, until these errors. */
static const char *const newton_solver[] = {"hybrid", "cg"};
static const char *const newton_method[2][3] = {
    {"newton_10%", "newton_1%", "newton_0.1%"},
    {"newton_cg_10%", "newton_cg_1%", "newton_cg_0.1%"}};

static pdyn_sim *load_newton(pdyn_context *context, int n, double stiffness, const char *solver) {
    char settings[128];
    snprintf(settings, sizeof settings,
             "\"type\": \"%s\", \"tolerance\": 1e-7, \"outer_iterations\": 150", solver);
    return load(context, n, stiffness, settings);
}

static pdyn_sim *load_classic(pdyn_context *context, int n, double stiffness) {
    char settings[256];
    snprintf(settings, sizeof settings,
             "\"tolerance\": 0, \"step\": \"projective\", \"outer_iterations\": %d",
             4 * ITERATIONS);
    return load(context, n, stiffness, settings);
}

static void one_step(pdyn_context *context, int n, double stiffness, int repeat) {
    pdyn_sim *state = load(context, n, stiffness, "\"tolerance\": 1e-3, \"outer_iterations\": 200");
    pdyn_sim *classic = load_classic(context, n, stiffness), *solvers[2], *newton;
    struct row row[2 + 6 + 3] = {{0}};
    for (int q = 0; q < 2; q++) solvers[q] = load_newton(context, n, stiffness, newton_solver[q]);
    newton = solvers[0];
    struct trace t = {.size = 3 * newton->objective.particles};
    double *best = allocate((size_t)t.size, sizeof *best);
    for (int k = 0; k < FALL; k++) take_step(state);
    copy_state(state, newton);
    take_step(newton);
    memcpy(best, newton->x, objective_bytes(&newton->objective));
    t.best = best, t.start = distance(newton->objective.s, best, t.size);
    for (int q = 0; q < 2; q++) {
        solvers[q]->scene.settings.tolerance = 0.0;
        solvers[q]->scene.settings.outer_iterations = 30;
    }
    struct plain *plain[2] = {plain_create(newton, CHOLMOD_AUTO),
                              plain_create(newton, CHOLMOD_SIMPLICIAL)};
    for (int k = 0; k < repeat; k++) {
        for (int q = 0; q < 2; q++) {
            struct point p = {.outer = ITERATIONS, .linear = ITERATIONS};
            p.ms = plain_step(plain[q], best, t.start, &p.error);
            keep(&row[q], q ? "plain_simplicial" : "plain", &p);
        }
        for (int q = 0; q < 6; q++) {
            if (q % 3 == 0) trace_step(solvers[q / 3], state, &t);
            keep(&row[2 + q], newton_method[q / 3][q % 3], reached(&t, pow(0.1, q % 3 + 1)));
        }
        trace_step(classic, state, &t);
        for (int m = 0; k && m < 3; m++) { /* the first one factored; after 10, 20, 40 iterations */
            int at = ITERATIONS << m;
            keep(&row[8 + m], "projective", &t.point[at < t.points ? at : t.points - 1]);
        }
    }
    for (size_t q = 0; q < sizeof row / sizeof *row; q++) print(&row[q], n, stiffness);
    plain_free(plain[0]), plain_free(plain[1]);
    free(best);
    pdyn_free(state), pdyn_free(solvers[0]), pdyn_free(solvers[1]), pdyn_free(classic);
}

/* ---- a run ----------------------------------------------------------------------------------- */

/* Runs with a fixed number of iterations per step; the mean error compares each step with its exact
 * minimum from the same state. */
static void run(pdyn_context *context, int n, double stiffness, int outer, int linear) {
    char cut[256];
    snprintf(cut, sizeof cut,
             "\"tolerance\": 0, \"outer_iterations\": %d, \"linear_iterations\": %d", outer,
             linear);
    pdyn_sim *sim = load(context, n, stiffness, cut);
    pdyn_sim *best = load(context, n, stiffness, "\"tolerance\": 1e-7, \"outer_iterations\": 300");
    double sum = 0.0, worst = 0.0, solves = 0.0, ms = 0.0, most = 0.0;
    int steps = 60, size = 3 * sim->objective.particles;
    for (int k = 0; k < steps; k++) {
        copy_state(sim, best);
        take_step(best);
        const pdyn_step_info info = take_step(sim);
        double error = distance(sim->x, best->x, size) / distance(sim->objective.s, best->x, size);
        sum += error, worst = fmax(worst, error), solves += info.linear_iterations;
        most = fmax(most, info.linear_iterations);
        ms += k ? info.ms_cpu : 0.0;
    }
    printf("run_mean,%d,%g,%.3f,%.5f,%d,%.1f\n", n, stiffness, ms / (steps - 1), sum / steps, outer,
           solves / steps);
    printf("run_worst,%d,%g,,%.5f,%d,%.0f\n", n, stiffness, worst, outer, most);
    pdyn_free(sim), pdyn_free(best);
}

int main(int argc, char **argv) {
    bool whole = argc == 6 && !strcmp(argv[1], "run");
    if (argc == 1) {
        puts("method,n,stiffness,ms,error,outer,linear");
        return 0;
    }
    if (!whole && argc != 3) die("expected N STIFFNESS, see bench/cloth.c");
    pdyn_context *context = make_context(1);
    if (whole) run(context, atoi(argv[2]), atof(argv[3]), atoi(argv[4]), atoi(argv[5]));
    else {
        int n = atoi(argv[1]);
        one_step(context, n, atof(argv[2]), n < 100 ? 10 : n < 200 ? 4 : 2);
    }
    pdyn_destroy(context);
    return 0;
}
