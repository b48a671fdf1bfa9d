/* Water at rest in a tank: mean pressure against rho g depth and its scatter inside, and at floor,
 * walls, edges and corners, over the last part of a run. Layers are one spacing thick; "at a wall"
 * is within a spacing of it, "inside" farther than two spacings from all. */
#include "interface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double d = 0.02; /* m, particle spacing */

/* Sums over particles of a state or a run: number, height in m, pressure in Pa, pressure + rho g
 * height (constant over a layer at rest). */
struct sums {
    double n, y, pressure, level, squares;
};

struct layer {
    struct sums inside, all; /* of the run */
    double scatter[2];       /* inside; all: sums of (pressure - mean of its layer)^2 */
};

/* At the floor: away from walls, at one wall, at two. Above it: at one wall, at two. */
enum { FLOOR, FLOOR_EDGE, CORNER, WALL, EDGE, PLACES };

struct rest {
    int cells[3];
    int layers;
    struct layer *layer;
    struct sums *inside, *all; /* of a state: layers */
    /* Over a run: pressures at the walls, and inside at the same heights. */
    double pressure[PLACES], expected[PLACES], n[PLACES];
};

static void *zeros(int count, size_t size) {
    void *block = calloc((size_t)count, size);
    if (!block) die("out of memory");
    return block;
}

static void add(struct sums *s, double y, double pressure) {
    double level = pressure + density * g * y;
    s->n++, s->y += y, s->pressure += pressure, s->level += level, s->squares += level * level;
}

/* Distances to the nearest walls in x and z, m. */
static void to_walls(const struct rest *r, const double x[3], double distance[2]) {
    for (int k = 0; k < 2; k++) distance[k] = fmin(x[2 * k], r->cells[2 * k] * d - x[2 * k]);
}

static int layer_of(const struct rest *r, double y) {
    return (int)fmin(fmax(0.0, y / d), r->layers - 1.0);
}

static void sort_into_layers(struct rest *r, const pdyn_state *s) {
    memset(r->inside, 0, (size_t)r->layers * sizeof *r->inside);
    memset(r->all, 0, (size_t)r->layers * sizeof *r->all);
    for (int i = 0; i < s->particles; i++) {
        double wall[2];
        const double *x = s->x + 3 * i;
        if (s->live && !s->live[i]) continue;
        int k = layer_of(r, x[1]);
        to_walls(r, x, wall);
        add(&r->all[k], x[1], s->pressure[i]);
        if (fmin(wall[0], wall[1]) > 2.0 * d) add(&r->inside[k], x[1], s->pressure[i]);
    }
}

static double spread(const struct sums *s) {
    return s->n > 0.0 ? s->squares - s->level * s->level / s->n : 0.0;
}

static void merge(struct sums *s, const struct sums *more) {
    s->n += more->n, s->y += more->y, s->pressure += more->pressure, s->level += more->level;
}

/* Particles at walls, edges and corners; above the floor only those five spacings below the
 * surface. */
static void add_places(struct rest *r, const pdyn_state *s) {
    double deepest = (r->cells[1] - 5) * d;
    for (int i = 0; i < s->particles; i++) {
        double wall[2];
        const double *x = s->x + 3 * i;
        if ((s->live && !s->live[i]) || x[1] > deepest) continue;
        const struct sums *inside = &r->inside[layer_of(r, x[1])];
        to_walls(r, x, wall);
        int walls = (wall[0] < d) + (wall[1] < d);
        bool floor = x[1] < d;
        int place = floor ? FLOOR + walls : WALL + walls - 1;
        if (walls == 0 && (!floor || fmin(wall[0], wall[1]) < 2.0 * d)) continue;
        r->n[place]++, r->pressure[place] += s->pressure[i];
        r->expected[place] += inside->level / inside->n - density * g * x[1];
    }
}

static void add_state(struct rest *r, const pdyn_state *s) {
    sort_into_layers(r, s);
    for (int k = 0; k < r->layers; k++) {
        struct layer *l = &r->layer[k];
        merge(&l->inside, &r->inside[k]), merge(&l->all, &r->all[k]);
        l->scatter[0] += spread(&r->inside[k]), l->scatter[1] += spread(&r->all[k]);
    }
    add_places(r, s);
}

static pdyn_sim *load_tank(const struct job *job, const struct rest *r) {
    static struct scene s;
    const int *n = r->cells;
    scene_start(&s, ordinary, 0.0);
    scene_water(&s, d, n[1] * d, calming,
                "{'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, %.17g]}}", n[0] * d,
                n[1] * d, n[2] * d);
    scene_tank(&s, n[0] * d, (n[1] + 10) * d, n[2] * d);
    return scene_load(job, &s);
}

/* Writes the profile; returns the largest relative deviation of a layer at least four spacings from
 * floor and surface. Expected pressure: weight above the layer. */
static double write_profile(const struct job *job, struct rest *r, double states,
                            double *floor_pressure) {
    double above = 0.0, worst = 0.0, full = states * r->cells[0] * r->cells[2];
    FILE *csv = open_csv(job->directory, "tank");
    fprintf(csv, "depth_m,rho_g_depth_Pa,inside_Pa,all_Pa,scatter_inside_Pa,scatter_all_Pa\n");
    for (int k = r->layers - 1; k >= 0; k--) {
        const struct layer *l = &r->layer[k];
        double depth = (above + 0.5 * l->all.n) / full * d, expected = density * g * depth;
        above += l->all.n;
        if (l->inside.n < 1.0) continue;
        double inside = l->inside.pressure / l->inside.n;
        fprintf(csv, "%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", depth, expected, inside,
                l->all.pressure / l->all.n, sqrt(l->scatter[0] / l->inside.n),
                sqrt(l->scatter[1] / l->all.n));
        if (depth > 4.0 * d && k >= 4 && fabs(inside / expected - 1.0) > fabs(worst))
            worst = inside / expected - 1.0;
        if (k == 0) *floor_pressure = expected;
    }
    fclose(csv);
    return worst;
}

/* Mean of deviation over mean, over layers at least five spacings deep. */
static double scatter(const struct rest *r, bool all) {
    struct sample s = {0};
    for (int k = 0; k < r->cells[1] - 5; k++) {
        const struct layer *l = &r->layer[k];
        const struct sums *sums = all ? &l->all : &l->inside;
        if (sums->n > 0.0) sample_add(&s, 1.0, sqrt(l->scatter[all] * sums->n) / sums->pressure);
    }
    return sample_mean(&s);
}

static void print(const struct rest *r, double worst, double floor_pressure, double ms) {
    printf("| %d x %d x %d | %+.1f %% |", r->cells[0], r->cells[1], r->cells[2], 100.0 * worst);
    for (int k = FLOOR; k <= CORNER; k++)
        printf(" %+.1f %% |", 100.0 * (r->pressure[k] / r->n[k] / floor_pressure - 1.0));
    for (int k = WALL; k <= EDGE; k++)
        printf(" %+.1f %% |", 100.0 * (r->pressure[k] / r->expected[k] - 1.0));
    printf(" %.1f %% | %.1f %% | %.1f |\n", 100.0 * scatter(r, false), 100.0 * scatter(r, true),
           ms);
    fflush(stdout);
}

static void run(const struct job *job, struct rest *r, double seconds) {
    pdyn_sim *sim = load_tank(job, r);
    const pdyn_state state = pdyn_get_state(sim);
    double states = 0.0, steps = 0.0, ms = 0.0, floor_pressure = NAN;
    r->layers = r->cells[1] + 5;
    r->layer = zeros(r->layers, sizeof *r->layer);
    r->inside = zeros(r->layers, sizeof *r->inside), r->all = zeros(r->layers, sizeof *r->all);
    while (pdyn_time(sim) < seconds) {
        pdyn_step_info info = take_step(sim);
        steps++, ms += info.ms_cpu;
        if (info.time < 0.6 * seconds) continue;
        add_state(r, &state);
        states++;
    }
    double worst = write_profile(job, r, states, &floor_pressure);
    print(r, worst, floor_pressure, ms / steps);
    free(r->layer), free(r->inside), free(r->all);
    pdyn_free(sim);
}

/* SECONDS WIDTHxDEPTH... */
void tank(const struct job *job) {
    double seconds = job_number(job, 0, 1.0);
    printf("| particles | worst layer inside | floor | floor at a wall | corner | wall | edge of "
           "walls | scatter in a layer inside | in a whole layer | ms a step "
           "|\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 1; k < job->count; k++) {
        int width, depth;
        if (sscanf(job->argument[k], "%dx%d", &width, &depth) != 2 || width < 6 || depth < 12)
            die("expected WIDTHxDEPTH of 6x12 or more, found %s", job->argument[k]);
        struct rest r = {.cells = {width, depth, width}};
        run(job, &r, seconds);
    }
}
