/* Convergence within one step of a scene: error after each outer iteration against processor time,
 * of the projective and the newton step from the same state, both from s without a warm start.
 * Prints CSV:
 *
 *     step,iteration,ms,gap,residual,density_mean,density_max,distance
 *
 * gap: (E - E*) / (E(first) - E*); distance: |x - x*| / |s - x*|; x* and E* from a newton step run
 * to stagnation. Overrides hold for the warm-up and for the measured step.
 * Usage: convergence SCENE [WARM_UP_SECONDS [PROJECTIVE_ITERATIONS [KEY=VALUE...]]] */
#include "base/clock.h"
#include "bench.h"
#include "sim/sim.h"

#include "projdyn/control.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct input {
    const char *scene;
    char **set; /* overrides, KEY=VALUE */
    int sets;
};

struct record {
    double ms, energy, residual;
    double *x;
};

struct trace {
    pdyn_sim *sim;
    int count, capacity;
    struct record *record;
    double start, paused; /* ms; time of the observer is subtracted */
};

static void note(void *user, const pdyn_iteration *it) {
    struct trace *t = user;
    double now = clock_cpu_ms();
    size_t bytes = 3 * (size_t)t->sim->objective.particles * sizeof(double);
    if (t->count == t->capacity) return;
    struct record *r = &t->record[t->count++];
    *r = (struct record){now - t->start - t->paused, it->energy, it->residual, malloc(bytes)};
    if (!r->x) die("out of memory");
    memcpy(r->x, it->x, bytes);
    t->paused += clock_cpu_ms() - now;
}

/* Loads the scene with the user's overrides and then those of the measurement. */
static pdyn_sim *load(pdyn_context *context, const struct input *input, int count,
                      const char *const *set) {
    const char **all = malloc((size_t)(input->sets + count + 1) * sizeof *all);
    if (!all) die("out of memory");
    for (int k = 0; k < input->sets; k++) all[k] = input->set[k];
    for (int k = 0; k < count; k++) all[input->sets + k] = set[k];
    pdyn_sim *sim;
    if (pdyn_load(context, input->scene, all, input->sets + count, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    free(all);
    return sim;
}

/* Copies the state of a simulation to another one of the same scene, without warm-start data. */
static void copy_state(const pdyn_sim *from, pdyn_sim *to) {
    size_t bytes = 3 * (size_t)from->objective.particles * sizeof(double);
    memcpy(to->x, from->x, bytes);
    memcpy(to->v, from->v, bytes);
    to->time = from->time, to->frame = from->frame;
}

/* Solves one step of length *h; where it is 0, the length that the scene chooses goes to *h. */
static struct trace solve(pdyn_context *context, const struct input *input, const pdyn_sim *state,
                          const char *kind, int iterations, const char *linear, double *h) {
    char step[64], outer[64], tolerance[64];
    const char *set[] = {step, outer, tolerance, "solver.tolerance=0"};
    snprintf(step, sizeof step, "solver.step=%s", kind);
    snprintf(outer, sizeof outer, "solver.outer_iterations=%d", iterations);
    snprintf(tolerance, sizeof tolerance, "solver.linear_tolerance=%s", linear);
    struct trace t = {.sim = load(context, input, 4, set), .capacity = iterations + 1};
    t.record = calloc((size_t)t.capacity, sizeof *t.record);
    if (!t.record) die("out of memory");
    copy_state(state, t.sim);
    pdyn_observe(t.sim, note, &t);
    t.start = clock_cpu_ms();
    pdyn_step_info info;
    pdyn_status status = *h > 0.0 ? pdyn_step_by(t.sim, *h, &info) : pdyn_step(t.sim, &info);
    if (status != PDYN_OK) die("%s", pdyn_last_error(context));
    if (info.retries || (*h > 0.0 && fabs(info.h - *h) > 1e-9 * *h)) die("the step was shortened");
    *h = info.h;
    return t;
}

/* Mean and largest density error at x, over all bodies of particles. */
static void density_errors(pdyn_sim *sim, const double *x, double *mean, double *max) {
    double energy, count = 0.0;
    *mean = *max = 0.0;
    objective_local(&sim->objective, x, &energy, sim->gradient);
    for (int b = 0; b < sim->objective.batches; b++) {
        const struct batch *batch = sim->objective.batch[b];
        if (!batch->op) continue;
        batch->type->matrix_free->density(batch->op, sim->density);
        const pdyn_body *body = batch->view.body;
        for (int i = body->first; i < body->first + body->count; i++, count++) {
            double error = fmax(0.0, sim->density[i] / body->rest_density - 1.0);
            *mean += error;
            *max = fmax(*max, error);
        }
    }
    if (count > 0.0) *mean /= count;
}

static double distance(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

static void print(const char *kind, struct trace *t, const struct trace *best) {
    const struct record *last = &best->record[best->count - 1];
    int n = 3 * t->sim->objective.particles;
    double start = distance(best->sim->objective.s, last->x, n);
    for (int k = 0; k < t->count; k++) {
        const struct record *r = &t->record[k];
        double mean, max;
        density_errors(t->sim, r->x, &mean, &max);
        printf("%s,%d,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g\n", kind, k, r->ms,
               (r->energy - last->energy) / (best->record[0].energy - last->energy), r->residual,
               mean, max, distance(r->x, last->x, n) / start);
    }
}

static void release(struct trace *t) {
    for (int k = 0; k < t->count; k++) free(t->record[k].x);
    free(t->record);
    pdyn_free(t->sim);
}

int main(int argc, char **argv) {
    static const char usage[] =
        "usage: convergence SCENE [WARM_UP_SECONDS [PROJECTIVE_ITERATIONS [KEY=VALUE...]]]";
    if (argc < 2) die("%s", usage);
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) return puts(usage), 0;
    double warm = argc > 2 ? atof(argv[2]) : 0.2;
    int projective = argc > 3 ? atoi(argv[3]) : 1000;
    struct input input = {argv[1], argv + 4, argc > 4 ? argc - 4 : 0};
    pdyn_context *context = make_context(1);
    pdyn_sim *state = load(context, &input, 0, NULL);
    while (pdyn_time(state) < warm * (1.0 - 1e-9)) take_step(state);
    double h = 0.0;
    struct trace best = solve(context, &input, state, "newton", 300, "1e-6", &h);
    struct trace newton = solve(context, &input, state, "newton", 40, "0.1", &h);
    struct trace classic = solve(context, &input, state, "projective", projective, "0.01", &h);
    printf("step,iteration,ms,gap,residual,density_mean,density_max,distance\n");
    print("newton", &newton, &best);
    print("projective", &classic, &best);
    release(&best), release(&newton), release(&classic);
    pdyn_free(state);
    pdyn_destroy(context);
    return 0;
}
