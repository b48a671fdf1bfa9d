/* Two liquids in one tank. Each command prints a table as markdown:
 *
 *     liquids layers WIDTH LOWER UPPER SECONDS DENSITY...
 *         pressure in layers at rest: a tank WIDTH x WIDTH particles wide, water LOWER layers deep
 *         under UPPER layers of a liquid of each DENSITY, kg/m^3
 *     liquids overturn DIRECTORY WAVE DEPTH SECONDS DENSITY...
 *         Rayleigh-Taylor instability of water over a liquid of each DENSITY: growth of one wave of
 *         WAVE particles, DEPTH particles deep on both sides; writes its amplitude in time
 *     liquids momentum STEPS DENSITY...
 *         water hits a resting drop of each DENSITY, without gravity */
#include "bench.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double d = 0.02, water = 1000.0, pi = 3.14159265358979323846; /* m, kg/m^3 */

/* A body of a liquid; arguments: name, density, radius, fill, compression or stiffness as text. */
#define LIQUID                                                                                     \
    "{'name': '%s', 'particles': {'rest_density': %.17g, 'radius': %.17g, 'fill': [%s]},"          \
    " 'constraints': [{'type': 'fluid', %s}]}"
#define BOX "{'box': {'minimum': [%.17g, %.17g, %.17g], 'maximum': [%.17g, %.17g, %.17g]}}"
#define TANK                                                                                       \
    "'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, "         \
    "%.17g]}}]}"

/* ---- layers at rest -------------------------------------------------------------------------- */

enum { LAYERS = 256 };

struct layer { /* sums over states: mass, and pressure of `inside` particles */
    double mass, inside, pressure;
};

/* Adds a state: layers one spacing thick; inside: farther than two spacings from side walls. */
static void add_state(const pdyn_state *s, double width, struct layer *layer) {
    for (int i = 0; i < s->particles; i++) {
        const double *x = s->x + 3 * i;
        int k = (int)fmin(fmax(0.0, x[1] / d), LAYERS - 1);
        layer[k].mass += s->mass[i];
        if (fmin(fmin(x[0], width - x[0]), fmin(x[2], width - x[2])) < 2.0 * d) continue;
        layer[k].inside++, layer[k].pressure += s->pressure[i];
    }
}

/* The largest deviation of a layer from the weight above it, of layers first to last. */
static double worst_layer(const struct layer *layer, int first, int last, double area) {
    double above = 0.0, worst = 0.0;
    for (int k = LAYERS - 1; k >= first; k--) {
        double expected = (above + 0.5 * layer[k].mass) * g / area;
        double error = layer[k].pressure / layer[k].inside / expected - 1.0;
        if (k <= last && fabs(error) > fabs(worst)) worst = error;
        above += layer[k].mass;
    }
    return worst;
}

/* Particles of both liquids that are more than a spacing beyond the level between them. */
static int count_beyond(const pdyn_sim *sim, double level) {
    const pdyn_state s = pdyn_get_state(sim);
    pdyn_body_info lower = pdyn_get_body(sim, 0);
    int count = 0;
    for (int i = 0; i < s.particles; i++) {
        bool below = i < lower.first + lower.count;
        count += (below ? s.x[3 * i + 1] - level : level - s.x[3 * i + 1]) > d;
    }
    return count;
}

static void measure_layers(pdyn_context *context, int width, int lower, int upper, double seconds,
                           double density) {
    struct layer layer[LAYERS] = {{0}};
    double W = width * d, level = lower * d, top = level + upper * d, states = 0.0, ms = 0.0;
    char below[512], above[512];
    snprintf(below, sizeof below, BOX, 0.0, 0.0, 0.0, W, level, W);
    snprintf(above, sizeof above, BOX, 0.0, level, 0.0, W, top, W);
    const char *calm = "'compression': 1e-3, 'viscosity': 0.2";
    pdyn_sim *sim =
        load_text(context,
                  "{'duration': 1000, 'time_step': {'maximum': 0.005}, 'bodies': [" LIQUID
                  ", " LIQUID "], " TANK,
                  "lower", water, 0.5 * d, below, calm, "upper", density, 0.5 * d, above, calm, W,
                  top + 10.0 * d, W);
    const pdyn_state state = pdyn_get_state(sim);
    long steps = 0;
    for (; pdyn_time(sim) < seconds; steps++) {
        pdyn_step_info info = take_step(sim);
        ms += info.ms_cpu;
        if (info.time < 0.6 * seconds) continue;
        add_state(&state, W, layer), states++;
    }
    double area = W * W * states;
    printf("| %g | %+.1f %% | %+.1f %% | %d of %d | %.1f |\n", water / density,
           100.0 * worst_layer(layer, 4, lower - 5, area),
           100.0 * worst_layer(layer, lower + 4, lower + upper - 5, area), count_beyond(sim, level),
           state.particles, ms / (double)steps);
    fflush(stdout);
    pdyn_free(sim);
}

static void layers(pdyn_context *context, int count, char **argument) {
    int width = atoi(argument[0]), lower = atoi(argument[1]), upper = atoi(argument[2]);
    if (width < 6 || lower < 10 || upper < 10 || lower + upper > LAYERS - 20)
        die("expected a WIDTH of 6 or more, LOWER and UPPER of 10 or more");
    printf("| density ratio | worst layer below | above | beyond the level | ms a step |\n"
           "|---|---|---|---|---|\n");
    for (int k = 4; k < count; k++)
        measure_layers(context, width, lower, upper, atof(argument[3]), atof(argument[k]));
}

/* ---- Rayleigh-Taylor instability ------------------------------------------------------------- */

enum { THICK = 6 }; /* particles across the tank */

struct wave {
    int length, depth; /* particles */
    double amplitude;  /* m, at the start */
};

static double level_of(const struct wave *w, double x) {
    return w->depth * d + w->amplitude * cos(2.0 * pi * x / (w->length * d));
}

/* Writes the lattice points above (or below) the wave as a PLY file. */
static void write_points(const struct wave *w, bool above, const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    for (int pass = 0, found = 0; pass < 2; pass++) {
        if (pass)
            fprintf(file,
                    "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\n"
                    "property double y\nproperty double z\nend_header\n",
                    found);
        for (int k = 0; k < w->length * 2 * w->depth * THICK; k++) {
            double x = (k % w->length + 0.5) * d, z = (k / w->length % THICK + 0.5) * d;
            double y = (k / w->length / THICK + 0.5) * d;
            if ((y > level_of(w, x)) != above) continue;
            if (pass) fprintf(file, "%.9g %.9g %.9g\n", x, y, z);
            else found++;
        }
    }
    fclose(file);
}

/* The amplitude, m, of the wave of the volume of body 0, the lower liquid, over x. */
static double amplitude_of(const struct wave *w, const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    pdyn_body_info lower = pdyn_get_body(sim, 0);
    double sum = 0.0, length = w->length * d;
    for (int i = lower.first; i < lower.first + lower.count; i++)
        sum += cos(2.0 * pi * s.x[3 * i] / length);
    return 2.0 * sum * d * d * d / (length * THICK * d);
}

/* Height of the lower liquid in the bubble: of the k-th highest of its particles. */
static double bubble_of(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    pdyn_body_info lower = pdyn_get_body(sim, 0);
    double top[THICK] = {0};
    for (int i = lower.first; i < lower.first + lower.count; i++) {
        double y = s.x[3 * i + 1];
        for (int k = 0; k < THICK; k++)
            if (y > top[k]) {
                double lower_one = top[k];
                top[k] = y, y = lower_one;
            }
    }
    return top[THICK - 1];
}

static pdyn_sim *load_wave(pdyn_context *context, const struct wave *w, const char *directory,
                           double density) {
    char path[1024], fill[2][1100];
    for (int above = 0; above < 2; above++) {
        snprintf(path, sizeof path, "%s/%s.ply", directory, above ? "upper" : "lower");
        write_points(w, above, path);
        snprintf(fill[above], sizeof fill[above], "{'file': '%s'}", path);
    }
    return load_text(context,
                     "{'duration': 1000, 'time_step': {'maximum': 0.004}, 'bodies': [" LIQUID
                     ", " LIQUID "], " TANK,
                     "lower", density, 0.5 * d, fill[0], "'compression': 1e-3", "upper", water,
                     0.5 * d, fill[1], "'compression': 1e-3", w->length * d,
                     (2 * w->depth + 10) * d, THICK * d);
}

/* The rate n of a growth cosh(n t) from 2 to 4 times the amplitude at the start, 1/s, and the speed
 * of the bubble, m/s, while it rises from 0.2 to 0.5 wave lengths above the level. */
static void measure_wave(pdyn_context *context, const struct wave *w, const char *directory,
                         double seconds, double density) {
    pdyn_sim *sim = load_wave(context, w, directory, density);
    double k = 2.0 * pi / (w->length * d), atwood = (water - density) / (water + density);
    double grown[2] = {0}, passed[2] = {0}, level = w->depth * d, length = w->length * d;
    char name[64];
    snprintf(name, sizeof name, "overturn_%g", density);
    FILE *csv = open_csv(directory, name);
    fprintf(csv, "time_s,amplitude_m,bubble_m\n");
    while (pdyn_time(sim) < seconds) {
        double time = take_step(sim).time, a = amplitude_of(w, sim), y = bubble_of(sim);
        fprintf(csv, "%.6g,%.6g,%.6g\n", time, a, y - level);
        for (int m = 0; m < 2; m++) {
            if (!(grown[m] > 0.0) && k * a > 0.4 + 0.4 * m) grown[m] = time;
            if (!(passed[m] > 0.0) && y > level + (0.2 + 0.3 * m) * length) passed[m] = time;
        }
    }
    fclose(csv);
    if (!(grown[1] > 0.0 && passed[1] > 0.0)) die("expected more SECONDS than %g", seconds);
    double rate = (acosh(4.0) - acosh(2.0)) / (grown[1] - grown[0]),
           speed = 0.3 * length / (passed[1] - passed[0]);
    double expected = sqrt(atwood * g * k * tanh(k * level));
    double terminal = sqrt(2.0 * atwood / (1.0 + atwood) * g / (3.0 * k));
    printf("| %g | %d | %.2f | %.2f | %+.0f %% | %.3f | %.3f | %+.0f %% |\n", water / density,
           w->length, rate, expected, 100.0 * (rate / expected - 1.0), speed, terminal,
           100.0 * (speed / terminal - 1.0));
    fflush(stdout);
    pdyn_free(sim);
}

static void overturn(pdyn_context *context, int count, char **argument) {
    struct wave w = {.length = atoi(argument[1]), .depth = atoi(argument[2])};
    if (w.length < 10 || w.depth < 5) die("expected a WAVE of 10, a DEPTH of 5 or more");
    w.amplitude = 0.2 * w.length * d / (2.0 * pi);
    printf(
        "| density ratio | wave, d | growth, 1/s | theory | error | bubble, m/s | theory | error "
        "|\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 4; k < count; k++)
        measure_wave(context, &w, argument[0], atof(argument[3]), atof(argument[k]));
}

/* ---- momentum -------------------------------------------------------------------------------- */

static void momentum(pdyn_context *context, int count, char **argument) {
    printf("| density ratio | linear momentum | angular momentum |\n|---|---|---|\n");
    for (int k = 1; k < count; k++) {
        char left[512], right[512];
        double density = atof(argument[k]);
        snprintf(left, sizeof left,
                 "{'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.2, 0.2]}, 'velocity': [2, 0.3, "
                 "0]}");
        snprintf(right, sizeof right, BOX, 0.22, 0.1, 0.0, 0.42, 0.3, 0.2);
        pdyn_sim *sim = load_text(context,
                                  "{'duration': 1000, 'gravity': [0, 0, 0], 'time_step': {'fixed': "
                                  "0.002}, 'bodies': [" LIQUID ", " LIQUID "]}",
                                  "water", water, 0.5 * d, left, "'sound_speed': 40", "drop",
                                  density, 0.5 * d, right, "'sound_speed': 40");
        struct momenta begin = momenta_of(sim), end;
        for (int n = 0; n < atoi(argument[0]); n++) take_step(sim);
        end = momenta_of(sim);
        printf("| %g | %.1e | %.1e |\n", water / density,
               vec3_distance(end.linear, begin.linear) / begin.size,
               vec3_distance(end.angular, begin.angular) / begin.moment);
        fflush(stdout);
        pdyn_free(sim);
    }
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(pdyn_context *context, int count, char **argument);
        int least; /* arguments */
    } commands[] = {{"layers", layers, 5}, {"overturn", overturn, 5}, {"momentum", momentum, 2}};
    pdyn_context *context = make_context(1);
    for (size_t k = 0; argc > 1 && k < sizeof commands / sizeof *commands; k++)
        if (!strcmp(argv[1], commands[k].name) && argc - 2 >= commands[k].least) {
            commands[k].run(context, argc - 2, argv + 2);
            pdyn_destroy(context);
            return 0;
        }
    die("expected layers, overturn or momentum with arguments (see the head of bench/liquids.c)");
}
