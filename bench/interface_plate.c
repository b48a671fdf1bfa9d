/* A clamped plate under water: aluminium, 1 m long, 0.05 m thick, under 2 m of water, in a slice a
 * few particles wide. The deflection of its middle is q L^4 / (384 D) = 6.860e-5 m, q: load of
 * water and plate. */
#include "interface.h"

#include <math.h>

static const double length = 1.0, thickness = 0.05, depth = 2.0;            /* m */
static const double modulus = 67.5e9, poisson = 0.34, plate_density = 2700; /* Pa, 1, kg/m^3 */
static const double exact = 6.860e-5;                                       /* m */
enum { SLICE = 4 };                                                         /* spacings */

struct plate {
    double d, segment; /* m */
    int segments;      /* of the free length */
};

/* Two rows at each end are pinned: the clamp lies in their middle. The walls extend below the
 * plate: with borders at its height, water would be pressed down along them. */
static void place(const void *user, double s, double t, double x[3]) {
    const struct plate *p = user;
    x[0] = s * (length + p->segment) - 0.5 * p->segment;
    x[1] = 0.0;
    x[2] = t * SLICE * p->d;
}

static pdyn_sim *load_plate(const struct job *job, struct plate *p) {
    char sheet[4096];
    static struct scene s;
    double rigidity =
        modulus * thickness * thickness * thickness / 12.0 / (1.0 - poisson * poisson);
    double z = SLICE * p->d;
    p->segments = (int)floor(0.5 * length / p->d + 0.5) * 2 + 1;
    p->segment = length / p->segments;
    sheet_write(job_file(job, "plate.obj", sheet), p->segments + 1, SLICE, place, p);
    scene_start(&s, ordinary, 0.0);
    scene_put(&s,
              "'solver': {'tolerance': %.17g, 'linear_tolerance': 0.01, 'outer_iterations': "
              "50, 'linear_iterations': 5000}, ",
              job->tolerance);
    scene_water(&s, p->d, depth, calming,
                "{'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, %.17g]}}", length, depth,
                z);
    scene_sheet(&s, sheet, plate_density * thickness);
    scene_put(
        &s,
        "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1e8}, {'type': "
        "'bending', 'bending_rigidity': %.17g}, {'type': 'pin', 'stiffness': 1e12, "
        "'vertices': [{'box': {'minimum': [-1, -1, -1], 'maximum': [%.17g, 1, 9]}}, {'box': "
        "{'minimum': [%.17g, -1, -1], 'maximum': [9, 1, 9]}}]}]}], 'solids': [{'box': "
        "{'minimum': [0, -0.1, 0], 'maximum': [%.17g, %.17g, %.17g]}, 'open': ['+y', '-y']}], "
        "'outlets': [{'box': {'minimum': [-1, -0.5, -1], 'maximum': [2, 4, 2]}, 'outside': true}]}",
        rigidity, 0.6 * p->segment, length - 0.6 * p->segment, length, depth + 0.5, z);
    return scene_load(job, &s);
}

/* Deflection of the middle row relative to its neighbours, m. */
static double sunk(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, 1);
    int rows = b.count / (SLICE + 1), middle = b.first + rows / 2 * (SLICE + 1);
    double sum = 0.0;
    for (int j = 0; j <= SLICE; j++)
        sum -= s.x[3 * (middle + j) + 1] + (rows % 2 ? 0.0 : s.x[3 * (middle - SLICE - 1 + j) + 1]);
    return sum / (SLICE + 1) / (rows % 2 ? 1.0 : 2.0);
}

static void run(const struct job *job, FILE *csv, struct plate *p, double seconds) {
    pdyn_sim *sim = load_plate(job, p);
    double weight = body_weight(sim, 0) + body_weight(sim, 1), steps = 0.0, unsolved = 0.0;
    double ms = 0.0;
    struct sample down = {0}, pins = {0};
    while (pdyn_time(sim) < seconds) {
        pdyn_step_info info = take_step(sim);
        fprintf(csv, "%g,%.6g,%.6g,%.6g,%.4g\n", 1e3 * p->d, info.time, sunk(sim),
                info.pin_reaction[1] / weight, info.step_residual);
        steps++, unsolved += info.step_residual > job->tolerance, ms += info.ms_cpu;
        if (info.time < 0.6 * seconds) continue;
        sample_add(&down, info.h, sunk(sim));
        sample_add(&pins, info.h, info.pin_reaction[1] / weight);
    }
    printf("| %g | %d | %.3e | %.3e | %+.1f %% | %.1f %% | %.4f | %.0f %% | %.1f |\n", 1e3 * p->d,
           pdyn_get_body(sim, 0).live, sample_mean(&down), exact,
           100.0 * (sample_mean(&down) / exact - 1.0), 100.0 * sample_deviation(&down) / exact,
           sample_mean(&pins), 100.0 * unsolved / steps, ms / steps);
    fflush(stdout);
    pdyn_free(sim);
}

/* SECONDS MM... */
void plate(const struct job *job) {
    double seconds = job_number(job, 0, 1.0);
    FILE *csv = open_csv(job->directory, "plate");
    fprintf(csv, "spacing_mm,time_s,sunk_m,pins_over_weight,residual\n");
    printf(
        "| d, mm | particles | middle sunk by, m | exact | deviation | standard deviation | pins "
        "over weight | unsolved | ms a step |\n|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 1; k < job->count; k++) {
        struct plate p = {.d = 1e-3 * job_number(job, k, 50.0)};
        run(job, csv, &p, seconds);
    }
    fclose(csv);
}
