/* The shipped scenes: each runs for a while, some with coarser particles. Checks that steps are
 * solved, energies, heights and density errors within bounds, the exact momentum of free fall,
 * fluid within its walls, and that there are no other warnings. PROJDYN_SHIPPED=1 prints the
 * values. Arguments K N: every N-th scene from number K on, on one thread, so that N processes
 * share the work. */
#include "support.h"

#include <string.h>

enum { SETS = 4 };

struct shipped {
    const char *name;
    double seconds;         /* simulated time, s */
    double kinetic[2];      /* bounds of the final energy, J */
    double lowest[2];       /* bounds of the lowest point of all bodies, m */
    double compression;     /* bound of the mean density error of fluids over all steps */
    double fall;            /* duration of free fall of all bodies, s; 0: none */
    double low[3], high[3]; /* bounds of the fluid, m; all 0: not checked */
    const char *set[SETS];  /* overrides of the scene */
};

#define TOP 9 /* open: water may splash out */

static const struct shipped shipped[] = {
    {.name = "ball_on_water",
     .seconds = 0.24,
     .kinetic = {0.2, 0.5},
     .lowest = {-0.0082, 0.0318},
     .compression = 9.2e-4,
     .low = {0, 0, 0},
     .high = {0.6, TOP, 0.6}},
    {.name = "balloon",
     .seconds = 0.1,
     .kinetic = {1.16, 2.91},
     .lowest = {-0.0191, 0.0209},
     .compression = 6.3e-4,
     .fall = 0.005},
    {.name = "cloth_on_mesh",
     .seconds = 0.27,
     .kinetic = {0.376, 0.94},
     .lowest = {0.507, 0.56},
     .fall = 0.05},
    {.name = "cloth_on_sphere",
     .seconds = 0.27,
     .kinetic = {0.192, 0.479},
     .lowest = {-0.0522, -0.0122},
     .fall = 0.05},
    {.name = "column",
     .seconds = 0.1,
     .kinetic = {0.247, 0.617},
     .lowest = {-0.0108, 0.0292},
     .compression = 1.3e-4,
     .low = {0, 0, 0},
     .high = {0.2, TOP, 0.2}},
    {.name = "crown",
     .seconds = 0.02,
     .kinetic = {3.6e-4, 8.9e-4},
     .lowest = {-0.0005, 0.0015},
     .compression = 8e-4,
     .low = {-0.08, 0, -0.08},
     .high = {0.08, TOP, 0.08},
     .set = {"bodies.water.particles.radius=0.001"}},
    {.name = "curtain",
     .seconds = 0.4,
     .kinetic = {2.14, 5.35},
     .lowest = {-0.0179, 0.0221},
     .compression = 6.8e-4,
     .low = {0, 0, 0},
     .high = {0.7, TOP, 0.18}},
    {.name = "cushion", .seconds = 0.4, .kinetic = {0.27, 0.67}, .lowest = {0, 0.02}},
    {.name = "dam_break",
     .seconds = 0.25,
     .kinetic = {65.8, 164},
     .lowest = {-0.0123, 0.0277},
     .compression = 1.0e-4,
     .low = {0, 0, 0},
     .high = {1.6, TOP, 0.5}},
    {.name = "dominoes", .seconds = 1.0, .kinetic = {0.0063, 0.0157}, .lowest = {-0.001, 0.002}},
    {.name = "double_dam_break",
     .seconds = 0.188,
     .kinetic = {98.7, 247},
     .lowest = {-0.0135, 0.0265},
     .compression = 5.1e-5,
     .low = {0, 0, 0},
     .high = {1.2, TOP, 0.8}},
    {.name = "dragged_cloth",
     .seconds = 0.1,
     .kinetic = {0.0289, 0.0723},
     .lowest = {-0.0129, 0.0271},
     .compression = 8.5e-4,
     .low = {0, 0, 0},
     .high = {0.6, TOP, 0.24}},
    {.name = "drops",
     .seconds = 0.05,
     .kinetic = {1e-6, 5e-6},
     .lowest = {-0.0095, -0.006},
     .compression = 4.2e-3},
    {.name = "flag", .seconds = 0.28, .kinetic = {0.22, 0.52}, .lowest = {1.05, 1.28}},
    {.name = "flag",
     .seconds = 0.3,
     .kinetic = {0.197, 0.492},
     .lowest = {1.02, 1.24},
     .set = {"solver.type=cg"}},
    {.name = "flag_in_stream",
     .seconds = 0.25,
     .kinetic = {4.8, 12},
     .lowest = {-0.0165, 0.0235},
     .compression = 4.8e-4,
     .low = {0, 0, 0},
     .high = {0.5, TOP, 0.15}},
    {.name = "floating_block",
     .seconds = 0.15,
     .kinetic = {0.247, 0.618},
     .lowest = {-0.0104, 0.0296},
     .compression = 9.6e-4,
     .low = {-0.3, 0, -0.15},
     .high = {0.3, TOP, 0.15}},
    {.name = "hammock",
     .seconds = 0.4,
     .kinetic = {1.51, 3.79},
     .lowest = {-0.344, -0.282},
     .compression = 1.6e-3},
    {.name = "hanging_cloth", .seconds = 1, .kinetic = {0.0284, 0.071}, .lowest = {1.21, 1.48}},
    {.name = "honey",
     .seconds = 0.6,
     .kinetic = {0.00083, 0.0021},
     .lowest = {-0.001, 0.004},
     .compression = 4e-4,
     .low = {-0.12, 0, -0.12},
     .high = {0.12, TOP, 0.12}},
    {.name = "honey_on_cloth",
     .seconds = 0.3,
     .kinetic = {0.178, 0.445},
     .lowest = {0, 0.02},
     .compression = 7.2e-5,
     .low = {-0.5, 0, -0.5},
     .high = {0.5, TOP, 0.5}},
    {.name = "inlet",
     .seconds = 0.5,
     .kinetic = {3.46, 8.66},
     .lowest = {-0.0193, 0.0207},
     .compression = 4.8e-6,
     .low = {0, 0, 0},
     .high = {0.8, 0.5, 0.4}},
    {.name = "laundry",
     .seconds = 0.5,
     .kinetic = {1.43, 3.57},
     .lowest = {-0.264, -0.224},
     .compression = 1.8e-3,
     .low = {-0.25, -0.25, -0.12},
     .high = {0.25, 0.25, 0.12}},
    {.name = "log_jam",
     .seconds = 0.5,
     .kinetic = {15.3, 38.4},
     .lowest = {-0.263, -0.223},
     .compression = 6.5e-4,
     .low = {-0.85, -1, -0.3},
     .high = {1, TOP, 0.3},
     .set = {"bodies.river.particles.radius=0.025"}},
    {.name = "oil_on_water",
     .seconds = 0.3,
     .kinetic = {0.588, 1.47},
     .lowest = {-0.012, 0.028},
     .compression = 8.2e-4,
     .low = {0, 0, 0},
     .high = {0.56, TOP, 0.32}},
    {.name = "paddle",
     .seconds = 0.5,
     .kinetic = {1.21, 3.01},
     .lowest = {-0.0134, 0.0266},
     .compression = 2.8e-4,
     .low = {-0.3, 0, -0.3},
     .high = {0.3, TOP, 0.3}},
    {.name = "pool_in_cloth",
     .seconds = 0.2,
     .kinetic = {13.7, 34.1},
     .lowest = {-0.207, -0.168},
     .compression = 1.9e-3},
    {.name = "rafts",
     .seconds = 0.16,
     .kinetic = {1.4, 3.4},
     .lowest = {-0.01, 0.03},
     .compression = 1.4e-4,
     .low = {-0.4, 0, -0.25},
     .high = {0.4, TOP, 0.25}},
    {.name = "sinking_cloth",
     .seconds = 0.19,
     .kinetic = {0.0137, 0.0343},
     .lowest = {-0.013, 0.027},
     .compression = 8.1e-4,
     .low = {-0.1, 0, -0.1},
     .high = {0.1, TOP, 0.1},
     .set = {"bodies.water.particles.radius=0.0075"}},
    {.name = "slung_load", .seconds = 0.5, .kinetic = {3.16, 7.9}, .lowest = {-0.996, -0.823}},
    {.name = "soft_ball",
     .seconds = 0.152,
     .kinetic = {41.2, 103},
     .lowest = {-0.0042, 0.0358},
     .compression = 4.4e-5,
     .low = {0, 0, 0},
     .high = {1.4, TOP, 0.6}},
    {.name = "soft_knots", .seconds = 0.2, .kinetic = {6, 15}, .lowest = {0, 0.012}, .fall = 0.07},
    {.name = "strainer",
     .seconds = 0.25,
     .kinetic = {7.4, 18.3},
     .lowest = {0.11, 0.15},
     .compression = 2.4e-4,
     .low = {-0.27, 0, -0.27},
     .high = {0.27, TOP, 0.27}},
    {.name = "stacked_sheets",
     .seconds = 0.23,
     .kinetic = {0.205, 0.513},
     .lowest = {-0.0169, 0.0231},
     .fall = 0.05},
    {.name = "tablecloth",
     .seconds = 0.36,
     .kinetic = {0.258, 0.644},
     .lowest = {-0.0754, -0.0354}},
    {.name = "taut_bag",
     .seconds = 0.3,
     .kinetic = {0.00601, 0.015},
     .lowest = {0.172, 0.21},
     .compression = 1.1e-3},
    {.name = "three_dragons",
     .seconds = 0.3,
     .kinetic = {3.93e+03, 9.81e+03},
     .lowest = {0.0184, 0.0584},
     .compression = 6.6e-4,
     .low = {0, 0, 0},
     .high = {4, TOP, 2},
     .set = {"bodies.water.particles.radius=0.05"}},
    {.name = "trawl",
     .seconds = 0.5,
     .kinetic = {0.58, 1.46},
     .lowest = {0.0034, 0.0434},
     .compression = 9.9e-4,
     .low = {-0.6, 0, -0.2},
     .high = {1.2, TOP, 0.2},
     .set = {"bodies.water.particles.radius=0.025"}},
    {.name = "twist", .seconds = 0.3, .kinetic = {0.00154, 0.00384}, .lowest = {0.81, 0.99}},
    {.name = "underwater_curtain",
     .seconds = 0.2,
     .kinetic = {0.086, 0.215},
     .lowest = {-0.0132, 0.0268},
     .compression = 7.7e-4,
     .low = {0, 0, 0},
     .high = {0.4, TOP, 0.195}},
    {.name = "waterwheel",
     .seconds = 0.8,
     .kinetic = {7.2, 17.9},
     .lowest = {-0.31, 0.02},
     .compression = 1.7e-4,
     .low = {-0.5, -TOP, -0.125},
     .high = {TOP, TOP, 0.125}},
    {.name = "wet_cloth",
     .seconds = 0.6,
     .kinetic = {0.0356, 0.089},
     .lowest = {-0.0105, 0.0295},
     .compression = 1.8e-3,
     .low = {-0.2, 0, -0.2},
     .high = {0.2, TOP, 0.2}},
    {.name = "water_cannon",
     .seconds = 0.5,
     .kinetic = {290, 690},
     .lowest = {-0.01, 0.02},
     .compression = 3.2e-4},
    {.name = "water_on_cloth",
     .seconds = 0.15,
     .kinetic = {4.4, 10.9},
     .lowest = {0.105, 0.145},
     .compression = 4.1e-4,
     .low = {-0.55, 0, -0.55},
     .high = {0.55, TOP, 0.55},
     .set = {"bodies.water.particles.radius=0.0125"}},
};

struct found {
    int steps, unsolved;
    double kinetic, lowest, compression;
};

static pdyn_sim *load(pdyn_context *context, const struct shipped *s, double *tolerance) {
    char path[1024];
    pdyn_sim *sim = NULL;
    int sets = 0;
    while (sets < SETS && s->set[sets]) sets++;
    snprintf(path, sizeof path, "%s/scenes/%s.json", getenv("PROJDYN_SOURCE_ROOT"), s->name);
    if (pdyn_load(context, path, s->set, sets, &sim) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(context));
    *tolerance = sim->scene.settings.tolerance;
    return sim;
}

static double mass_of(const pdyn_state *state) {
    double mass = 0.0;
    for (int i = 0; i < state->particles; i++) mass += state->mass[i];
    return mass;
}

/* The vertical momentum of free fall is exact. */
static void check_fall(const struct shipped *s, const pdyn_state *state, const double *start,
                       const pdyn_step_info *info) {
    double expected = *start - 9.81 * info->time * mass_of(state);
    if (info->time < s->fall && fabs(info->momentum[1] - expected) > 1e-9 * fabs(expected))
        fail_msg("%s, %g s: momentum %.12g, expected %.12g kg m/s", s->name, info->time,
                 info->momentum[1], expected);
}

static void check_walls(const struct shipped *s, const pdyn_sim *sim, const pdyn_state *state) {
    for (int b = 0; b < state->bodies && s->low[0] < s->high[0]; b++) {
        pdyn_body_info body = pdyn_get_body(sim, b);
        for (int i = body.first; body.radius > 0.0 && i < body.first + body.count; i++)
            for (int a = 0; a < 3; a++) {
                double x = state->x[3 * i + a];
                if (state->live && !state->live[i]) continue;
                if (!(x > s->low[a] - body.radius && x < s->high[a] + body.radius))
                    fail_msg("%s: particle %d leaked to %g m along axis %d", s->name, i, x, a);
            }
    }
}

static double lowest_of(const pdyn_state *state) {
    double low = INFINITY;
    for (int i = 0; i < state->particles; i++)
        if (!state->live || state->live[i]) low = fmin(low, state->x[3 * i + 1]);
    return low;
}

/* Unsolved steps are counted by check(). */
static void check_warnings(const struct shipped *s, const pdyn_sim *sim) {
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++)
        if (strcmp(w.code, "unsolved"))
            fail_msg("%s: warning: %s: %s [%s]", s->name, w.subject, w.text, w.code);
}

static void run(const struct shipped *s, struct found *found) {
    pdyn_context *context = test_context(1);
    pdyn_step_info info;
    double tolerance, start = 0.0;
    pdyn_sim *sim = load(context, s, &tolerance);
    pdyn_state state = pdyn_get_state(sim);
    for (int i = 0; i < state.particles; i++) start += state.mass[i] * state.v[3 * i + 1];
    *found = (struct found){0};
    while (pdyn_time(sim) < s->seconds - 1e-9) {
        if (pdyn_step(sim, &info) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
        found->steps++, found->unsolved += info.step_residual > tolerance;
        found->compression += info.density_error_mean;
        check_fall(s, &state, &start, &info);
    }
    found->compression /= found->steps;
    check_walls(s, sim, &state);
    check_warnings(s, sim);
    found->kinetic = info.kinetic_energy, found->lowest = lowest_of(&state);
    test_close(sim);
}

static void check(const struct shipped *s) {
    struct found f;
    run(s, &f);
    if (getenv("PROJDYN_SHIPPED"))
        printf("%-18s %4d steps, %d unsolved, kinetic %.4g J, lowest %.4f m, compression %.2g\n",
               s->name, f.steps, f.unsolved, f.kinetic, f.lowest, f.compression);
    else if (f.unsolved > 1 && 100 * f.unsolved > f.steps)
        fail_msg("%s: %d of %d steps are unsolved", s->name, f.unsolved, f.steps);
    else if (!(f.kinetic >= s->kinetic[0] && f.kinetic <= s->kinetic[1]))
        fail_msg("%s: kinetic energy %g J, expected %g to %g", s->name, f.kinetic, s->kinetic[0],
                 s->kinetic[1]);
    else if (!(f.lowest >= s->lowest[0] && f.lowest <= s->lowest[1]))
        fail_msg("%s: lowest point at %g m, expected %g to %g", s->name, f.lowest, s->lowest[0],
                 s->lowest[1]);
    else if (!(f.compression <= s->compression))
        fail_msg("%s: mean density error %g, expected at most %g", s->name, f.compression,
                 s->compression);
}

static size_t first = 0, stride = 1;

static void test_shipped(void **state) {
    (void)state;
    for (size_t k = first; k < sizeof shipped / sizeof *shipped; k += stride) check(&shipped[k]);
}

int main(int argc, char **argv) {
    if (argc == 3) first = strtoul(argv[1], NULL, 10), stride = strtoul(argv[2], NULL, 10);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shipped)};
    return cmocka_run_group_tests_name("shipped", tests, NULL, NULL);
}
