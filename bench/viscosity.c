/* Viscosity against exact results. Each command prints a table as markdown:
 *
 *     viscosity torsion N...           decay of a torsion wave in a bar N particles thick
 *     viscosity couette N...           plane Couette flow, N layers
 *     viscosity duct N...              flow through a square duct, N x N particles
 *     viscosity spread N SECONDS       a cylinder N particles high spreads on a floor
 *     viscosity rotation MS...         a turning ball: momentum, size
 *     viscosity cost SCENE SECONDS     a scene's liquid with other viscosities
 */
#include "bench.h"

#include "projdyn/scene.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846, density = 1000.0;

/* ---- scenes ---------------------------------------------------------------------------------- */

enum { MOST = 400000 };
static double start_x[MOST][3], start_v[MOST][3];

typedef bool inside_fn(const double x[3], double size);

/* The points of a lattice of spacing d, turned by 30 degrees about x and y if `turned`, inside a
 * body around the origin that reaches `size` from it at most. Returns their number. */
static int fill(double d, double size, bool turned, inside_fn *inside) {
    int n = 0, m = (int)ceil(2.0 * size / d);
    double c = turned ? cos(pi / 6.0) : 1.0, s = turned ? 0.5 : 0.0;
    for (int i = -m; i < m; i++)
        for (int j = -m; j < m; j++)
            for (int k = -m; k < m; k++) {
                double p[3] = {(i + 0.5) * d, (j + 0.5) * d, (k + 0.5) * d};
                double y = c * p[1] - s * p[2], z = s * p[1] + c * p[2];
                double x[3] = {c * p[0] - s * z, y, s * p[0] + c * z};
                if (!inside(x, size)) continue;
                if (n == MOST) die("too many particles");
                memcpy(start_x[n], x, sizeof x), memset(start_v[n++], 0, sizeof x);
            }
    return n;
}

static void set(pdyn_context *context, pdyn_scene *scene, const char *path, const char *format,
                double a, double b) {
    char value[1024];
    snprintf(value, sizeof value, format, a, b);
    for (char *c = value; *c; c++)
        if (*c == '\'') *c = '"';
    if (pdyn_scene_set(scene, path, "%s", value) != PDYN_OK) die("%s", pdyn_last_error(context));
}

/* A scene of n particles of the arrays with spacing d and viscosity mu, steps of h. */
static pdyn_scene *make_scene(pdyn_context *context, int n, double d, double mu, double h) {
    pdyn_scene *scene;
    if (pdyn_scene_create(context, "viscosity", &scene) != PDYN_OK ||
        pdyn_scene_particles(scene, "p.ply", n, start_x[0], start_v[0]) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    set(context, scene, "duration", "1000", 0, 0);
    set(context, scene, "frame_interval", "1000", 0, 0);
    set(context, scene, "gravity", "[0, 0, 0]", 0, 0);
    set(context, scene, "time_step.fixed", "%.17g", h, 0);
    set(context, scene, "solver.tolerance", "1e-3", 0, 0);
    set(context, scene, "bodies.liquid.particles", "{'radius': %.17g, 'fill': [{'file': 'p.ply'}]}",
        0.5 * d, 0);
    set(context, scene, "bodies.liquid.constraints.fluid", "{'sound_speed': 20, 'viscosity': 0}", 0,
        0);
    set(context, scene, "bodies.liquid.constraints.viscosity.viscosity", "%.17g", mu, 0);
    return scene;
}

static void set_no_slip(pdyn_context *context, pdyn_scene *scene, double mu) {
    set(context, scene, "bodies.liquid.constraints.no_slip.viscosity", "%.17g", mu, 0);
}

static pdyn_sim *load_scene(pdyn_context *context, pdyn_scene *scene) {
    pdyn_sim *sim;
    if (pdyn_scene_load(scene, &sim) != PDYN_OK) die("%s", pdyn_last_error(context));
    pdyn_scene_free(scene);
    return sim;
}

static void take_steps(pdyn_sim *sim, int steps) {
    for (int k = 0; k < steps; k++) take_step(sim);
}

/* ---- torsion --------------------------------------------------------------------------------- */

/* A bar along z, four times as long as thick. */
static bool in_bar(const double x[3], double size) {
    return hypot(x[0], x[1]) < 0.25 * size && fabs(x[2]) < size;
}

/* The velocity w r sin(k z) around the axis, with no stress at the sides and ends, decays with the
 * rate nu k^2. */
static double torsion_viscosity(pdyn_context *context, int thick, bool turned) {
    const double length = 0.2, d = 0.25 * length / thick, mu = 10.0, k = pi / length;
    double rate = mu / density * k * k, h = 0.02 / rate, before = 0.0, after = 0.0;
    int n = fill(d, 0.5 * length, turned, in_bar);
    for (int i = 0; i < n; i++) {
        double w = 1e-4 * sin(k * start_x[i][2]);
        start_v[i][0] = -w * start_x[i][1], start_v[i][1] = w * start_x[i][0];
    }
    pdyn_scene *scene = make_scene(context, n, d, mu, h);
    set(context, scene, "solver", "{'tolerance': 1e-9, 'linear_tolerance': 1e-4}", 0, 0);
    pdyn_sim *sim = load_scene(context, scene);
    take_steps(sim, 50);
    const pdyn_state s = pdyn_get_state(sim);
    for (int i = 0; i < n; i++) {
        before += vec3_dot(start_v[i], start_v[i]);
        after += vec3_dot(start_v[i], s.v + 3 * i);
    }
    pdyn_free(sim);
    return log(before / after) / (50.0 * h * rate);
}

static void torsion(pdyn_context *context, int count, char **thick) {
    printf("| particles across | lattice along the bar | lattice at 30 degrees |\n|---|---|---|\n");
    for (int k = 0; k < count; k++) {
        int n = atoi(thick[k]);
        double along = torsion_viscosity(context, n, false);
        printf("| %d | %.3f | %.3f |\n", n, along, torsion_viscosity(context, n, true));
        fflush(stdout);
    }
}

/* ---- walls ----------------------------------------------------------------------------------- */

static const double gap = 0.1; /* m, between walls, which lie at -0.05 and 0.05 */

/* nx x ny x nz particles around the origin */
static int fill_block(double d, int nx, int ny, int nz) {
    const int size[3] = {nx, ny, nz};
    int n = nx * ny * nz;
    if (n > MOST) die("too many particles");
    for (int i = 0; i < n; i++) {
        const int cell[3] = {i % nx, i / nx % ny, i / nx / ny};
        for (int a = 0; a < 3; a++)
            start_x[i][a] = d * (cell[a] + 0.5 - 0.5 * size[a]), start_v[i][a] = 0.0;
    }
    return n;
}

/* Largest error of the velocity in the middle of a long block below a wall that moves with speed v,
 * over v. */
static double couette_error(pdyn_context *context, int layers) {
    const double d = gap / layers, mu = 10.0, v = 1e-5;
    int n = fill_block(d, 6 * layers, layers, 8);
    double largest = 0.0, h = 0.04 * gap * gap * density / mu;
    pdyn_scene *scene = make_scene(context, n, d, mu, h);
    set_no_slip(context, scene, mu);
    set(context, scene, "solver", "{'tolerance': 1e-8, 'linear_tolerance': 1e-3}", 0, 0);
    set(context, scene, "solids.low",
        "{'box': {'minimum': [-2, %g, -2], 'maximum': [2, 1, 2]},"
        " 'open': ['+y', '+x', '-x', '+z', '-z']}",
        -0.5 * gap, 0);
    set(context, scene, "solids.top",
        "{'box': {'minimum': [-2, -1, -2], 'maximum': [2, %g, 2]}, 'open': ['-y', '+x', '-x', '+z',"
        " '-z'], 'motion': [{'time': 0}, {'time': 1000, 'translate': [%g, 0, 0]}]}",
        0.5 * gap, 1000.0 * v);
    pdyn_sim *sim = load_scene(context, scene);
    take_steps(sim, 40);
    const pdyn_state s = pdyn_get_state(sim);
    for (int i = 0; i < n; i++)
        if (fabs(start_x[i][0]) < 0.5 * gap)
            largest = fmax(largest, fabs(s.v[3 * i] / v - start_x[i][1] / gap - 0.5));
    pdyn_free(sim);
    return largest;
}

static void couette(pdyn_context *context, int count, char **layers) {
    printf("| layers | largest error over the wall's speed |\n|---|---|\n");
    for (int k = 0; k < count; k++)
        printf("| %s | %.4f |\n", layers[k], couette_error(context, atoi(layers[k])));
}

/* Velocity in a square duct around the origin under the acceleration a along x (White 2006, eq.
 * 3-48). */
static double duct_velocity(double y, double z, double a, double nu) {
    double sum = 0.0;
    for (int k = 1; k < 80; k += 2) {
        double b = k * pi / gap, side = cosh(b * z) / cosh(0.5 * b * gap);
        sum += (1.0 - side) * sin(b * (y + 0.5 * gap)) / ((double)k * k * k);
    }
    return 4.0 * a * gap * gap / (nu * pi * pi * pi) * sum;
}

static void print_duct(pdyn_context *context, int across) {
    const double d = gap / across, mu = 10.0, a = 1e-3;
    int n = fill_block(d, 4 * across, across, across);
    double flow = 0.0, exact = 0.0, squares = 0.0, inside = 0.0,
           h = 0.02 * gap * gap * density / mu;
    pdyn_scene *scene = make_scene(context, n, d, mu, h);
    set_no_slip(context, scene, mu);
    set(context, scene, "gravity", "[%g, 0, 0]", a, 0);
    set(context, scene, "solids.duct",
        "{'box': {'minimum': [-1, -0.05, -0.05], 'maximum': [1, 0.05, 0.05]},"
        " 'open': ['+x', '-x']}",
        0, 0);
    pdyn_sim *sim = load_scene(context, scene);
    take_steps(sim, 20);
    const pdyn_state s = pdyn_get_state(sim);
    for (int i = 0; i < n; i++) {
        if (fabs(start_x[i][0]) > 0.5 * gap) continue;
        double v = duct_velocity(start_x[i][1], start_x[i][2], a, mu / density);
        flow += s.v[3 * i], exact += v, squares += pow(s.v[3 * i] - v, 2), inside++;
    }
    double fastest = duct_velocity(0.0, 0.0, a, mu / density);
    printf("| %d | %.3f | %.3f |\n", across, flow / exact, sqrt(squares / inside) / fastest);
    pdyn_free(sim);
}

static void duct(pdyn_context *context, int count, char **across) {
    printf("| particles across | flow over exact | rms error over the largest velocity |\n"
           "|---|---|---|\n");
    for (int k = 0; k < count; k++) print_duct(context, atoi(across[k])), fflush(stdout);
}

/* ---- spreading ------------------------------------------------------------------------------- */

/* A cylinder as high as its radius, whose axis is y. */
static bool in_cylinder(const double x[3], double size) {
    return hypot(x[0], x[2]) < size && fabs(x[1]) < 0.5 * size;
}

/* Radius of the liquid on the floor: the mean over sectors of the outermost particle of the lowest
 * layer. */
static double front(const pdyn_sim *sim, double d) {
    enum { SECTORS = 32 };
    const pdyn_state s = pdyn_get_state(sim);
    double farthest[SECTORS] = {0.0}, sum = 0.0;
    for (int i = 0; i < s.particles; i++) {
        const double *x = s.x + 3 * i;
        int k = (int)((atan2(x[2], x[0]) + pi) / (2.0 * pi) * SECTORS) % SECTORS;
        if (x[1] < d) farthest[k] = fmax(farthest[k], hypot(x[0], x[2]));
    }
    for (int k = 0; k < SECTORS; k++) sum += farthest[k] / SECTORS;
    return sum + 0.5 * d;
}

/* Huppert 1982, eq. 2.20: r = 0.894 (g V^3 / (3 nu))^(1/8) t^(1/8) for a thin layer */
static void spread(pdyn_context *context, int layers, double seconds) {
    const double radius = 0.1, d = radius / layers, mu = 100.0;
    int n = fill(d, radius, false, in_cylinder);
    for (int i = 0; i < n; i++) start_x[i][1] += 0.5 * radius;
    double volume = n * d * d * d, nu = mu / density, last = 0.0, t = 0.0;
    pdyn_scene *scene = make_scene(context, n, d, mu, 0.005);
    set_no_slip(context, scene, mu);
    set(context, scene, "gravity", "[0, %g, 0]", -g, 0);
    set(context, scene, "solver", "{'tolerance': 0.05, 'linear_tolerance': 0.1}", 0, 0);
    set(context, scene, "solids.floor",
        "{'box': {'minimum': [-1, 0, -1], 'maximum': [1, 1, 1]},"
        " 'open': ['+y', '+x', '-x', '+z', '-z']}",
        0, 0);
    pdyn_sim *sim = load_scene(context, scene);
    printf("| t, s | radius, mm | Huppert, mm | exponent |\n|---|---|---|---|\n");
    for (double next = 0.125; next <= seconds; next *= 2.0) {
        while (pdyn_time(sim) < next - 1e-6) take_step(sim);
        double r = front(sim, d),
               exact = 0.894 * pow(g * pow(volume, 3) / (3.0 * nu) * next, 0.125);
        printf("| %g | %.1f | %.1f |", next, 1e3 * r, 1e3 * exact);
        if (t > 0.0) printf(" %.3f |\n", log(r / last) / log(next / t));
        else printf(" |\n");
        last = r, t = next;
        fflush(stdout);
    }
    pdyn_free(sim);
}

/* ---- rotation -------------------------------------------------------------------------------- */

static bool in_ball(const double x[3], double size) { return vec3_length(x) < size; }

static void print_rotation(pdyn_context *context, double h, const char *integrator) {
    const double d = 0.01, turn = 10.0;
    int n = fill(d, 0.05, false, in_ball);
    double moment = 0.0, exact = 0.0, size = 0.0, before = 0.0, sum[3] = {0}, speed = 0.0;
    for (int i = 0; i < n; i++)
        start_v[i][0] = -turn * start_x[i][1], start_v[i][1] = turn * start_x[i][0];
    pdyn_scene *scene = make_scene(context, n, d, 1e5, h);
    if (pdyn_scene_set(scene, "time_step.integrator", "\"%s\"", integrator) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    pdyn_sim *sim = load_scene(context, scene);
    take_steps(sim, (int)(0.5 / h + 0.5));
    const pdyn_state s = pdyn_get_state(sim);
    for (int i = 0; i < n; i++) {
        const double *x = s.x + 3 * i, *v = s.v + 3 * i;
        moment += x[0] * v[1] - x[1] * v[0], size += hypot(x[0], x[1]);
        exact += turn * (pow(start_x[i][0], 2) + pow(start_x[i][1], 2));
        before += hypot(start_x[i][0], start_x[i][1]);
        vec3_add(sum, 1.0, v), speed += vec3_length(v);
    }
    printf("| %s, %g | %.1e | %.4f | %.5f |\n", integrator, 1e3 * h, vec3_length(sum) / speed,
           moment / exact, size / before);
    pdyn_free(sim);
}

static void rotation(pdyn_context *context, int count, char **ms) {
    printf("| integrator, h in ms | linear momentum | angular momentum | mean radius |\n"
           "|---|---|---|---|\n");
    for (int k = 0; k < 2 * count; k++)
        print_rotation(context, 1e-3 * atof(ms[k / 2]), k % 2 ? "euler" : "bdf2");
}

/* ---- cost ------------------------------------------------------------------------------------ */

/* The scene with the viscosity mu of its body "water" in place of XSPH; 0: as it is. */
static pdyn_sim *load_liquid(pdyn_context *context, const char *file, double mu) {
    pdyn_scene *scene;
    if (pdyn_scene_open(context, file, &scene) != PDYN_OK) die("%s", pdyn_last_error(context));
    if (mu > 0.0) {
        set(context, scene, "bodies.water.constraints.fluid.viscosity", "0", 0, 0);
        set(context, scene, "bodies.water.constraints.viscosity.viscosity", "%g", mu, 0);
        set(context, scene, "bodies.water.constraints.no_slip.viscosity", "%g", mu, 0);
    }
    return load_scene(context, scene);
}

/* Processor time of all runs, step by step in turn, so that the load of the machine is the same. */
static void cost(pdyn_context *context, const char *file, double seconds) {
    static const double mu[] = {0.0, 0.1, 10.0, 100.0, 1000.0};
    enum { RUNS = sizeof mu / sizeof *mu };
    pdyn_sim *sim[RUNS];
    double ms[RUNS] = {0.0}, steps[RUNS] = {0.0}, linear[RUNS] = {0.0}, largest[RUNS] = {0.0};
    for (int k = 0; k < RUNS; k++) sim[k] = load_liquid(context, file, mu[k]);
    for (double t = 0.05; t < seconds + 0.01; t += 0.05)
        for (int k = 0; k < RUNS; k++)
            while (pdyn_time(sim[k]) < t - 1e-6) {
                pdyn_step_info info = take_step(sim[k]);
                ms[k] += info.ms_cpu, steps[k]++, linear[k] += info.linear_iterations;
                largest[k] = fmax(largest[k], info.step_residual);
            }
    printf("| mu, Pa s | steps | iterations a step | ms a step | time over water's | residual |\n"
           "|---|---|---|---|---|---|\n");
    for (int k = 0; k < RUNS; k++) {
        printf("| %g | %.0f | %.0f | %.0f | %.2f | %.2g |\n", mu[k], steps[k], linear[k] / steps[k],
               ms[k] / steps[k], ms[k] / ms[0], largest[k]);
        pdyn_free(sim[k]);
    }
}

int main(int argc, char **argv) {
    const char *command = argc > 2 ? argv[1] : "";
    pdyn_context *context = make_context(1);
    if (!strcmp(command, "torsion")) torsion(context, argc - 2, argv + 2);
    else if (!strcmp(command, "couette")) couette(context, argc - 2, argv + 2);
    else if (!strcmp(command, "duct")) duct(context, argc - 2, argv + 2);
    else if (!strcmp(command, "spread") && argc == 4) spread(context, atoi(argv[2]), atof(argv[3]));
    else if (!strcmp(command, "rotation")) rotation(context, argc - 2, argv + 2);
    else if (!strcmp(command, "cost") && argc == 4) cost(context, argv[2], atof(argv[3]));
    else
        die("usage: viscosity torsion N... | couette N... | duct N... | spread N SECONDS | "
            "rotation MS... | cost SCENE SECONDS");
    pdyn_destroy(context);
    return 0;
}
