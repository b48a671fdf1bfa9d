#include "contest.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* With one thread the processor's time, which other programs disturb less. */
static double now_ms(const struct contest *contest) {
    return 1e3 * (contest->scene.threads == 1 ? processor_seconds() : wall_seconds());
}

/* All of the process, with what libraries hold. */
static double bytes_held(void) {
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

static double diagonal(const pdyn_state *state) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int k = 0; k < 3 * state->particles; k++) {
        low[k % 3] = fmin(low[k % 3], state->x[k]);
        high[k % 3] = fmax(high[k % 3], state->x[k]);
    }
    return sqrt(pow(high[0] - low[0], 2.0) + pow(high[1] - low[1], 2.0) +
                pow(high[2] - low[2], 2.0));
}

/* What is the same in every round is taken from the last. */
static bool keep_result(struct contender *c, const pdyn_sim *sim, double bytes) {
    pdyn_state state = pdyn_get_state(sim);
    size_t size = 3 * (size_t)state.particles * sizeof(double);
    if (!c->x) c->x = malloc(size + 1);
    if (!c->x) return false;
    memcpy(c->x, state.x, size);
    c->particles = state.particles, c->bytes = bytes;
    snprintf(c->integrator, sizeof c->integrator, "%s", pdyn_integrator(sim));
    return true;
}

static int take_steps(const struct contest *contest, struct contender *c, pdyn_context *context,
                      pdyn_sim *sim) {
    c->outer = c->linear = c->residual = 0.0;
    pdyn_state state = pdyn_get_state(sim);
    c->size = diagonal(&state);
    for (int k = 0; k < contest->steps; k++) {
        pdyn_step_info info;
        double start = now_ms(contest);
        pdyn_status status = pdyn_step(sim, &info);
        c->step_ms[k] = fmin(c->step_ms[k], now_ms(contest) - start);
        if (status != PDYN_OK) return report_status(context, status);
        c->outer += info.outer_iterations, c->linear += info.linear_iterations;
        c->residual += info.step_residual;
    }
    return EXIT_GOOD;
}

static int run_once(const struct contest *contest, struct contender *c, bool first) {
    char solver[64];
    struct scene_options scene = contest->scene;
    const char **set = calloc((size_t)scene.sets + 1, sizeof *set);
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    if (!set) return EXIT_FAILED;
    if (scene.sets) memcpy(set, scene.set, (size_t)scene.sets * sizeof *set);
    snprintf(solver, sizeof solver, "solver.type=%.40s", c->solver);
    set[scene.sets++] = solver, scene.set = set, scene.silent = !first;
    double before = bytes_held(), start = now_ms(contest);
    int code = scene_load(&scene, &context, &sim);
    c->load_ms = fmin(c->load_ms, now_ms(contest) - start);
    if (code == EXIT_GOOD) code = take_steps(contest, c, context, sim);
    if (code == EXIT_GOOD && !keep_result(c, sim, bytes_held() - before)) code = EXIT_FAILED;
    pdyn_free(sim);
    pdyn_destroy(context);
    free(set);
    return code;
}

int contest_run(struct contest *contest) {
    int code = EXIT_GOOD, n = contest->contenders;
    for (int k = 0; k < n; k++) {
        struct contender *c = &contest->contender[k];
        c->load_ms = INFINITY;
        c->step_ms = malloc((size_t)contest->steps * sizeof *c->step_ms);
        if (!c->step_ms) return EXIT_FAILED;
        for (int s = 0; s < contest->steps; s++) c->step_ms[s] = INFINITY;
    }
    for (int r = 0; r < contest->rounds; r++)
        for (int k = 0; k < n && code == EXIT_GOOD; k++)
            code = run_once(contest, &contest->contender[r % 2 ? n - 1 - k : k], r == 0);
    return code;
}

void contest_free(struct contest *contest) {
    for (int k = 0; k < contest->contenders; k++) {
        free(contest->contender[k].step_ms);
        free(contest->contender[k].x);
    }
    free(contest->contender);
}

/* ---- what is to be said ---------------------------------------------------------------------- */

double contest_step_ms(const struct contest *contest, const struct contender *c) {
    double sum = 0.0;
    for (int k = 1; k < contest->steps; k++) sum += c->step_ms[k];
    return contest->steps > 1 ? sum / (contest->steps - 1) : c->step_ms[0];
}

double contest_prepare_ms(const struct contest *contest, const struct contender *c) {
    return c->load_ms + fmax(0.0, c->step_ms[0] - contest_step_ms(contest, c));
}

double contest_difference(const struct contender *a, const struct contender *b) {
    double sum = 0.0;
    for (int k = 0; k < 3 * a->particles; k++) sum += (a->x[k] - b->x[k]) * (a->x[k] - b->x[k]);
    return sqrt(sum / fmax(1.0, a->particles)) / a->size;
}

double contest_catches_up(const struct contest *contest, const struct contender *a,
                          const struct contender *b) {
    double behind = a->load_ms - b->load_ms;
    int last = 0;
    for (int k = 0; k < contest->steps; k++) {
        behind += a->step_ms[k] - b->step_ms[k];
        if (behind > 0.0) last = k + 1;
    }
    double gain = contest_step_ms(contest, b) - contest_step_ms(contest, a);
    if (behind <= 0.0) return last;
    return gain > 0.0 ? contest->steps + ceil(behind / gain) : INFINITY;
}
