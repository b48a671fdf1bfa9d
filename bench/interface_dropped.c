/* A cloth is dropped flat on water: its height over the surface in time, and the fraction of it
 * under water. One that water does not pass floats, if it is light; one of the permeability k sinks
 * with k times its weight per area. */
#include "interface.h"

#include <math.h>

enum { BESIDE = 6, DEPTH = 12, FALL = 5, ROWS = 8 }; /* spacings; rows of the table */

struct drop {
    double d, width;                   /* m */
    double area_density, permeability; /* kg/m^2, m/(Pa s) */
    double middle[3];                  /* m, of the cloth at the start */
    int cells[3];                      /* of the water */
};

static void place(const void *user, double s, double t, double x[3]) {
    const struct drop *p = user;
    x[0] = p->middle[0] + (s - 0.5) * p->width;
    x[1] = p->middle[1];
    x[2] = p->middle[2] + (t - 0.5) * p->width;
}

static pdyn_sim *load_drop(const struct job *job, struct drop *p, double contact) {
    char sheet[4096];
    static struct scene s;
    int n = (int)floor(p->width / p->d + 0.5), *cells = p->cells;
    cells[0] = cells[2] = n + 2 * BESIDE, cells[1] = DEPTH;
    for (int k = 0; k < 3; k++) p->middle[k] = 0.5 * cells[k] * p->d;
    p->middle[1] = (DEPTH + FALL) * p->d;
    sheet_write(job_file(job, "dropped.obj", sheet), n, n, place, p);
    scene_start(&s, ordinary, contact);
    scene_water(&s, p->d, DEPTH * p->d, plain,
                "{'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, %.17g]}}",
                cells[0] * p->d, cells[1] * p->d, cells[2] * p->d);
    scene_permeable(&s, sheet, p->area_density, p->permeability);
    scene_put(&s, "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1e4}, {'type': "
                  "'bending', 'bending_rigidity': 1e-4}]}");
    scene_tank(&s, cells[0] * p->d, (DEPTH + 10) * p->d, cells[2] * p->d);
    return scene_load(job, &s);
}

/* True if a particle lies above a point: within a spacing of its vertical, at most three higher. */
static bool covered(const pdyn_state *s, const pdyn_body_info *water, const double x[3]) {
    double d = 2.0 * water->radius;
    for (int i = water->first; i < water->first + water->count; i++) {
        const double *p = s->x + 3 * i;
        double up = p[1] - x[1];
        if (s->live && !s->live[i]) continue;
        if (up > 0.0 && up < 3.0 * d && hypot(p[0] - x[0], p[2] - x[2]) < d) return true;
    }
    return false;
}

/* Fraction of the cloth's vertices with water above. */
static double wet(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info water = pdyn_get_body(sim, 0), cloth = pdyn_get_body(sim, 1);
    int count = 0;
    for (int i = cloth.first; i < cloth.first + cloth.count; i++)
        count += covered(&s, &water, s.x + 3 * i);
    return (double)count / cloth.count;
}

static void run(const struct job *job, FILE *csv, struct drop *p, double seconds, double contact) {
    pdyn_sim *sim = load_drop(job, p, contact);
    double x[3], outer = (0.5 * p->cells[0] - 1.5) * p->d, inner = 0.5 * p->width + 2.0 * p->d;
    const struct frame frame = {.middle = {p->middle[0], p->middle[2]},
                                .outer = {outer, outer},
                                .inner = {inner, inner},
                                .low = (DEPTH - 3) * p->d};
    double unsolved = 0.0, steps = 0.0, ms = 0.0;
    for (int row = 1; row <= ROWS;) {
        pdyn_step_info info = take_step(sim);
        body_middle(sim, 1, x);
        double above = (x[1] - surface_height(sim, &frame)) / p->d;
        fprintf(csv, "%g,%g,%.6g,%.6g,%.4g\n", p->area_density, p->permeability, info.time, above,
                info.step_residual);
        steps++, unsolved += info.step_residual > job->tolerance, ms += info.ms_cpu;
        if (info.time < row * seconds / ROWS - 1e-9) continue;
        printf("| %g | %g | %g | %g | %.2f | %+.2f | %.0f %% | %.0f %% | %.1f |\n", p->area_density,
               p->permeability, 1e3 * p->d, 1e3 * contact, info.time, above, 100.0 * wet(sim),
               100.0 * unsolved / steps, ms / steps);
        fflush(stdout);
        row++;
    }
    pdyn_free(sim);
}

/* SECONDS MM WIDTH CONTACT_MM, then KG PERMEABILITY of each cloth */
void dropped(const struct job *job) {
    double seconds = job_number(job, 0, 2.0), d = 1e-3 * job_number(job, 1, 20.0);
    double width = job_number(job, 2, 12.0), contact = 1e-3 * job_number(job, 3, 3.0);
    FILE *csv = open_csv(job->directory, "dropped");
    fprintf(csv, "kg_m2,permeability,time_s,above_surface_d,residual\n");
    printf("| kg/m^2 | permeability, m/(Pa s) | d, mm | contact, mm | time, s | above the surface, "
           "d | water above | "
           "unsolved | ms a step |\n|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 4; k < job->count; k += 2) {
        struct drop p = {.d = d,
                         .width = width * d,
                         .area_density = job_number(job, k, 0.3),
                         .permeability = job_number(job, k + 1, 0.0)};
        run(job, csv, &p, seconds, contact);
    }
    fclose(csv);
}
