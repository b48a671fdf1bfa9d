/* Solvers compared on coupled scenes. One simulation per solver; they take steps in turn, all to
 * the same residual. `solvers`: water in the middle of a sheet pinned along its border; `sizes`: a
 * scene with particles of other sizes. */
#include "coupling.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

enum { SOLVERS = 3 };

static const char *const solver[SOLVERS] = {"cg", "hybrid", "cholesky"};

/* 1 m x 1 m, 0.3 kg/m^2; water 0.4 m x 0.4 m, 0.04 m deep, of particles 20 mm apart. */
static const char scene[] =
    "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'integrator': 'euler', 'fixed': "
    "0.01}, 'solver': {%s,"
    " 'tolerance': 0.1, 'linear_tolerance': 0.1}, 'bodies': [{'name': 'water', 'particles':"
    " {'radius': 0.01, 'fill': [{'box': {'minimum': [-0.2, 0.012, -0.2], 'maximum': [0.2, 0.052,"
    " 0.2]}}]}, 'constraints': [{'type': 'fluid', 'stiffness': 3500}]}, {'name': 'sheet', "
    "'surface': {'grid': {'size': [1, 1], 'vertices': [%d, %d]},"
    " 'area_density': 0.3}, 'constraints': [{'type': 'spring', 'stretching_stiffness': %g},"
    " {'type': 'bending', 'bending_rigidity': 1e-4}, {'type': 'pin', 'vertices': {'border':"
    " true}}]}]}";

struct course {
    const char *file; /* NULL: the scene above */
    int n;            /* vertices along an edge of the sheet */
    double value;     /* stretching stiffness, N/m; with a file: particle radius, mm */
    double from;      /* s: measurements start here */
    int steps;
};

struct contestant {
    pdyn_sim *sim;
    double ms, linear, outer, residual, bytes;
};

static double bytes_in_use(void) {
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

/* For the projective step, limited to 20 iterations. */
static bool is_direct(const char *name) { return !strcmp(name, "cholesky"); }

static pdyn_sim *load_sheet(pdyn_context *context, const struct course *course, const char *name) {
    char settings[128];
    snprintf(settings, sizeof settings, "'type': '%s', %s", name,
             is_direct(name) ? "'step': 'projective', 'outer_iterations': 20"
                             : "'outer_iterations': 100");
    return load(context, scene, settings, course->n, course->n, course->value);
}

/* Sets the same stiffness for each particle size: with `compression` it would fall with the
 * spacing. */
static const char stiffness[] =
    "bodies.water.constraints.fluid={\"type\": \"fluid\", \"stiffness\": 1e4, \"viscosity\": 0.2}";

static pdyn_sim *load_file(pdyn_context *context, const struct course *course, const char *name) {
    char radius[64], type[32];
    const char *set[] = {radius, type, stiffness, "solver.step=projective",
                         "solver.outer_iterations=20"};
    pdyn_sim *sim;
    snprintf(radius, sizeof radius, "bodies.water.particles.radius=%g", 1e-3 * course->value);
    snprintf(type, sizeof type, "solver.type=%s", name);
    if (pdyn_load(context, course->file, set, is_direct(name) ? 5 : 3, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    if (pdyn_get_state(sim).bodies < 2) die("%s: expected water and a sheet", course->file);
    return sim;
}

static struct contestant enter(pdyn_context *context, const struct course *course,
                               const char *name) {
    struct contestant c = {0};
    double before = bytes_in_use();
    c.sim = (course->file ? load_file : load_sheet)(context, course, name);
    while (pdyn_time(c.sim) < course->from) take_step(context, c.sim);
    c.bytes = bytes_in_use() - before;
    return c;
}

static void measure(pdyn_context *context, struct contestant *c, int steps) {
    pdyn_step_info info = take_step(context, c->sim);
    c->ms += info.ms_cpu / steps;
    c->linear += (double)info.linear_iterations / steps;
    c->outer += (double)info.outer_iterations / steps;
    c->residual = info.step_residual > c->residual ? info.step_residual : c->residual;
}

static FILE *begin(const char *directory, const char *name, const char *value) {
    FILE *csv = open_csv(directory, name);
    fprintf(csv, "particles,vertices,%s,solver,ms,linear,outer,residual,megabytes\n", value);
    printf("| particles | vertices | %s | solver | ms a step | over cg's | linear iterations | "
           "outer | largest residual | MB |\n|---|---|---|---|---|---|---|---|---|---|\n",
           value);
    return csv;
}

static void print(FILE *csv, const struct course *course, const char *name,
                  const struct contestant *c, double ms) {
    int particles = pdyn_get_body(c->sim, 0).count, vertices = pdyn_get_body(c->sim, 1).count;
    fprintf(csv, "%d,%d,%g,%s,%.3f,%.2f,%.2f,%.3g,%.1f\n", particles, vertices, course->value, name,
            c->ms, c->linear, c->outer, c->residual, 1e-6 * c->bytes);
    printf("| %d | %d | %g | %s | %.1f | %.2f | %.1f | %.1f | %.2g | %.0f |\n", particles, vertices,
           course->value, name, c->ms, c->ms / ms, c->linear, c->outer, c->residual,
           1e-6 * c->bytes);
    fflush(stdout);
}

static void compare(pdyn_context *context, FILE *csv, const struct course *course) {
    struct contestant c[SOLVERS];
    for (int k = 0; k < SOLVERS; k++) c[k] = enter(context, course, solver[k]);
    for (int s = 0; s < course->steps; s++)
        for (int k = 0; k < SOLVERS; k++) measure(context, &c[k], course->steps);
    for (int k = 0; k < SOLVERS; k++) {
        print(csv, course, solver[k], &c[k], c[0].ms);
        pdyn_free(c[k].sim);
    }
}

static void read_run(const char *run, const char *format, double *first, double *second,
                     int *steps) {
    char rest;
    if (sscanf(run, "%lfx%lfx%d%c", first, second, steps, &rest) != 3 || *steps < 1)
        die("%s: expected %s", run, format);
}

void solvers(pdyn_context *context, const char *directory, int count, char **runs) {
    FILE *csv = begin(directory, "solvers", "K (N/m)");
    for (int k = 0; k < count; k++) {
        struct course course = {.from = 0.075}; /* eight steps */
        double n;
        read_run(runs[k], "NxKxSTEPS", &n, &course.value, &course.steps);
        course.n = (int)n;
        compare(context, csv, &course);
    }
    fclose(csv);
}

void sizes(pdyn_context *context, const char *directory, const char *file, int count, char **runs) {
    FILE *csv = begin(directory, "sizes", "radius (mm)");
    for (int k = 0; k < count; k++) {
        struct course course = {.file = file};
        read_run(runs[k], "MMxSECONDSxSTEPS", &course.value, &course.from, &course.steps);
        compare(context, csv, &course);
    }
    fclose(csv);
}
