/* The water that a rigid sheet takes along when it moves normal to itself. All vertices are pinned
 * and go up and down by A/2 (1 - cos omega t); what the pins carry beyond the sheet's own weight
 * and inertia is fitted by
 *
 *     c0 + c1 velocity + c2 acceleration,   c2: added mass
 *
 * A strip of half width a: pi rho a^2 per length in wide water, 32.97 kg/m for a = 0.1 m in a
 * channel 0.6 m wide; a disc: 8/3 rho a^3. */
#include "interface.h"

#include <math.h>
#include <string.h>

static const double a = 0.1, channel = 0.6; /* m: half width; width, depth */
static const double exact_strip = 32.97;    /* kg/m, in the channel */
static const double height = 0.01, period = 0.32, longest = 0.004, rest = 0.9; /* m, s, s */
static const double area_density = 0.1, pi = 3.14159265358979;                 /* kg/m^2 */
static const double gap = 0.1;                 /* spacings, beyond half of one */
enum { SLICE = 6 };                            /* spacings along the strip */
enum { KNOTS = 640, PERIODS = 2, FITTED = 3 }; /* of the path in a period; terms of the fit */

struct moved {
    bool disc;
    double d, middle[3]; /* m */
    int cells[3];        /* of the water */
};

static void place(const void *user, double s, double t, double x[3]) {
    const struct moved *m = user;
    double u = 2.0 * s - 1.0, v = 2.0 * t - 1.0, radius = hypot(u, v);
    double round = radius > 0.0 ? fmax(fabs(u), fabs(v)) / radius : 0.0;
    x[0] = m->middle[0] + a * u * (m->disc ? round : 1.0);
    x[1] = m->middle[1];
    x[2] = m->middle[2] + (m->disc ? a * v * round : (0.5 * SLICE - 0.05) * m->d * v);
}

/* Water above the sheet starts a little higher, so that the sheet does not throw it up. */
static bool keep(const void *user, double x[3]) {
    const struct moved *m = user;
    if (x[1] > m->middle[1]) x[1] += 2.0 * gap * m->d;
    return true;
}

/* Displacement, velocity and acceleration of the pins. */
static void motion(double time, double out[3]) {
    double omega = 2.0 * pi / period, t = fmax(0.0, time - rest);
    out[0] = 0.5 * height * (1.0 - cos(omega * t));
    out[1] = 0.5 * height * omega * sin(omega * t);
    out[2] = time < rest ? 0.0 : 0.5 * height * omega * omega * cos(omega * t);
}

static pdyn_sim *load_moved(const struct job *job, struct moved *m, double contact) {
    char water[4096], sheet[4096], step[64];
    static struct scene s;
    int wide = 2 * (int)floor(0.5 * channel / m->d + 0.5), n = (int)ceil(2.0 * a / m->d);
    m->cells[0] = m->cells[1] = wide, m->cells[2] = m->disc ? wide : SLICE;
    for (int k = 0; k < 3; k++) m->middle[k] = 0.5 * m->cells[k] * m->d;
    m->middle[1] += gap * m->d, n += n % 2;
    lattice_write(job_file(job, "added_mass.ply", water), m->d, m->cells, keep, m);
    sheet_write(job_file(job, "added_mass.obj", sheet), n, m->disc ? n : SLICE, place, m);
    snprintf(step, sizeof step, "'maximum': %.17g, 'cfl': 1", longest);
    scene_start(&s, step, contact);
    scene_water(&s, m->d, channel, plain, "{'file': '%s'}", water);
    scene_sheet(&s, sheet, area_density);
    scene_put(&s, "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1e4}, {'type': "
                  "'pin', 'vertices': {'all': true}, 'path': [[0, 0, 0, 0]");
    for (int k = 0; k <= KNOTS * PERIODS; k++) {
        double y[3], time = rest + k * period / KNOTS;
        motion(time, y);
        scene_put(&s, ", [%.9g, 0, %.9g, 0]", time, y[0]);
    }
    scene_put(&s, "]}]}");
    scene_tank(&s, m->cells[0] * m->d, (m->cells[1] + 10) * m->d, m->cells[2] * m->d);
    return scene_load(job, &s);
}

/* Moves the sheet; fits the force minus weight and inertia by 1, velocity and acceleration,
 * weighted by the steps. Returns the RMS error of the fit, N. */
static double fit(FILE *csv, const struct moved *m, pdyn_sim *sim, double c[TERMS]) {
    double mass = body_weight(sim, 1) / g, duration = 0.0, squares = 0.0;
    struct regression r = {.terms = FITTED};
    while (pdyn_time(sim) < rest + PERIODS * period) {
        double y[3];
        pdyn_step_info info = take_step(sim);
        motion(info.time, y);
        double f = info.pin_reaction[1] - mass * (g + y[2]);
        fprintf(csv, "%s,%g,%.6g,%.6g,%.6g,%.6g,%.6g,%.4g\n", m->disc ? "disc" : "strip",
                1e3 * m->d, info.time, f, y[0], y[1], y[2], info.step_residual);
        if (info.time < rest + 1e-9) continue;
        regression_add(&r, info.h, (double[]){1.0, y[1], y[2]}, f);
        duration += info.h, squares += info.h * f * f;
    }
    struct regression sums = r;
    regression_solve(&r, c);
    for (int k = 0; k < FITTED; k++) squares -= c[k] * sums.right[k];
    return sqrt(fmax(0.0, squares) / duration);
}

static void run(const struct job *job, FILE *csv, struct moved *m, double contact) {
    pdyn_sim *sim = load_moved(job, m, contact);
    double c[TERMS], scatter = fit(csv, m, sim, c);
    double exact = m->disc ? 8.0 / 3.0 * density * a * a * a : exact_strip;
    double found = m->disc ? c[2] : c[2] / (SLICE * m->d);
    printf("| %s | %g | %d | %.3f %s | %.3f | %+.1f %% | %.1f | %.2f |\n",
           m->disc ? "disc" : "strip", 1e3 * m->d, pdyn_get_body(sim, 0).count, found,
           m->disc ? "kg" : "kg/m", exact, 100.0 * (found / exact - 1.0), c[1], scatter);
    fflush(stdout);
    pdyn_free(sim);
}

/* CONTACT_MM SHAPE:MM... */
void added_mass(const struct job *job) {
    double contact = 1e-3 * job_number(job, 0, 0.0);
    FILE *csv = open_csv(job->directory, "added_mass");
    fprintf(csv, "shape,spacing_mm,time_s,force_N,displacement_m,velocity_m_s,acceleration_m_s2,"
                 "residual\n");
    printf("| sheet | d, mm | particles | added mass | exact | deviation | force over velocity, N "
           "s/m | scatter of the force, N |\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 1; k < job->count; k++) {
        char name[8];
        double mm;
        if (sscanf(job->argument[k], "%7[a-z]:%lf", name, &mm) != 2 ||
            (strcmp(name, "strip") && strcmp(name, "disc")))
            die("expected strip:MM or disc:MM, found %s", job->argument[k]);
        struct moved m = {.disc = !strcmp(name, "disc"), .d = 1e-3 * mm};
        run(job, csv, &m, contact);
    }
    fclose(csv);
}
