/* A level free sheet under water: its drift, unsolved steps and the cost of a step. It starts
 * between two layers of the particle lattice, in the cavity of a layer, or in water that settled
 * around it while it was held. */
#include "interface.h"

#include <math.h>
#include <string.h>

enum { BESIDE = 4, HALF_DEPTH = 8 }; /* spacings of water around the sheet */

struct free_sheet {
    const char *start;             /* "between", "cavity", "settled" */
    double d, width, area_density; /* m, m, kg/m^2 */
    double middle[3];              /* m, at the start */
    int cells[3];                  /* of the water */
};

static void place(const void *user, double s, double t, double x[3]) {
    const struct free_sheet *f = user;
    x[0] = f->middle[0] + (s - 0.5) * f->width;
    x[1] = f->middle[1];
    x[2] = f->middle[2] + (t - 0.5) * f->width;
}

/* Keeps lattice points half a spacing from the sheet. */
static bool keep(const void *user, double x[3]) {
    const struct free_sheet *f = user;
    double half = 0.5 * f->width;
    return fabs(x[1] - f->middle[1]) > 0.499 * f->d || fabs(x[0] - f->middle[0]) > half ||
           fabs(x[2] - f->middle[2]) > half;
}

/* With the particles of free.ply. */
static pdyn_sim *load(const struct job *job, const struct free_sheet *f, double contact,
                      double viscosity, const char *pin) {
    char water[4096], sheet[4096];
    static struct scene s;
    int n = (int)floor(f->width / f->d + 0.5);
    snprintf(water, sizeof water, "%s/free.ply", job->directory);
    sheet_write(job_file(job, "free.obj", sheet), n, n, place, f);
    scene_start(&s, ordinary, contact);
    scene_water(&s, f->d, f->cells[1] * f->d, viscosity, "{'file': '%s'}", water);
    scene_sheet(&s, sheet, f->area_density);
    scene_put(&s,
              "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1e4}, {'type': "
              "'bending', 'bending_rigidity': 1e-4}%s]}",
              pin);
    scene_tank(&s, f->cells[0] * f->d, (f->cells[1] + 10) * f->d, f->cells[2] * f->d);
    return scene_load(job, &s);
}

static pdyn_sim *load_free(const struct job *job, const struct free_sheet *f, double contact) {
    const double rest = 1.5; /* time until the water is at rest, s */
    char water[4096];
    lattice_write(job_file(job, "free.ply", water), f->d, f->cells, keep, f);
    if (strcmp(f->start, "settled")) return load(job, f, contact, plain, "");
    pdyn_sim *sim = load(job, f, contact, calming, ", {'type': 'pin', 'vertices': {'all': true}}");
    while (pdyn_time(sim) < rest) take_step(sim);
    const pdyn_body_info body = pdyn_get_body(sim, 0);
    particles_write(job_file(job, "free.ply", water), body.count,
                    pdyn_get_state(sim).x + 3 * body.first);
    pdyn_free(sim);
    return load(job, f, contact, plain, "");
}

static void run(const struct job *job, FILE *csv, const struct free_sheet *f, double seconds,
                double contact) {
    pdyn_sim *sim = load_free(job, f, contact);
    double steps = 0.0, unsolved = 0.0, outer = 0.0, linear = 0.0, ms = 0.0, farthest = 0.0;
    double first[3], now[3], drift = 0.0;
    body_middle(sim, 1, first);
    while (pdyn_time(sim) < seconds) {
        pdyn_step_info info = take_step(sim);
        body_middle(sim, 1, now);
        drift = (now[1] - first[1]) / f->d;
        farthest = fabs(drift) > fabs(farthest) ? drift : farthest;
        steps++, unsolved += info.step_residual > job->tolerance;
        outer += info.outer_iterations, linear += info.linear_iterations, ms += info.ms_cpu;
        fprintf(csv, "%s,%g,%g,%.6g,%.6g,%.4g,%d,%d,%.3f\n", f->start, 1e3 * f->d, f->area_density,
                info.time, drift, info.step_residual, info.outer_iterations, info.linear_iterations,
                info.ms_cpu);
    }
    printf("| %s | %g | %g | %g | %+.2f | %+.2f | %.0f | %.0f %% | %.1f | %.0f | %.1f |\n",
           f->start, 1e3 * f->d, f->area_density, 1e3 * contact, drift, farthest, steps,
           100.0 * unsolved / steps, outer / steps, linear / steps, ms / steps);
    fflush(stdout);
    pdyn_free(sim);
}

/* SECONDS WIDTH CONTACT_MM PLACE:MM:KG... */
void free_sheets(const struct job *job) {
    double seconds = job_number(job, 0, 1.0), width = job_number(job, 1, 12.0);
    double contact = 1e-3 * job_number(job, 2, 0.0);
    FILE *csv = open_csv(job->directory, "free");
    fprintf(csv, "place,spacing_mm,kg_m2,time_s,drift_d,residual,outer,linear,ms\n");
    printf("| start | d, mm | kg/m^2 | contact, mm | drift, d | largest, d | steps | unsolved | "
           "outer | linear | ms a step |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 3; k < job->count; k++) {
        char name[16];
        double mm;
        struct free_sheet f = {.cells = {(int)width + 2 * BESIDE, 2 * HALF_DEPTH, 0}};
        if (sscanf(job->argument[k], "%15[a-z]:%lf:%lf", name, &mm, &f.area_density) != 3 ||
            (strcmp(name, "between") && strcmp(name, "cavity") && strcmp(name, "settled")))
            die("expected between, cavity or settled with :MM:KG, found %s", job->argument[k]);
        f.start = name;
        f.cells[1] += !strcmp(name, "cavity"), f.cells[2] = f.cells[0];
        f.d = 1e-3 * mm, f.width = width * f.d;
        for (int a = 0; a < 3; a++) f.middle[a] = 0.5 * f.cells[a] * f.d;
        run(job, csv, &f, seconds, contact);
    }
    fclose(csv);
}
