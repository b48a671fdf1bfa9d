/* A square sheet with all vertices pinned is towed through water at rest, edge-on or broadside:
 * mean force along the path over its second half, after a start with constant acceleration. */
#include "interface.h"

#include <math.h>

enum { WIDTH = 6, WAY = 24, BESIDE = 6, BEFORE = 8, KNOTS = 20 }; /* spacings; of the start */
static const double area_density = 0.3, settling = 0.3;           /* kg/m^2, s */

struct tow {
    bool broadside;
    double d, speed;  /* m, m/s */
    double middle[3]; /* m, of the sheet at the start */
    int cells[3];     /* of the water */
};

static void place(const void *user, double s, double t, double x[3]) {
    const struct tow *w = user;
    double u = (s - 0.5) * WIDTH * w->d, v = (t - 0.5) * WIDTH * w->d;
    x[0] = w->middle[0] + (w->broadside ? 0.0 : u);
    x[1] = w->middle[1] + v;
    x[2] = w->middle[2] + (w->broadside ? u : 0.0);
}

/* The start takes a quarter of the path, in twice the time that it takes at full speed. */
static double start_time(const struct tow *w) { return 0.5 * WAY * w->d / w->speed; }

static double end_time(const struct tow *w) {
    return settling + start_time(w) + 0.75 * WAY * w->d / w->speed;
}

static void put_path(struct scene *s, const struct tow *w) {
    double start = start_time(w), way = WAY * w->d;
    for (int k = 0; k <= KNOTS; k++) {
        double t = (double)k / KNOTS;
        scene_put(s, "[%.9g, %.9g, 0, 0], ", settling + t * start, 0.25 * way * t * t);
    }
    scene_put(s, "[%.9g, %.9g, 0, 0]", end_time(w), way);
}

static pdyn_sim *load_tow(const struct job *job, struct tow *w, double contact) {
    char sheet[4096];
    static struct scene s;
    const int cells[3] = {WAY + WIDTH + 2 * BEFORE, WIDTH + 2 * BESIDE, WIDTH + 2 * BESIDE};
    for (int k = 0; k < 3; k++) w->cells[k] = cells[k], w->middle[k] = 0.5 * cells[k] * w->d;
    w->middle[0] = (BEFORE + WIDTH / 2) * w->d;
    sheet_write(job_file(job, "stream.obj", sheet), WIDTH, WIDTH, place, w);
    scene_start(&s, ordinary, contact);
    scene_water(&s, w->d, cells[1] * w->d, plain,
                "{'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, %.17g]}}",
                cells[0] * w->d, cells[1] * w->d, cells[2] * w->d);
    scene_sheet(&s, sheet, area_density);
    scene_put(&s, "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1e4}, {'type': "
                  "'pin', 'vertices': {'all': true}, 'path': [");
    put_path(&s, w);
    scene_put(&s, "]}]}");
    scene_tank(&s, cells[0] * w->d, (cells[1] + 15) * w->d, cells[2] * w->d);
    return scene_load(job, &s);
}

/* Mean force, N; prints a row. */
static double run(const struct job *job, FILE *csv, struct tow *w, double contact) {
    pdyn_sim *sim = load_tow(job, w, contact);
    double area = body_area(sim, 1), end = end_time(w), steps = 0.0, unsolved = 0.0, ms = 0.0;
    const char *how = w->broadside ? "broadside" : "edge-on";
    struct sample force = {0};
    while (pdyn_time(sim) < end - 1e-9) {
        pdyn_step_info info = take_step(sim);
        fprintf(csv, "%s,%g,%.6g,%.6g,%.4g\n", how, w->speed, info.time - settling,
                info.pin_reaction[0], info.step_residual);
        steps++, unsolved += info.step_residual > job->tolerance, ms += info.ms_cpu;
        if (info.time > end - 0.5 * WAY * w->d / w->speed && info.time <= end)
            sample_add(&force, info.h, info.pin_reaction[0]);
    }
    double mean = sample_mean(&force);
    printf("| %s | %g | %.2f | %.2f | %.2f | %.0f %% | %.1f |\n", how, w->speed, mean,
           sample_deviation(&force), mean / (0.5 * density * w->speed * w->speed * area),
           100.0 * unsolved / steps, ms / steps);
    fflush(stdout);
    pdyn_free(sim);
    return mean;
}

static void print_exponent(const double speed[], const double force[], int count) {
    struct regression r = {.terms = 2};
    double c[TERMS];
    for (int k = 0; k < count; k++)
        regression_add(&r, 1.0, (double[]){1.0, log(speed[k])}, log(fmax(force[k], 1e-9)));
    if (count < 2) return;
    regression_solve(&r, c);
    printf("\nBroadside force: speed to the power of %.2f.\n", c[1]);
}

/* MM CONTACT_MM SPEED... */
void stream(const struct job *job) {
    enum { SPEEDS = 16 };
    double d = 1e-3 * job_number(job, 0, 20.0), contact = 1e-3 * job_number(job, 1, 0.0);
    double speed[SPEEDS], force[2][SPEEDS];
    int count = job->count - 2;
    FILE *csv = open_csv(job->directory, "stream");
    if (count > SPEEDS) die("too many speeds");
    fprintf(csv, "direction,speed_m_s,time_s,force_N,residual\n");
    printf("| direction | speed, m/s | force, N | standard deviation, N | over rho v^2 A / 2 | "
           "unsolved | ms a step |\n|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < count; k++) {
        speed[k] = job_number(job, 2 + k, 1.0);
        for (int way = 0; way < 2; way++) {
            struct tow w = {.broadside = way, .d = d, .speed = speed[k]};
            force[way][k] = run(job, csv, &w, contact);
        }
    }
    printf("\nEdge-on over broadside force:");
    for (int k = 0; k < count; k++)
        printf(" %.3f at %g m/s%s", force[0][k] / force[1][k], speed[k],
               k + 1 < count ? "," : ".\n");
    print_exponent(speed, force[1], count);
    fclose(csv);
}
