/* Water at rest in a tank: pressure against rho g depth, compression, kinetic energy, cost of a
 * step. */
#include "validation.h"

#include <math.h>
#include <stdlib.h>

struct layer { /* of particles, one spacing thick: sums over the last second */
    double count, pressure, density;
    double depth; /* height of a column of water with the weight above the layer's middle, m */
};

struct rest {
    struct water water;
    char name[64];
    struct layer *layer;         /* water.cells[1] + 1, from the floor up */
    double surface;              /* m */
    double steps, outer, linear; /* means over the last second */
    double kinetic, potential;   /* J, means over the last second */
    double density_error;        /* at the end */
};

/* Surface height: half a spacing above the median of as many of the highest particles as a layer
 * has. */
static double surface_height(const struct rest *r, const pdyn_state *s) {
    int layer = r->water.cells[0] * r->water.cells[2];
    double *y = allocate((size_t)s->particles, sizeof *y);
    for (int i = 0; i < s->particles; i++) y[i] = s->x[3 * i + 1];
    sort(y, s->particles);
    double middle = y[s->particles - layer / 2];
    free(y);
    return middle + 0.5 * r->water.spacing;
}

static void add_layers(struct rest *r, const pdyn_state *s) {
    for (int i = 0; i < s->particles; i++) {
        double y = s->x[3 * i + 1];
        int k = (int)fmax(0.0, y / r->water.spacing);
        if (k > r->water.cells[1]) die("a particle has left the water");
        struct layer *layer = &r->layer[k];
        layer->count++;
        layer->pressure += s->pressure[i], layer->density += s->density[i];
    }
}

static void add_step(struct rest *r, const pdyn_step_info *info) {
    r->steps++, r->outer += info->outer_iterations, r->linear += info->linear_iterations;
    r->kinetic += info->kinetic_energy, r->potential += info->potential_energy;
    r->density_error = info->density_error_mean;
}

static void find_depths(struct rest *r) {
    double above = 0.0, full = r->steps * r->water.cells[0] * r->water.cells[2];
    for (int k = r->water.cells[1]; k >= 0; k--) {
        struct layer *layer = &r->layer[k];
        layer->depth = (above + 0.5 * layer->count) / full * r->water.spacing;
        above += layer->count;
    }
}

static void settle(struct rest *r, pdyn_context *context, const char *directory) {
    char name[80];
    pdyn_sim *sim = water_load(context, &r->water);
    const pdyn_state state = pdyn_get_state(sim);
    snprintf(name, sizeof name, "%s_steps", r->name);
    FILE *csv = open_csv(directory, name);
    fprintf(csv, "time_s,kinetic_J,surface_m,density_error_mean,outer,linear,residual\n");
    while (pdyn_time(sim) < r->water.duration) {
        pdyn_step_info info = take_step(sim);
        r->surface = surface_height(r, &state);
        fprintf(csv, "%.6g,%.6g,%.9g,%.6g,%d,%d,%.4g\n", info.time, info.kinetic_energy, r->surface,
                info.density_error_mean, info.outer_iterations, info.linear_iterations,
                info.step_residual);
        if (info.time < r->water.duration - 1.0) continue;
        add_step(r, &info);
        add_layers(r, &state);
    }
    fclose(csv);
    pdyn_free(sim);
    find_depths(r);
}

/* Far from surface and floor: at least two support radii, four spacings. */
static bool inside(const struct rest *r, double depth) {
    double away = 4.0 * r->water.spacing;
    return depth > away && r->water.cells[1] * r->water.spacing - depth > away;
}

/* Writes the profile; returns the largest relative pressure deviation of a layer inside. */
static double write_profile(const struct rest *r, const char *directory) {
    double worst = 0.0;
    FILE *csv = open_csv(directory, r->name);
    fprintf(csv, "depth_m,pressure_Pa,rho_g_depth_Pa,density_kg_m3\n");
    for (int k = 0; k <= r->water.cells[1]; k++) {
        const struct layer *l = &r->layer[k];
        if (l->count == 0.0) continue;
        double depth = l->depth, pressure = l->pressure / l->count;
        double expected = DENSITY * g * depth;
        fprintf(csv, "%.9g,%.9g,%.9g,%.9g\n", depth, pressure, expected, l->density / l->count);
        if (inside(r, depth)) worst = fmax(worst, fabs(pressure / expected - 1.0));
    }
    fclose(csv);
    return worst;
}

/* Slope of the pressure with depth over rho g, by least squares over the layers inside. */
static double relative_slope(const struct rest *r) {
    struct fit fit = {0};
    for (int k = 0; k <= r->water.cells[1]; k++) {
        const struct layer *l = &r->layer[k];
        double depth = l->depth, pressure = l->pressure / l->count;
        if (l->count != 0.0 && inside(r, depth)) fit_add(&fit, depth, pressure);
    }
    return fit_slope(&fit) / (DENSITY * g);
}

static void rest_run(pdyn_context *context, const char *directory, double seconds, int depth,
                     int width) {
    double d = 0.02;
    struct rest r = {.water = {.spacing = d,
                               .cells = {width, depth, width},
                               .tank = {width * d, (depth + 10) * d, width * d},
                               .viscosity = 0.02,
                               .step = 0.005,
                               .adaptive = true,
                               .cut_short = true,
                               .duration = seconds}};
    snprintf(r.name, sizeof r.name, "tank_%dx%d", depth, width);
    r.layer = allocate((size_t)depth + 1, sizeof *r.layer);
    settle(&r, context, directory);
    double worst = write_profile(&r, directory);
    printf("| %d x %d x %d | %.1f %% | %+.1f %% | %.2f %% | %.3f %% | %.1e | %.1f | %.0f |\n",
           width, depth, width, 100.0 * worst, 100.0 * (relative_slope(&r) - 1.0),
           100.0 * (1.0 - r.surface / (depth * d)), 100.0 * r.density_error,
           r.kinetic / r.potential, r.outer / r.steps, r.linear / r.steps);
    free(r.layer);
}

void tank(pdyn_context *context, const char *directory, double seconds, int count, char **sizes) {
    printf("| particles | pressure: worst layer | slope | volume lost | density error | kinetic / "
           "potential energy | outer | linear |\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < count; k++) {
        int depth, width;
        if (sscanf(sizes[k], "%dx%d", &depth, &width) != 2 || depth < 12 || width < 1)
            die("expected DEPTHxWIDTH, at least 12 deep, found %s", sizes[k]);
        rest_run(context, directory, seconds, depth, width);
    }
}
