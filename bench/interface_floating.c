/* Floating cubes, slabs (half as high as wide: these do not roll over) and balls: the submerged
 * volume fraction, which should be the density ratio to water, and the heave period after a release
 * at 110 % of the draught. Bodies denser than water are released four spacings above the floor: the
 * gap that remains below. */
#include "interface.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846, contact = 0.003; /* m, of what sinks */
enum { BELOW = 8 }; /* spacings of water below a floating body: fewer hold it where it starts */

enum shape { CUBE, SLAB, BALL, SHAPES };
static const char *const names[SHAPES] = {"cube", "slab", "ball"};

struct floater {
    enum shape shape;
    double density;          /* kg/m^3 */
    double d, width, height; /* m */
    double middle[3];        /* m, at the start */
    double draught;          /* m, in equilibrium */
    int n;                   /* width in spacings */
    int cells[3];            /* of the water */
};

static bool keep(const void *user, double x[3]) {
    const struct floater *f = user;
    double r[3], half = 0.5 * f->width + 0.499 * f->d;
    for (int k = 0; k < 3; k++) r[k] = fabs(x[k] - f->middle[k]);
    if (f->shape == BALL) return hypot(hypot(r[0], r[1]), r[2]) > half;
    return fmax(r[0], r[2]) > half || r[1] > 0.5 * f->height + 0.499 * f->d;
}

/* Draught over height in equilibrium. Ball: submerged fraction = t^2 (3 - 2 t), t: draught over
 * diameter. */
static double draught_over_height(const struct floater *f) {
    double share = fmin(1.0, f->density / density), low = 0.0, high = 1.0;
    if (f->shape != BALL) return share;
    for (int k = 0; k < 60; k++) {
        double t = 0.5 * (low + high);
        *(t * t * (3.0 - 2.0 * t) < share ? &low : &high) = t;
    }
    return low;
}

static void layout(struct floater *f) {
    bool sinks = f->density > density;
    f->width = f->n * f->d, f->height = f->shape == SLAB ? 0.5 * f->width : f->width;
    f->draught = f->height * draught_over_height(f);
    f->cells[0] = f->cells[2] = 2 * f->n + 8;
    f->cells[1] = f->n + BELOW;
    f->middle[0] = f->middle[2] = 0.5 * f->cells[0] * f->d;
    double bottom = sinks ? 4.0 * f->d : f->cells[1] * f->d - 1.1 * f->draught;
    f->middle[1] = bottom + 0.5 * f->height;
}

static pdyn_sim *load_floater(const struct job *job, const struct floater *f) {
    char water[4096], mesh[4096];
    static struct scene s;
    int cells = f->n / 4 * 2;
    lattice_write(job_file(job, "floating.ply", water), f->d, f->cells, keep, f);
    scene_start(&s, ordinary, f->density > density ? contact : 0.0);
    scene_water(&s, f->d, f->cells[1] * f->d, plain, "{'file': '%s'}", water);
    scene_put(&s, ", {'name': 'floater', 'volume': {");
    if (f->shape == BALL) {
        ball_write(job, "ball", cells, mesh);
        scene_put(&s, "'mesh': '%s', 'scale': %.17g", mesh, 0.5 * f->height);
    } else
        scene_put(&s, "'grid': {'size': [%.17g, %.17g, %.17g], 'cells': [%d, %d, %d]}", f->width,
                  f->height, f->width, cells, f->shape == SLAB ? cells / 2 : cells, cells);
    scene_put(&s,
              ", 'density': %.17g, 'translate': [%.17g, %.17g, %.17g]}, 'constraints': [{'type': "
              "'tet', 'stiffness': 1e6}]}",
              f->density, f->middle[0], f->middle[1], f->middle[2]);
    scene_tank(&s, f->cells[0] * f->d, (f->cells[1] + f->n) * f->d, f->cells[2] * f->d);
    return scene_load(job, &s);
}

/* The frame of the water surface beside the body. */
static struct frame frame_of(const struct floater *f) {
    double inner = 0.75 * f->width, outer = (0.5 * f->cells[0] - 1.5) * f->d;
    return (struct frame){.middle = {f->middle[0], f->middle[2]},
                          .outer = {outer, outer},
                          .inner = {inner, inner},
                          .low = (f->cells[1] - 3) * f->d};
}

/* Submerged fraction over time, and its zero crossings about equilibrium. */
enum { STEPS = 100000, PASSES = 4 };
struct heave {
    int steps;
    double time[STEPS], share[STEPS];
};

/* Period from the crossings of `rest`, s, while the amplitude exceeds a tenth of the first; NAN
 * with fewer than two. */
static double period(const struct heave *h, double rest) {
    double pass[PASSES], swing = 0.0, first = 0.0;
    int passes = 0;
    for (int k = 0; k < h->steps; k++) {
        double now = h->share[k] - rest, last = k ? h->share[k - 1] - rest : now;
        first = h->time[k] < 0.1 ? fmax(first, fabs(now)) : first;
        swing = fmax(swing, fabs(now));
        if ((now > 0.0) == (last > 0.0) || passes == PASSES) continue;
        if (swing < 0.1 * first) break;
        pass[passes++] = h->time[k] - (h->time[k] - h->time[k - 1]) * now / (now - last);
        swing = 0.0;
    }
    return passes < 2 ? NAN : 2.0 * (pass[passes - 1] - pass[0]) / (passes - 1);
}

/* Period without added mass, s. */
static double bare_period(const struct floater *f) {
    double plane = f->width * f->width, volume = plane * f->height;
    if (f->shape == BALL) {
        volume *= pi / 6.0;
        plane = pi * f->draught * (f->height - f->draught);
    }
    return 2.0 * pi * sqrt(f->density * volume / (density * g * plane));
}

static double turned(const double low[3], const double high[3]) {
    double across = hypot(high[0] - low[0], high[2] - low[2]);
    return atan2(across, high[1] - low[1]) * 180.0 / pi;
}

static void run(const struct job *job, FILE *csv, const struct floater *f, double seconds) {
    static struct heave heave;
    pdyn_sim *sim = load_floater(job, f);
    const struct frame frame = frame_of(f);
    struct sample share = {0}, gap = {0}, draught = {0};
    struct ends ends;
    double low[3], high[3];
    ends_find(&ends, sim, 1);
    heave.steps = 0;
    while (pdyn_time(sim) < seconds && heave.steps < STEPS) {
        pdyn_step_info info = take_step(sim);
        double level = surface_height(sim, &frame), under = body_submerged(sim, 1, level);
        body_ends(sim, &ends, low, high);
        fprintf(csv, "%s,%g,%.6g,%.6g,%.6g,%.6g,%.4g\n", names[f->shape], f->density, info.time,
                level, under, low[1] / f->d, info.step_residual);
        heave.time[heave.steps] = info.time, heave.share[heave.steps++] = under;
        if (info.time < 0.6 * seconds) continue;
        sample_add(&share, info.h, under), sample_add(&gap, info.h, low[1] / f->d);
        sample_add(&draught, info.h, (level - low[1]) / f->height);
    }
    printf("| %s | %g | %g | %d | %d |", names[f->shape], f->density, 1e3 * f->d, f->n,
           pdyn_get_body(sim, 0).count);
    if (f->density > density)
        printf(" | | | | | | %.1f | %.2f |\n", turned(low, high), sample_mean(&gap));
    else
        printf(" %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.2f | %.2f | %.1f | |\n",
               100.0 * sample_mean(&share), 100.0 * sample_deviation(&share),
               100.0 * sample_mean(&draught), 100.0 * f->draught / f->height,
               period(&heave, sample_mean(&share)), bare_period(f), turned(low, high));
    fflush(stdout);
    ends_free(&ends);
    pdyn_free(sim);
}

/* SECONDS MM N SHAPE:DENSITY... */
void floating(const struct job *job) {
    double seconds = job_number(job, 0, 3.0), d = 1e-3 * job_number(job, 1, 25.0);
    int n = (int)job_number(job, 2, 12.0);
    FILE *csv = open_csv(job->directory, "floating");
    if (n < 4) die("expected bodies of four spacings or more");
    fprintf(csv, "shape,density,time_s,level_m,submerged,bottom_d,residual\n");
    printf("| body | density, kg/m^3 | d, mm | width, d | particles | submerged volume | standard "
           "deviation | draught over height | exact | period of heave, s | without added mass, s | "
           "tilt, degrees | gap at rest, d |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 3; k < job->count; k++) {
        char name[8];
        struct floater f = {.shape = SHAPES, .d = d, .n = n};
        if (sscanf(job->argument[k], "%7[a-z]:%lf", name, &f.density) == 2)
            for (f.shape = 0; f.shape < SHAPES && strcmp(name, names[f.shape]);) f.shape++;
        if (f.shape == SHAPES) die("expected SHAPE:DENSITY, found %s", job->argument[k]);
        layout(&f);
        run(job, csv, &f, seconds);
    }
    fclose(csv);
}
