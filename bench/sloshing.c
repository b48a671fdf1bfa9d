/* First sloshing mode of water in a rectangular tank, half as deep as long: frequency against
 * linear theory, omega^2 = g k tanh(k D), k = pi / L, and decay, over the step, the viscosity and
 * the initial speed.
 *
 * The water starts with a uniform speed along the tank, which excites the odd modes; the third one
 * moves the centre of mass by some 2 % of the first. Frequency and decay are computed from the
 * centre of mass along the tank, its zero crossings and the maxima in between, over the first
 * swings: in later, smaller swings particles do not change places. */
#include "validation.h"

#include <math.h>

enum { WIDTH = 8, SWINGS = 5 };

static const double length = 1.0; /* m */

static const struct {
    double step, viscosity, speed; /* s, 1, m/s */
} runs[] = {
    {0.01, 0.0, 0.4},   {0.01, 0.02, 0.4},  {0.01, 0.1, 0.4},   {0.005, 0.0, 0.4},
    {0.005, 0.02, 0.4}, {0.005, 0.1, 0.4},  {0.0025, 0.0, 0.4}, {0.0025, 0.02, 0.4},
    {0.0025, 0.1, 0.4}, {0.005, 0.02, 0.1}, {0.005, 0.02, 0.2}, {0.005, 0.02, 0.6},
};

struct swings {
    int count;                             /* times the middle was passed */
    double time[SWINGS], farthest[SWINGS]; /* s; m, since the time before */
};

/* m, from the middle of the tank */
static double centre(const pdyn_state *s) {
    double sum = 0.0;
    for (int i = 0; i < s->particles; i++) sum += s->x[3 * i];
    return sum / s->particles - 0.5 * length;
}

static void add_passage(struct swings *s, double time, double farthest) {
    s->time[s->count] = time, s->farthest[s->count++] = farthest;
}

static struct swings swing(pdyn_context *context, const char *directory,
                           const struct water *water) {
    char name[64];
    struct swings swings = {0};
    pdyn_sim *sim = water_load(context, water);
    const pdyn_state state = pdyn_get_state(sim);
    double before = 0.0, farthest = 0.0;
    snprintf(name, sizeof name, "sloshing_%g_%g_%g", water->speed, water->step, water->viscosity);
    FILE *csv = open_csv(directory, name);
    fprintf(csv, "time_s,centre_m\n");
    while (swings.count < SWINGS && pdyn_time(sim) < water->duration) {
        pdyn_step_info info = take_step(sim);
        double x = centre(&state);
        fprintf(csv, "%.6g,%.6g\n", info.time, x);
        if (x * before < 0.0) {
            add_passage(&swings, info.time - info.h * x / (x - before), farthest);
            farthest = 0.0;
        }
        farthest = fmax(farthest, fabs(x)), before = x;
    }
    fclose(csv);
    pdyn_free(sim);
    return swings;
}

/* The maxima of the whole swings decay by exp(-rate t). */
static void measure(const struct swings *s, double *omega, double *rate) {
    struct fit passages = {0}, decay = {0};
    for (int k = 0; k < s->count; k++) {
        fit_add(&passages, k, s->time[k]);
        fit_add(&decay, k, log(s->farthest[k]));
    }
    double half = fit_slope(&passages);
    *omega = acos(-1.0) / half;
    *rate = -fit_slope(&decay) / half;
}

static void print_row(const struct water *water, const struct swings *swings, double theory) {
    double omega, rate;
    printf("| %g | %g | %g |", water->speed, 1e3 * water->step, water->viscosity);
    if (swings->count < 3) {
        printf(" fewer than three swings | | | |\n");
        return;
    }
    measure(swings, &omega, &rate);
    printf(" %.0f | %.3f (%+.1f %%) | %.3f | %.3f |\n", 1e3 * swings->farthest[0], omega,
           100.0 * (omega / theory - 1.0), rate, 0.5 * theory * theory * water->step);
}

void sloshing(pdyn_context *context, const char *directory, double seconds, int cells) {
    double d = length / cells, k = acos(-1.0) / length;
    struct water water = {.spacing = d,
                          .cells = {cells, cells / 2, WIDTH},
                          .tank = {length, 0.75 * length, WIDTH * d},
                          .duration = seconds};
    double theory = sqrt(g * k * tanh(k * water.cells[1] * d));
    printf("| speed, m/s | h, ms | viscosity | farthest, mm | omega, 1/s (theory %.3f) "
           "| decay, 1/s | omega^2 h / 2 |\n"
           "|---|---|---|---|---|---|---|\n",
           theory);
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        water.step = runs[i].step, water.viscosity = runs[i].viscosity;
        water.speed = runs[i].speed;
        struct swings swings = swing(context, directory, &water);
        print_row(&water, &swings, theory);
    }
}
