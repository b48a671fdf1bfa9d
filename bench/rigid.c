/* Rigid bodies against theory. Each command prints a table as markdown:
 *
 *     rigid flight [STEPS]       a tumbling box without forces: momenta, and its flips against
 *                                Euler's equations
 *     rigid incline              a box on a slope: the angle at which it slips, its acceleration
 *     rigid stack [SECONDS]      ten boxes on each other: how far they sink and drift
 *     rigid floating [SECONDS]   draught of a floating box, and which ratio of its sides is stable
 *     rigid many [SECONDS]       a dam break with 100 bodies and without: time of a run
 */
#include "../tests/free_top.h"
#include "bench.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static pdyn_context *context;

/* Mean position or velocity of the vertices of a box. */
static void middle_of(const pdyn_sim *sim, int body, const double *value, double mean[3]) {
    const pdyn_body_info info = pdyn_get_body(sim, body);
    memset(mean, 0, 3 * sizeof *mean);
    for (int i = 0; i < info.count; i++)
        vec3_add(mean, 1.0 / info.count, value + 3 * (info.first + i));
}

/* ---- free flight ----------------------------------------------------------------------------- */

static const double pi = 3.14159265358979323846;

struct motion {
    double linear[3], angular[3]; /* kg m/s; kg m^2/s about the centre of mass */
};

static struct motion motion_of(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    struct motion sum = {0};
    double centre[3] = {0}, mass = 0.0;
    for (int i = 0; i < s.particles; i++) {
        vec3_add(centre, s.mass[i], s.x + 3 * i);
        vec3_add(sum.linear, s.mass[i], s.v + 3 * i);
        mass += s.mass[i];
    }
    for (int i = 0; i < s.particles; i++) {
        double r[3], moment[3];
        for (int a = 0; a < 3; a++) r[a] = s.x[3 * i + a] - centre[a] / mass;
        vec3_cross(moment, r, s.v + 3 * i);
        vec3_add(sum.angular, s.mass[i], moment);
    }
    return sum;
}

/* A half turn of the middle axis: its component along its first direction changes its sign. */
struct flips {
    double last, time[64];
    int count;
};

static void add_flip(struct flips *f, double along, double time, double h) {
    if (along * f->last < 0.0 && f->count < 64)
        f->time[f->count++] = time - h * along / (along - f->last);
    f->last = along;
}

/* The middle axis of the box is along y at the start. */
static const double box[3] = {0.2, 0.4, 0.6}; /* m: sides along the axes of least to most inertia */

static struct flips flips_of_reference(const double w[3], double end) {
    struct top top = {{w[0], w[1], w[2]}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    double I[3], h = 1e-5;
    struct flips flips = {.last = 1.0};
    top_inertia(box, I);
    for (long n = 0; (double)n * h < end; n++) {
        top_step(&top, I, h);
        add_flip(&flips, top.axes[4], (double)(n + 1) * h, h);
    }
    return flips;
}

static void flight(int steps) {
    static const double w[3] = {0.02, 10.0, 0.03};
    printf(
        "| integrator, h | linear momentum | angular momentum | flips | first flip, s | theory | "
        "last flip, s | theory |\n|---|---|---|---|---|---|---|---|\n");
    static const struct {
        const char *integrator;
        double h;
    } runs[] = {{"bdf2", 2e-3}, {"bdf2", 5e-3}, {"euler", 5e-3}};
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        double h = runs[k].h;
        pdyn_sim *sim = load_text(
            context,
            "{'duration': 1000, 'gravity': [0, 0, 0], 'frame_interval': 1000, 'time_step': {"
            "'fixed': %g, 'integrator': '%s'}, 'bodies': [{'velocity': [0.3, -0.2, 0.1], 'rigid': "
            "{'box': {'minimum': [%g, %g, %g], 'maximum': [%g, %g, %g]}, 'density': 700, "
            "'angular_velocity': [%g, %g, %g]}}]}",
            h, runs[k].integrator, -0.5 * box[0], -0.5 * box[1], -0.5 * box[2], 0.5 * box[0],
            0.5 * box[1], 0.5 * box[2], w[0], w[1], w[2]);
        struct motion start = motion_of(sim);
        struct flips flips = {.last = 1.0}, theory = flips_of_reference(w, steps * h);
        for (int n = 0; n < steps; n++) {
            take_step(sim);
            const double *x = pdyn_get_state(sim).x; /* vertex 2 is beyond vertex 0 along y */
            add_flip(&flips, x[7] - x[1], pdyn_time(sim), h);
        }
        struct motion end = motion_of(sim);
        int last = flips.count < theory.count ? flips.count - 1 : theory.count - 1;
        printf("| %s, %g ms | %.1e | %.1e | %d of %d | %.4f | %.4f | %.4f | %.4f |\n",
               runs[k].integrator, 1e3 * h,
               vec3_distance(start.linear, end.linear) / vec3_length(start.linear),
               vec3_distance(start.angular, end.angular) / vec3_length(start.angular), flips.count,
               theory.count, flips.time[0], theory.time[0], last >= 0 ? flips.time[last] : 0.0,
               last >= 0 ? theory.time[last] : 0.0);
        pdyn_free(sim);
    }
}

/* ---- slope ----------------------------------------------------------------------------------- */

static pdyn_sim *load_slope(double degrees, double friction, double h) {
    double angle = degrees * pi / 180.0;
    return load_text(
        context,
        "{'duration': 1000, 'gravity': [%.17g, %.17g, 0], 'frame_interval': 1000, "
        "'time_step': {'fixed': %g}, 'solver': {'tolerance': 1e-5},"
        "'contact': {'thickness': 0.002, 'stiffness': 1e5, 'friction': %g}, 'solids': ["
        "{'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 40}}],"
        "'bodies': [{'rigid': {'box': {'minimum': [-0.1, 0.002, -0.1], 'maximum': [0.1, "
        "0.102, 0.1]}, 'density': 1000}}]}",
        g * sin(angle), -g * cos(angle), h, friction);
}

/* The box's way along the slope from 1 s to 2 s, and its mean acceleration then. */
static double slide(double degrees, double friction, double h, double *way) {
    pdyn_sim *sim = load_slope(degrees, friction, h);
    double x[3], v[2][3];
    while (pdyn_time(sim) < 1.0 - 0.5 * h) take_step(sim);
    middle_of(sim, 0, pdyn_get_state(sim).x, x);
    middle_of(sim, 0, pdyn_get_state(sim).v, v[0]);
    *way = -x[0];
    while (pdyn_time(sim) < 2.0 - 0.5 * h) take_step(sim);
    middle_of(sim, 0, pdyn_get_state(sim).x, x);
    middle_of(sim, 0, pdyn_get_state(sim).v, v[1]);
    *way += x[0];
    pdyn_free(sim);
    return v[1][0] - v[0][0];
}

static void incline(void) {
    static const double factors[] = {0.9, 0.98, 1.02, 1.1, 1.5};
    const double friction = 0.5, h = 0.005;
    printf("| tan of the angle over the friction coefficient | way from 1 s to 2 s, m | "
           "acceleration, m/s^2 | theory |\n|---|---|---|---|\n");
    for (size_t k = 0; k < sizeof factors / sizeof *factors; k++) {
        double angle = atan(factors[k] * friction), way;
        double measured = slide(angle * 180.0 / pi, friction, h, &way);
        double theory = g * fmax(0.0, sin(angle) - friction * cos(angle));
        printf("| %g | %.2e | %.4f | %.4f |\n", factors[k], way, measured, theory);
        fflush(stdout);
    }
}

/* ---- stack ----------------------------------------------------------------------------------- */

static void stack(double seconds) {
    enum { BOXES = 10 };
    static char bodies[1 << 13];
    size_t used = 0;
    const double side = 0.1, gap = 0.00185, h = 0.005;
    for (int k = 0; k < BOXES; k++) {
        double low = gap + k * (side + gap);
        used += (size_t)snprintf(
            bodies + used, sizeof bodies - used,
            "%s{'rigid': {'box': {'minimum': [-0.05, %g, -0.05], 'maximum': [0.05, %g, 0.05]}, "
            "'density': 1000}}",
            k ? ", " : "", low, low + side);
    }
    pdyn_sim *sim =
        load_text(context,
                  "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': %g}, "
                  "'solver': {'tolerance': 0.001}, "
                  "'contact': {'thickness': 0.002, 'stiffness': 1e5}, 'solids': [{'plane': "
                  "{'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 4}}], 'bodies': [%s]}",
                  h, bodies);
    printf("| time, s | top of the stack, mm below the start | largest drift, mm | speed of the "
           "top, mm/s | outer, linear iterations | ms per step |\n|---|---|---|---|---|---|\n");
    double start[3], x[3], v[3], outer = 0.0, linear = 0.0, ms = 0.0;
    long steps = 0;
    middle_of(sim, BOXES - 1, pdyn_get_state(sim).x, start);
    for (double next = 0.1; next < seconds + 0.01; next += next < 0.9 ? 0.9 : 1.0) {
        while (pdyn_time(sim) < next - 0.5 * h) {
            pdyn_step_info info = take_step(sim);
            outer += info.outer_iterations, linear += info.linear_iterations, steps++;
            ms += info.ms_local + info.ms_global + info.ms_contact;
        }
        double drift = 0.0;
        for (int k = 0; k < BOXES; k++) {
            middle_of(sim, k, pdyn_get_state(sim).x, x);
            drift = fmax(drift, hypot(x[0], x[2]));
        }
        middle_of(sim, BOXES - 1, pdyn_get_state(sim).v, v);
        printf("| %g | %.3f | %.2g | %.2g | %.1f, %.0f | %.2f |\n", pdyn_time(sim),
               1e3 * (start[1] - x[1]), 1e3 * drift, 1e3 * vec3_length(v), outer / (double)steps,
               linear / (double)steps, ms / (double)steps);
        fflush(stdout);
    }
    pdyn_free(sim);
}

/* ---- floating -------------------------------------------------------------------------------- */

/* A box of half the density of water, released with a list of 8 degrees at its draught. In a tank
 * 22 spacings wide, so that the water rises by the displaced volume. */
static void floating(double seconds) {
    static const double ratios[] = {1.0, 1.6}; /* width over height */
    const double d = 0.02, width = 12 * d, tank = 22 * d, depth = 14 * d, h = 0.005;
    printf("| width over height | draught over height | list after %g s, degrees | theory | outer, "
           "linear iterations |\n|---|---|---|---|---|\n",
           seconds);
    for (size_t k = 0; k < sizeof ratios / sizeof *ratios; k++) {
        double height = width / ratios[k], x[3], outer = 0.0, linear = 0.0;
        pdyn_sim *sim = load_text(
            context,
            "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': %g}, 'contact': "
            "{'thickness': 0.002, 'stiffness': 1e4}, 'solids': [{'box': {'minimum': [0, 0, 0], "
            "'maximum': [%g, %g, %g]}, 'open': ['+y']}], 'bodies': [{'name': 'box', 'rigid': "
            "{'box': {'minimum': [%g, %g, %g], 'maximum': [%g, %g, %g]}, 'rotate': [0, 0, 8], "
            "'translate': [%g, %g, %g], 'density': 500}}, {'name': 'water', 'particles': "
            "{'radius': %g, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [%g, %g, %g]}}]}, "
            "'constraints': [{'type': 'fluid'}]}]}",
            h, tank, 4.0 * depth, tank, -0.5 * width, -0.5 * height, -0.5 * width, 0.5 * width,
            0.5 * height, 0.5 * width, 0.5 * tank, depth + 0.1 * height, 0.5 * tank, 0.5 * d, tank,
            depth, tank);
        long steps = 0;
        double mean = 0.0, count = 0.0, list = 0.0;
        while (pdyn_time(sim) < seconds - 0.5 * h) {
            pdyn_step_info info = take_step(sim);
            outer += info.outer_iterations, linear += info.linear_iterations, steps++;
            const double *at = pdyn_get_state(sim).x;
            double up = (at[7] - at[1]) / height; /* vertex 2 is over vertex 0 */
            list = acos(fmin(1.0, up)) * 180.0 / pi;
            if (pdyn_time(sim) < 0.7 * seconds) continue;
            /* water and the submerged part of the box fill the tank up to `level` */
            middle_of(sim, 0, at, x);
            double volume = info.particles * d * d * d, base = tank * tank;
            double bottom = x[1] - 0.5 * height, area = width * width;
            double level = (volume - area * bottom) / (base - area);
            mean += (level - bottom) / height, count++;
        }
        printf("| %g | %.3f | %.1f | %s | %.1f, %.0f |\n", ratios[k], mean / count, list,
               ratios[k] > sqrt(1.5) ? "0" : "tilts", outer / (double)steps,
               linear / (double)steps);
        fflush(stdout);
        pdyn_free(sim);
    }
}

/* ---- many bodies in a dam break -------------------------------------------------------------- */

/* 10 x 10 boxes, three particle spacings wide, over the water and beside it. */
static void write_boxes(char *text, size_t size) {
    size_t used = 0;
    for (int k = 0; k < 100; k++) {
        double x = 0.1 + 0.14 * (k % 10), z = 0.06 + 0.1 * (k / 10 % 5);
        double low = 0.56 + 0.1 * (k / 50), turn = 7.0 * k;
        used += (size_t)snprintf(
            text + used, size - used,
            ", {'rigid': {'box': {'minimum': [-0.03, -0.03, -0.03], 'maximum': [0.03, 0.03, 0.03]},"
            " 'rotate': [%g, %g, %g], 'translate': [%g, %g, %g], 'density': %d}}",
            turn, 2.0 * turn, 3.0 * turn, x, low + 0.03, z, k % 2 ? 500 : 2000);
    }
}

struct cost {
    double ms, outer, linear; /* of all steps */
    int steps, unsolved, particles;
};

/* Steps of the default length, which `cfl` limits. */
static struct cost cost_of(const char *more, double seconds) {
    pdyn_sim *sim = load_text(
        context,
        "{'duration': 1000, 'frame_interval': 1000, 'solids': "
        "[{'box': {'minimum': [0, 0, 0], 'maximum': [1.62, 1.2, 0.54]}, 'open': ['+y']}], "
        "'bodies': [{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': "
        "[0, 0, 0], 'maximum': [0.54, 0.54, 0.54]}}]}, 'constraints': [{'type': 'fluid', "
        "'compression': 0.001}]}%s}",
        more);
    struct cost cost = {.particles = 0};
    for (; pdyn_time(sim) < seconds; cost.steps++) {
        pdyn_step_info info = take_step(sim);
        cost.ms += info.ms_cpu, cost.outer += info.outer_iterations;
        cost.linear += info.linear_iterations, cost.unsolved += info.step_residual > 0.1;
        cost.particles = info.particles;
    }
    pdyn_free(sim);
    return cost;
}

static void many(double seconds) {
    static char more[1 << 16] = "";
    write_boxes(more, sizeof more);
    strcat(more, "], 'contact': {'thickness': 0.004, 'stiffness': 1e4}");
    const char *const texts[2] = {"]", more};
    struct cost cost[2];
    printf("| bodies | particles | steps | outer, linear iterations a step | unsolved steps | CPU "
           "time of a step, ms | CPU time, s |\n|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < 2; k++) {
        struct cost c = cost[k] = cost_of(texts[k], seconds);
        printf("| %d | %d | %d | %.1f, %.0f | %d | %.1f | %.1f |\n", 100 * k, c.particles, c.steps,
               c.outer / c.steps, c.linear / c.steps, c.unsolved, c.ms / c.steps, 1e-3 * c.ms);
        fflush(stdout);
    }
    printf("\nratio %.2f\n", cost[1].ms / cost[0].ms);
}

/* ---- main ------------------------------------------------------------------------------------ */

int main(int argc, char **argv) {
    const char *command = argc > 1 ? argv[1] : "";
    double number = argc > 2 ? strtod(argv[2], NULL) : 0.0;
    context = make_context(1);
    if (!strcmp(command, "flight")) flight(number > 0.0 ? (int)number : 1000);
    else if (!strcmp(command, "incline")) incline();
    else if (!strcmp(command, "stack")) stack(number > 0.0 ? number : 10.0);
    else if (!strcmp(command, "floating")) floating(number > 0.0 ? number : 3.0);
    else if (!strcmp(command, "many")) many(number > 0.0 ? number : 0.24);
    else
        die("usage: rigid flight [STEPS] | incline | stack [SECONDS] | floating [SECONDS] | many "
            "[SECONDS]");
    pdyn_destroy(context);
    return EXIT_SUCCESS;
}
