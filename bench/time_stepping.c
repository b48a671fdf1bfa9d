/* Time integrators compared; prints markdown.
 *
 *     time_stepping order SCENE SECONDS FRAMES REFERENCE_MS "MS ..." [PATH=VALUE ...]
 *     time_stepping sloshing "MS ..."
 *
 * order: both integrators with these steps against BDF2 with the reference step: root mean square
 * distance of all particles over the frames, m; energy loss over the largest kinetic energy; ms per
 * step. sloshing: decay of the first mode in a tank of 1 m, half as deep, from 0.4 m/s, without
 * viscosity. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { INTEGRATORS = 2, SETS = 32 };
static const char *const names[INTEGRATORS] = {"euler", "bdf2"};

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

/* ---- order ----------------------------------------------------------------------------------- */

struct course {
    double *x; /* frames x particles x 3 */
    size_t size;
    double lost, ms; /* energy over its kinetic maximum; ms per step */
};

struct request {
    const char *scene;
    double seconds;
    int frames, sets;
    const char *set[SETS];
};

static void follow(pdyn_sim *sim, int frames, struct course *c) {
    const pdyn_state state = pdyn_get_state(sim);
    double first = NAN, kinetic = 0.0, begun = now_ms(), energy = 0.0;
    int steps = 0;
    c->size = 3 * (size_t)state.particles;
    c->x = malloc((size_t)frames * c->size * sizeof *c->x);
    if (!c->x) die("no memory");
    for (int frame = 0; frame < frames; steps++) {
        pdyn_step_info info = take_step(sim);
        energy = info.kinetic_energy + info.potential_energy + info.constraint_energy;
        if (steps == 0) first = energy;
        kinetic = fmax(kinetic, info.kinetic_energy);
        if (info.frame) memcpy(c->x + (size_t)frame++ * c->size, state.x, c->size * sizeof *c->x);
    }
    c->ms = (now_ms() - begun) / steps, c->lost = (first - energy) / kinetic;
}

static struct course run(const struct request *r, const char *integrator, double ms) {
    char step[64], kind[64], duration[64], interval[64];
    const char *set[SETS + 4] = {step, kind, duration, interval};
    struct course c;
    pdyn_context *context = make_context(1);
    pdyn_sim *sim;
    snprintf(step, sizeof step, "time_step.fixed=%.17g", 1e-3 * ms);
    snprintf(kind, sizeof kind, "time_step.integrator=%s", integrator);
    snprintf(duration, sizeof duration, "duration=%.17g", r->seconds);
    snprintf(interval, sizeof interval, "frame_interval=%.17g", r->seconds / r->frames);
    for (int k = 0; k < r->sets; k++) set[4 + k] = r->set[k];
    if (pdyn_load(context, r->scene, set, 4 + r->sets, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    follow(sim, r->frames, &c);
    pdyn_free(sim);
    pdyn_destroy(context);
    return c;
}

static double distance(const struct course *a, const struct course *b, int frames) {
    double sum = 0.0;
    for (size_t k = 0; k < (size_t)frames * a->size; k++)
        sum += (a->x[k] - b->x[k]) * (a->x[k] - b->x[k]);
    return sqrt(3.0 * sum / ((double)frames * (double)a->size));
}

static void order(const struct request *r, double reference_ms, char *steps) {
    struct course reference = run(r, "bdf2", reference_ms);
    double before_ms = 0.0, before[INTEGRATORS] = {0};
    printf(
        "| h, ms | error, m: euler | bdf2 | ratio | order: euler | bdf2 | energy lost, %%: euler "
        "| bdf2 | ms a step: euler | bdf2 |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (char *at = strtok(steps, " "); at; at = strtok(NULL, " ")) {
        double ms = atof(at), error[INTEGRATORS], rate[INTEGRATORS];
        struct course c[INTEGRATORS];
        for (int k = 0; k < INTEGRATORS; k++) {
            c[k] = run(r, names[k], ms);
            error[k] = distance(&c[k], &reference, r->frames);
            rate[k] = log(before[k] / error[k]) / log(before_ms / ms);
            before[k] = error[k];
            free(c[k].x);
        }
        printf("| %g | %.2e | %.2e | %.1f |", ms, error[0], error[1], error[0] / error[1]);
        if (before_ms > 0.0) printf(" %.2f | %.2f |", rate[0], rate[1]);
        else printf(" | |");
        printf(" %.2f | %.2f | %.2f | %.2f |\n", 100.0 * c[0].lost, 100.0 * c[1].lost, c[0].ms,
               c[1].ms);
        before_ms = ms;
    }
    free(reference.x);
}

/* ---- sloshing -------------------------------------------------------------------------------- */

enum { SWINGS = 5 };

/* Decay of the maxima of the centre of mass, 1/s. */
static double decay(const char *integrator, double ms) {
    static const char tank[] =
        "{'duration': 100, 'frame_interval': 100, 'time_step': {'fixed': %.17g, "
        "'integrator': '%s'}, 'solver': {'tolerance': 0.01, 'outer_iterations': 100}, "
        "'bodies': [{'name': 'water', 'velocity': [0.4, 0, 0], 'particles': {'radius': "
        "0.015625, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [1, 0.5, 0.25]}}]}, "
        "'constraints': [{'type': 'fluid', 'viscosity': 0}]}], 'solids': [{'box': "
        "{'minimum': [0, 0, 0], 'maximum': [1, 0.75, 0.25]}, 'open': ['+y']}]}";
    pdyn_context *context = make_context(1);
    pdyn_sim *sim = load_text(context, tank, 1e-3 * ms, integrator);
    const pdyn_state s = pdyn_get_state(sim);
    double before = 0.0, farthest = 0.0, first = 0.0, last = 0.0, begin = 0.0, end = 0.0;
    for (int swings = 0; swings < SWINGS;) {
        pdyn_step_info info = take_step(sim);
        double x = -0.5;
        for (int i = 0; i < s.particles; i++) x += s.x[3 * i] / s.particles;
        if (x * before < 0.0) {
            if (swings++ == 0) first = farthest, begin = info.time;
            last = farthest, end = info.time, farthest = 0.0;
        }
        farthest = fmax(farthest, fabs(x)), before = x;
    }
    pdyn_free(sim);
    pdyn_destroy(context);
    return log(first / last) / (end - begin);
}

static void sloshing(char *steps) {
    printf("| h, ms | decay, 1/s: euler | bdf2 |\n|---|---|---|\n");
    for (char *at = strtok(steps, " "); at; at = strtok(NULL, " "))
        printf("| %s | %.3f | %.3f |\n", at, decay("euler", atof(at)), decay("bdf2", atof(at)));
}

int main(int argc, char **argv) {
    if (argc == 3 && !strcmp(argv[1], "sloshing")) sloshing(argv[2]);
    else if (argc >= 7 && argc - 7 <= SETS && !strcmp(argv[1], "order")) {
        struct request r = {argv[2], atof(argv[3]), atoi(argv[4]), argc - 7, {0}};
        for (int k = 0; k < r.sets; k++) r.set[k] = argv[7 + k];
        order(&r, atof(argv[5]), argv[6]);
    } else
        die("usage: time_stepping order SCENE SECONDS FRAMES REFERENCE_MS \"MS ...\" "
            "[PATH=VALUE ...] | sloshing \"MS ...\"");
    return 0;
}
