/* A closed bag, a sphere at rest, with more water than its rest volume, without gravity. The water
 * should fill it at the Laplace pressure p = 2 T / R: T = K (l - 1) / l the tension of the membrane
 * at the stretch l in both directions, R the radius of a sphere of the same volume. */
#include "interface.h"

#include "projdyn/control.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>

static const double stiffness = 500.0, area_density = 0.3; /* N/m, kg/m^2 */
static const double pi = 3.14159265358979;
static const double thick = 0.5;     /* XSPH's viscosity */
static const double contact = 0.001; /* m */

struct bag {
    double d, radius, fill; /* m, m; volume of the water over that of the bag at rest */
    double middle[3];       /* m, of the lattice */
    double lattice;         /* radius of the lattice's part that is water, m */
    double area;            /* of the mesh at rest, m^2 */
};

static bool keep(const void *user, double x[3]) {
    const struct bag *b = user;
    double r[3] = {x[0] - b->middle[0], x[1] - b->middle[1], x[2] - b->middle[2]};
    return vec3_length(r) < b->lattice;
}

/* Scales all positions about the origin. */
static void scale_all(pdyn_sim *sim, double factor) {
    const pdyn_state s = pdyn_get_state(sim);
    double *x = malloc(3 * (size_t)s.particles * sizeof *x);
    if (!x) die("out of memory");
    for (int k = 0; k < 3 * s.particles; k++) x[k] = factor * s.x[k];
    if (pdyn_set_positions(sim, 0, s.particles, x) != PDYN_OK) die("positions");
    free(x);
}

/* In the scene the bag is at rest and the lattice is shrunk, so that it keeps 0.7 spacings from the
 * bag. The run begins with both scaled so that the lattice has its spacing and the bag is taut. */
static pdyn_sim *load_bag(const struct job *job, struct bag *b) {
    char water[4096], mesh[4096];
    static struct scene s;
    b->lattice = b->radius * cbrt(b->fill);
    int n = 2 * (int)ceil(b->lattice / b->d), cells[3] = {n, n, n};
    for (int k = 0; k < 3; k++) b->middle[k] = 0.5 * n * b->d;
    double shrunk = fmin(1.0, (b->radius - 0.7 * b->d) / b->lattice), pressure = 0.2 * stiffness;
    lattice_write(job_file(job, "bag.ply", water), b->d, cells, keep, b);
    sphere_write(job_file(job, "bag.obj", mesh), (int)ceil(1.6 * b->radius / b->d), b->radius);
    scene_start(&s, ordinary, contact);
    scene_put(&s, "'gravity': [0, 0, 0], ");
    pressure /= b->radius;
    scene_water(&s, b->d, pressure / (density * g), thick,
                "{'file': '%s', 'scale': %.17g, 'translate': [%.17g, %.17g, %.17g]}", water, shrunk,
                -shrunk * b->middle[0], -shrunk * b->middle[1], -shrunk * b->middle[2]);
    scene_sheet(&s, mesh, area_density);
    scene_put(&s,
              "'constraints': [{'type': 'triangle', 'stretching_stiffness': %g, 'damping': 0.01}, "
              "{'type': 'bending', 'bending_rigidity': 1e-5}]}]}",
              stiffness);
    pdyn_sim *sim = scene_load(job, &s);
    b->area = body_area(sim, 1);
    scale_all(sim, 1.0 / shrunk);
    return sim;
}

struct found {
    struct sample water, stretch, inside, laplace, scatter; /* volume share; 1; Pa, Pa, Pa */
};

static void add_state(struct found *f, const struct bag *b, const pdyn_sim *sim, double h) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info w = pdyn_get_body(sim, 0);
    double volume = body_volume(sim, 1), stretch = sqrt(body_area(sim, 1) / b->area);
    double radius = cbrt(0.75 / pi * volume), middle[3], d3 = b->d * b->d * b->d;
    struct sample pressure = {0};
    body_middle(sim, 1, middle);
    for (int i = w.first; i < w.first + w.count; i++)
        if (vec3_distance(s.x + 3 * i, middle) < radius - 3.0 * b->d)
            sample_add(&pressure, 1.0, s.pressure[i]);
    sample_add(&f->water, h, w.count * d3 / volume), sample_add(&f->stretch, h, stretch);
    sample_add(&f->inside, h, sample_mean(&pressure));
    sample_add(&f->scatter, h, sample_deviation(&pressure));
    sample_add(&f->laplace, h, 2.0 * stiffness * (stretch - 1.0) / stretch / radius);
}

/* Number of particles outside the bag: farther from its centre than the farthest vertex. */
static int lost(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info w = pdyn_get_body(sim, 0), bag = pdyn_get_body(sim, 1);
    double middle[3], farthest = 0.0;
    int count = 0;
    body_middle(sim, 1, middle);
    for (int i = bag.first; i < bag.first + bag.count; i++)
        farthest = fmax(farthest, vec3_distance(s.x + 3 * i, middle));
    for (int i = w.first; i < w.first + w.count; i++)
        count += vec3_distance(s.x + 3 * i, middle) > farthest;
    return count;
}

static void run(const struct job *job, FILE *csv, struct bag *b, double seconds) {
    pdyn_sim *sim = load_bag(job, b);
    struct found found = {0};
    while (pdyn_time(sim) < seconds) {
        struct found now = {0};
        pdyn_step_info info = take_step(sim);
        add_state(&now, b, sim, 1.0);
        fprintf(csv, "%g,%g,%.6g,%.6g,%.6g,%.6g,%.6g,%.4g\n", b->radius / b->d, b->fill, info.time,
                now.water.sum, now.stretch.sum, now.inside.sum, now.laplace.sum,
                info.step_residual);
        if (info.time > 0.6 * seconds) add_state(&found, b, sim, info.h);
    }
    double inside = sample_mean(&found.inside), laplace = sample_mean(&found.laplace);
    printf("| %g | %g | %g | %d | %.3f | %.3f | %.1f | %.1f | %.3f | %.1f %% | %d |\n", 1e3 * b->d,
           b->radius / b->d, b->fill, pdyn_get_body(sim, 0).count, sample_mean(&found.water),
           sample_mean(&found.stretch), inside, laplace, inside / laplace,
           100.0 * sample_mean(&found.scatter) / inside, lost(sim));
    fflush(stdout);
    pdyn_free(sim);
}

/* SECONDS MM FILL RADIUS... */
void bag(const struct job *job) {
    double seconds = job_number(job, 0, 1.0), d = 1e-3 * job_number(job, 1, 12.5);
    double fill = job_number(job, 2, 1.1);
    FILE *csv = open_csv(job->directory, "bag");
    fprintf(csv, "radius_d,fill,time_s,water_over_bag,stretch,inside_Pa,laplace_Pa,residual\n");
    printf("| d, mm | radius at rest, d | water over bag at rest | particles | water over bag | "
           "stretch | pressure inside, Pa | 2 T / R, Pa | ratio | scatter | particles lost "
           "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 3; k < job->count; k++) {
        struct bag b = {.d = d, .radius = job_number(job, k, 8.0) * d, .fill = fill};
        run(job, csv, &b, seconds);
    }
    fclose(csv);
}
