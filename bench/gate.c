/* Elastic gate (Antoci, Gallati, Sibilla 2007): a rubber plate in the wall of a tank bends and lets
 * the water out. The plate is a sheet with the plate's mass and bending rigidity, clamped by two
 * rows of pins (the clamp lies in their middle), in a slice a few particles wide. */
#include "coupling.h"

#include <math.h>

static const double gate = 0.079, thickness = 0.005, gate_density = 1100; /* m, m, kg/m^3 */
static const double width = 0.1, depth = 0.14;                            /* m, of the water */

/* Measured horizontal displacement of the tip, s and m. */
static const double experiment[][2] = {{0.040, 0.0125}, {0.080, 0.0340}, {0.119, 0.0440},
                                       {0.161, 0.0464}, {0.200, 0.0442}, {0.240, 0.0430},
                                       {0.281, 0.0412}, {0.321, 0.0400}, {0.360, 0.0374}};
enum {
    POINTS = sizeof experiment / sizeof *experiment,
    ACROSS = 6 /* segments of a plane across the slice */
};

struct trial {
    double d, modulus, h; /* spacing of particles, m; modulus of the rubber, Pa; step, s */
    char integrator[8];
};

struct mesh {
    double x, z, low, high; /* m: of the plane; how far it goes beyond the slice; heights */
    int up;                 /* segments */
};

/* Rows from the lowest to the highest. */
static void write_plane(const char *path, const struct mesh *m, double slice) {
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    for (int i = 0; i <= m->up; i++)
        for (int j = 0; j <= ACROSS; j++)
            fprintf(file, "v %.17g %.17g %.17g\n", m->x, m->low + (m->high - m->low) * i / m->up,
                    (slice + 2.0 * m->z) * j / ACROSS - m->z);
    write_triangles(file, m->up, ACROSS);
    fclose(file);
}

static const char scene[] =
    "{'duration': 1000, 'frame_interval': 0.02, 'time_step': {'integrator': '%s', 'maximum': "
    "%g}, 'solver': "
    "{'tolerance': 0.1, 'outer_iterations': 40}, 'bodies': [{'name': 'water', 'particles': "
    "{'radius': %.17g, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [%g, %g, %.17g]}}]}, "
    "'constraints': [{'type': 'fluid', 'stiffness': %.17g}]}, {'name': 'gate', 'surface': {'mesh': "
    "'%s', 'area_density': %g}, 'constraints': [{'type': 'triangle', 'stretching_stiffness': %g}, "
    "{'type': 'bending', 'bending_rigidity': %g}, {'type': 'pin', 'stiffness': 1e7, 'vertices': "
    "[{'box': {'minimum': [-1, %.17g, -1], 'maximum': [1, 1, 1]}}]}]}], 'solids': [{'box': "
    "{'minimum': [0, 0, 0], 'maximum': [0.3, 0.2, %.17g]}, 'open': ['+x', '+y']}, {'mesh': '%s'}]}";

/* The sheet and the wall above it lie where the water ends. */
static pdyn_sim *load_gate(pdyn_context *context, const char *directory, const struct trial *t) {
    char sheet[4096], wall[4096];
    double d = t->d;
    int up = (int)(gate / d + 0.5);
    double ds = gate / (up + 0.5), slice = 4.0 * d;
    struct mesh m = {width, d, 0.0, gate + 0.5 * ds, up + 1};
    snprintf(sheet, sizeof sheet, "%s/gate.obj", directory);
    snprintf(wall, sizeof wall, "%s/gate_wall.obj", directory);
    write_plane(sheet, &m, slice);
    m.low = gate, m.high = 0.2;
    write_plane(wall, &m, slice);
    double pressure = density * g * depth;
    double share = slice / (slice + 2.0 * d); /* width of the plate over the sheet's */
    double rigidity =
        share * t->modulus * thickness * thickness * thickness / (12.0 * (1.0 - 0.4 * 0.4));
    return load_text(context, scene, t->integrator, t->h, 0.5 * d, width, depth, slice,
                     0.45 * pressure * d / 1e-3, sheet, share * gate_density * thickness,
                     share * t->modulus * thickness, rigidity, gate - 0.6 * ds, slice, wall);
}

/* Mean x of the lowest row, m. */
static double tip(const pdyn_sim *sim) {
    const double *x = pdyn_get_state(sim).x + 3 * pdyn_get_body(sim, 1).first;
    double sum = 0.0;
    for (int j = 0; j <= ACROSS; j++) sum += x[3 * j] / (ACROSS + 1);
    return sum;
}

/* Displacements at the times of the experiment, and the largest displacement, m. */
static double run(pdyn_context *context, const char *directory, FILE *csv, const struct trial *t,
                  double *at) {
    int k = 0;
    pdyn_sim *sim = load_gate(context, directory, t);
    double start = tip(sim), before = 0.0, time = 0.0, most = 0.0;
    while (k < POINTS) {
        double now = pdyn_time(sim), x = tip(sim) - start;
        for (; k < POINTS && now >= experiment[k][0]; k++)
            at[k] = before + (x - before) * (experiment[k][0] - time) / (now - time);
        fprintf(csv, "%g,%g,%g,%g,%g,%s\n", t->d, t->modulus, t->h, now, x, t->integrator);
        most = fmax(most, x), before = x, time = now;
        take_step(sim);
    }
    pdyn_free(sim);
    return most;
}

void elastic_gate(pdyn_context *context, const char *directory, int count, char **runs) {
    FILE *csv = open_csv(directory, "gate");
    fprintf(csv, "spacing,modulus,h,time,tip,integrator\n");
    printf("| integrator | spacing, mm | E, MPa | h, ms |");
    for (int k = 0; k < POINTS; k++) printf(" %g s |", experiment[k][0]);
    printf(" peak |\n|---|---|---|---|");
    for (int k = 0; k <= POINTS; k++) printf("---|");
    printf("\n| | experiment | | |");
    for (int k = 0; k < POINTS; k++) printf(" %.1f |", 1e3 * experiment[k][1]);
    printf(" 46.4 |\n");
    for (int r = 0; r < count; r++) {
        double mm, mpa, ms, at[POINTS];
        struct trial t = {.integrator = "euler"};
        if (sscanf(runs[r], "%lfx%lfx%lf:%7s", &mm, &mpa, &ms, t.integrator) < 3)
            die("expected MMxMPAxMS or MMxMPAxMS:INTEGRATOR, found %s", runs[r]);
        t.d = 1e-3 * mm, t.modulus = 1e6 * mpa, t.h = 1e-3 * ms;
        double most = run(context, directory, csv, &t, at);
        printf("| %s | %g | %g | %g |", t.integrator, mm, mpa, ms);
        for (int k = 0; k < POINTS; k++) printf(" %.1f |", 1e3 * at[k]);
        printf(" %.1f (%+.0f %%) |\n", 1e3 * most, 100.0 * (most / 0.0464 - 1.0));
        fflush(stdout);
    }
    fclose(csv);
}
