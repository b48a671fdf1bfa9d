/* How exactly the gas in a closed surface obeys its law. Each command writes files into DIRECTORY
 * and prints rows of a table as markdown:
 *
 *     gas compress DIRECTORY CELLS
 *         a ball between two plates that approach each other: p V^gamma
 *     gas tension DIRECTORY CELLS PASCAL...
 *         an elastic ball at an overpressure: 2 tension / radius
 *     gas float DIRECTORY SECONDS MM KG...
 *         a ball of KG on water of particle spacing MM: its draught
 *     gas cost DIRECTORY CELLS
 *         time of a step of a ball with and without gas
 *
 * CELLS: a ball has 6 CELLS^2 + 2 vertices. */
#include "interface.h"

#include "projdyn/control.h"
#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double pi = 3.14159265358979;

double job_number(const struct job *job, int argument, double otherwise) {
    return argument < job->count ? strtod(job->argument[argument], NULL) : otherwise;
}

/* ---- a ball ---------------------------------------------------------------------------------- */

/* Writes a body with a sphere as surface, up to its constraints. */
static void put_ball(const struct job *job, struct scene *s, int cells, double radius,
                     double height, double area_density) {
    char mesh[4096];
    sphere_write(job_file(job, "ball.obj", mesh), cells, radius);
    scene_put(s,
              "{'name': 'ball', 'surface': {'mesh': '%s', 'area_density': %.17g, 'translate': [0, "
              "%.17g, 0]}, 'constraints': [",
              mesh, area_density, height);
}

/* Pressure of the gas above that outside, Pa: its forces f are p grad V. */
static double overpressure(const pdyn_sim *sim, int body, int constraint) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    double *f = calloc(3 * (size_t)s.particles, sizeof *f), along = 0.0, squares = 0.0;
    double *n = calloc(3 * (size_t)s.particles, sizeof *n);
    if (!f || !n) die("out of memory");
    if (pdyn_constraint_forces(sim, constraint, f) != PDYN_OK) die("no such constraint");
    for (int t = 0; t < b.triangles; t++) {
        const double *x[3];
        double normal[3];
        for (int k = 0; k < 3; k++) x[k] = s.x + 3 * (b.first + b.triangle[3 * t + k]);
        vec3_normal(normal, x[0], x[1], x[2]);
        for (int k = 0; k < 3; k++)
            vec3_add(n + 3 * (b.first + b.triangle[3 * t + k]), 1.0 / 6.0, normal);
    }
    for (int k = 0; k < 3 * s.particles; k++) along += f[k] * n[k], squares += n[k] * n[k];
    free(f), free(n);
    return along / squares;
}

/* ---- compress -------------------------------------------------------------------------------- */

static double energy_of(const pdyn_sim *sim, int constraint) {
    const pdyn_constraint_info info = pdyn_get_constraint(sim, constraint);
    double *value = calloc((size_t)info.elements, sizeof *value), sum = 0.0;
    if (!value) die("out of memory");
    pdyn_element_values(sim, constraint, value, NULL);
    for (int e = 0; e < info.elements; e++) sum += value[e];
    free(value);
    return sum;
}

static const double filling = 1000.0, exponent = 1.4; /* Pa, 1 */

/* In vacuum, so that the membrane carries the whole pressure. Weak pins at the equator keep the
 * ball from rolling out. */
static pdyn_sim *load_compress(const struct job *job, int cells, double radius, double seconds) {
    static struct scene s;
    scene_start(&s, "'maximum': 0.02, 'integrator': 'euler'", 0.0);
    scene_put(&s, "'contact': {'thickness': 0.002, 'friction': 0, 'stiffness': 1e4, 'self': false},"
                  " 'gravity': [0, 0, 0], 'solver': {'tolerance': 0.02, 'outer_iterations': 200}, "
                  "'bodies': [");
    put_ball(job, &s, cells, radius, 0.0, 0.3);
    scene_put(
        &s,
        "{'type': 'triangle', 'stretching_stiffness': 1e4, 'shortest': 0}, {'type': "
        "'gas', 'outside': 0, 'overpressure': %g}, {'type': 'pin', 'stiffness': 1, 'vertices': "
        "{'box': {'minimum': [-1, -0.001, -1], 'maximum': [1, 0.001, 1]}}}]}], 'solids': [",
        filling);
    for (int side = -1; side <= 1; side += 2)
        scene_put(&s,
                  "{'plane': {'center': [0, %.17g, 0], 'normal': [0, %d, 0], 'size': 2}, 'motion': "
                  "[{'time': 0}, {'time': %g, 'translate': [0, %.17g, 0]}]}%s",
                  side * (radius + 0.003), -side, seconds, -side * 0.6 * radius,
                  side < 0 ? ", " : "]}");
    return scene_load(job, &s);
}

struct squeezed {                                        /* a state of the ball */
    double apart, volume, pressure, force, work, stored; /* m, m^3, Pa, N, J, J */
};

static void squeeze(const pdyn_sim *sim, double apart, struct squeezed *now) {
    double force[2][3], moment[3];
    for (int k = 0; k < 2; k++) pdyn_solid_load(sim, k, force[k], moment);
    double push = 0.5 * (force[1][1] - force[0][1]);
    now->work += 0.5 * (push + now->force) * (now->apart - apart);
    now->apart = apart, now->force = push, now->volume = body_volume(sim, 0);
    now->pressure = overpressure(sim, 0, 1), now->stored = energy_of(sim, 0) + energy_of(sim, 2);
}

/* CELLS. The pressure on the plates is by virtual work between two rows: plates that approach each
 * other do the work F dz = dE - p dV, E the energy of the membrane and the pins. */
static void compress(const struct job *job) {
    double radius = 0.1, seconds = 20.0;
    int rows = 10;
    pdyn_sim *sim = load_compress(job, (int)job_number(job, 0, 12.0), radius, seconds);
    double first = filling * pow(body_volume(sim, 0), exponent), rest = body_volume(sim, 0);
    struct squeezed now = {.apart = 2.0 * (radius + 0.003)}, last = now;
    printf("| plates apart, R | V / V0 | force, N | p, Pa | p V^gamma | p by the plates, Pa | "
           "p V^gamma |\n|---|---|---|---|---|---|---|\n");
    for (int row = 0; row <= rows;) {
        double time = take_step(sim).time;
        squeeze(sim, 2.0 * (radius + 0.003) - 1.2 * radius * time / seconds, &now);
        if (time < row * seconds / rows - 1e-9) continue;
        if (row++ > 1) { /* the first contact has no share */
            double p =
                (now.work - last.work - now.stored + last.stored) / (last.volume - now.volume);
            printf("| %.3f | %.4f | %.1f | %.1f | %.5f | %.1f | %.4f |\n", now.apart / radius,
                   now.volume / rest, now.force, now.pressure,
                   now.pressure * pow(now.volume, exponent) / first, p,
                   p * pow(0.5 * (now.volume + last.volume), exponent) / first);
        }
        last = now;
    }
    pdyn_free(sim);
}

/* ---- tension --------------------------------------------------------------------------------- */

static void tension_one(const struct job *job, int cells, double pressure) {
    static struct scene s;
    double radius = 0.1, stiffness = 1000.0;
    scene_start(&s, "'maximum': 0.02, 'integrator': 'euler'", 0.0);
    scene_put(&s, "'gravity': [0, 0, 0], 'solver': {'tolerance': 1e-4, "
                  "'outer_iterations': 200}, 'bodies': [");
    put_ball(job, &s, cells, radius, 0.0, 0.3);
    scene_put(&s,
              "{'type': 'triangle', 'stretching_stiffness': %g, 'damping': 0.05}, {'type': 'gas', "
              "'overpressure': %g, 'gamma': 0}]}]}",
              stiffness, pressure);
    pdyn_sim *sim = scene_load(job, &s);
    double area = body_area(sim, 0), volume = body_volume(sim, 0);
    int steps = 0, iterations = 0;
    while (pdyn_time(sim) < 2.0) {
        pdyn_step_info info = take_step(sim);
        steps++, iterations += info.outer_iterations;
    }
    double stretch = sqrt(body_area(sim, 0) / area), v = body_volume(sim, 0);
    double r = cbrt(0.75 / pi * v), p = overpressure(sim, 0, 1);
    double laplace = 2.0 * stiffness * (stretch - 1.0) / stretch / r;
    printf("| %.1f | %d | %.4f | %.4f | %.1f | %+.2f %% | %.1f |\n", p, 6 * cells * cells + 2,
           stretch, v / volume, laplace, 100.0 * (p / laplace - 1.0), (double)iterations / steps);
    fflush(stdout);
    pdyn_free(sim);
}

/* CELLS PASCAL... */
static void tension(const struct job *job) {
    printf("| overpressure, Pa | vertices | stretch | V / V0 | 2 T / R, Pa | difference | outer "
           "iterations |\n|---|---|---|---|---|---|---|\n");
    for (int k = 1; k < job->count; k++)
        tension_one(job, (int)job_number(job, 0, 12.0), job_number(job, k, 0.0));
}

/* ---- float ----------------------------------------------------------------------------------- */

struct floater {
    double d, radius, mass, draught; /* m, m, kg, m */
    double middle[3];                /* m, at the start */
    int cells[3];                    /* of the water */
};

static bool keep(const void *user, double x[3]) {
    const struct floater *f = user;
    return vec3_distance(x, f->middle) > f->radius + 0.499 * f->d;
}

/* The height t of a spherical cap of a volume: pi t^2 (R - t / 3). */
static double cap_height(double radius, double volume) {
    double low = 0.0, high = 2.0 * radius;
    for (int k = 0; k < 60; k++) {
        double t = 0.5 * (low + high);
        *(pi * t * t * (radius - t / 3.0) < volume ? &low : &high) = t;
    }
    return low;
}

static pdyn_sim *load_floater(const struct job *job, struct floater *f) {
    static struct scene s;
    char water[4096], mesh[4096];
    int n = (int)(2.0 * f->radius / f->d + 0.5);
    f->cells[0] = f->cells[2] = 2 * n + 8, f->cells[1] = n + 4;
    f->middle[0] = f->middle[2] = 0.5 * f->cells[0] * f->d;
    f->draught = cap_height(f->radius, f->mass / density);
    f->middle[1] = f->cells[1] * f->d - 1.1 * f->draught + f->radius;
    lattice_write(job_file(job, "floating.ply", water), f->d, f->cells, keep, f);
    sphere_write(job_file(job, "ball.obj", mesh), (int)ceil(1.6 * f->radius / f->d), f->radius);
    scene_start(&s, ordinary, 0.0);
    scene_water(&s, f->d, f->cells[1] * f->d, plain, "{'file': '%s'}", water);
    scene_put(&s,
              ", {'name': 'ball', 'surface': {'mesh': '%s', 'area_density': %.17g, 'translate': "
              "[%.17g, %.17g, %.17g]}, 'constraints': [{'type': 'triangle', "
              "'stretching_stiffness': 2e4}, {'type': 'gas', 'overpressure': 2000}]}",
              mesh, f->mass / (4.0 * pi * f->radius * f->radius), f->middle[0], f->middle[1],
              f->middle[2]);
    scene_tank(&s, f->cells[0] * f->d, (f->cells[1] + n) * f->d, f->cells[2] * f->d);
    return scene_load(job, &s);
}

static void float_one(const struct job *job, double seconds, double d, double mass) {
    struct floater f = {.d = d, .radius = 0.12, .mass = mass};
    pdyn_sim *sim = load_floater(job, &f);
    double inner = 1.5 * f.radius, outer = (0.5 * f.cells[0] - 1.5) * d, real, low[3], high[3];
    struct frame frame = {.middle = {f.middle[0], f.middle[2]},
                          .outer = {outer, outer},
                          .inner = {inner, inner},
                          .low = (f.cells[1] - 3) * d};
    struct sample share = {0}, draught = {0}, volume = {0};
    struct ends ends;
    ends_find(&ends, sim, 1);
    real = body_weight(sim, 1) / g;
    while (pdyn_time(sim) < seconds) {
        pdyn_step_info info = take_step(sim);
        double level = surface_height(sim, &frame);
        body_ends(sim, &ends, low, high);
        if (info.time < 0.6 * seconds) continue;
        sample_add(&share, info.h, body_submerged(sim, 1, level) * body_volume(sim, 1));
        sample_add(&draught, info.h, level - low[1]);
        sample_add(&volume, info.h, body_volume(sim, 1));
    }
    double exact = cap_height(cbrt(0.75 / pi * sample_mean(&volume)), real / density);
    printf("| %g | %.3f | %.0f | %.3f | %+.1f %% | %.1f | %.1f | %+.1f %% |\n", 1e3 * d, real,
           2.0 * f.radius / d, density * sample_mean(&share),
           100.0 * (density * sample_mean(&share) / real - 1.0), 1e3 * sample_mean(&draught),
           1e3 * exact, 100.0 * (sample_mean(&draught) / exact - 1.0));
    fflush(stdout);
    ends_free(&ends);
    pdyn_free(sim);
}

/* SECONDS MM KG... */
static void floats(const struct job *job) {
    printf("| d, mm | mass, kg | diameter, d | water displaced, kg | difference | draught, mm | "
           "exact, mm | difference |\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 2; k < job->count; k++)
        float_one(job, job_number(job, 0, 3.0), 1e-3 * job_number(job, 1, 20.0),
                  job_number(job, k, 1.0));
}

/* ---- cost ------------------------------------------------------------------------------------ */

static double seconds_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

enum { STEPS = 20, WARM = 5 };

/* Makes an ellipsoid of the ball, of about its volume. */
static void stretch(pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    double *x = malloc(3 * (size_t)s.particles * sizeof *x);
    if (!x) die("out of memory");
    for (int k = 0; k < 3 * s.particles; k++) x[k] = (k % 3 == 1 ? 1.05 : 0.976) * s.x[k];
    if (pdyn_set_positions(sim, 0, s.particles, x) != PDYN_OK) die("positions");
    free(x);
}

/* Time of a step, s. */
static double cost_one(const struct job *job, int cells, bool gas, const char *effort, int *outer,
                       int *linear) {
    static struct scene s;
    scene_start(&s, "'fixed': 0.005", 0.0);
    scene_put(&s, "'gravity': [0, 0, 0], 'solver': {%s}, 'bodies': [", effort);
    put_ball(job, &s, cells, 0.5, 0.0, 0.3);
    scene_put(&s,
              "{'type': 'triangle', 'stretching_stiffness': 1000}, {'type': 'bending', "
              "'bending_rigidity': 1e-4}%s]}]}",
              gas ? ", {'type': 'gas', 'outside': 1000}" : "");
    pdyn_sim *sim = scene_load(job, &s);
    stretch(sim);
    double start = 0.0;
    *outer = *linear = 0;
    for (int k = 0; k < WARM + STEPS; k++) {
        if (k == WARM) start = seconds_now();
        pdyn_step_info info = take_step(sim);
        if (k >= WARM) *outer += info.outer_iterations, *linear += info.linear_iterations;
    }
    double time = (seconds_now() - start) / STEPS;
    pdyn_free(sim);
    return time;
}

/* CELLS. First with the same number of iterations, then to the same tolerance. */
static void cost(const struct job *job) {
    static const char *const effort[] = {"'outer_iterations': 4, 'tolerance': 0",
                                         "'tolerance': 0.01"};
    static const char *const name[] = {"4 outer iterations", "tolerance 0.01"};
    int cells = (int)job_number(job, 0, 41.0);
    printf("| vertices | solver | gas | ms a step | outer iterations | linear iterations "
           "|\n|---|---|---|---|---|---|\n");
    for (int k = 0; k < 4; k++) {
        int outer, linear;
        double time = cost_one(job, cells, k % 2, effort[k / 2], &outer, &linear);
        printf("| %d | %s | %s | %.1f | %.1f | %.1f |\n", 6 * cells * cells + 2, name[k / 2],
               k % 2 ? "yes" : "no", 1e3 * time, (double)outer / STEPS, (double)linear / STEPS);
        fflush(stdout);
    }
}

static const struct {
    const char *name;
    void (*run)(const struct job *job);
} commands[] = {{"compress", compress}, {"tension", tension}, {"float", floats}, {"cost", cost}};

int main(int argc, char **argv) {
    struct job job = {0};
    if (argc < 3) die("usage: gas compress|tension|float|cost DIRECTORY ...");
    job.context = make_context(1), job.directory = argv[2], job.count = argc - 3,
    job.argument = argv + 3;
    size_t k = 0, count = sizeof commands / sizeof *commands;
    while (k < count && strcmp(argv[1], commands[k].name)) k++;
    if (k == count) die("no command %s", argv[1]);
    commands[k].run(&job);
    pdyn_destroy(job.context);
    return 0;
}
