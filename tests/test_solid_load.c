/* Loads on solids: balance of momentum and angular momentum in each step, weight, buoyancy,
 * friction, wrong calls. */
#include "base/registry.h"
#include "scene_support.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

#define G 9.81

static const char *scene(const char *head, const char *bodies, const char *solids) {
    static char text[8192];
    snprintf(text, sizeof text,
             "{'duration': 10, 'frame_interval': 0.1, %s, 'bodies': [%s], 'solids': [%s]}", head,
             bodies, solids);
    return quoted(text);
}

#define SOLVED                                                                                     \
    "'solver': {'tolerance': 0.01, 'linear_tolerance': 0.1, 'outer_iterations': 100}, "            \
    "'time_step': {'maximum': 0.005, 'integrator': 'euler'}"
#define POOL(box, more)                                                                            \
    "{'name': 'water', 'particles': {'radius': 0.0125, 'fill': [{'box': " box                      \
    "}]}, 'constraints': [{'type': 'fluid', 'compression': 0.001, " more "}]}"
#define DEEP "{'minimum': [0, 0, 0], 'maximum': [0.3, 0.4, 0.3]}" /* 12 x 16 x 12 particles */
#define TANK                                                                                       \
    "{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.3, 0.6, 0.3]}, 'open': ['+y']}"

struct total {
    double force[3], moment[3];
};

static void get(const pdyn_sim *sim, int solid, struct total *load) {
    assert_int_equal(pdyn_solid_load(sim, solid, load->force, load->moment), PDYN_OK);
}

/* Sum over all solids. */
static struct total add_all(const pdyn_sim *sim) {
    struct total sum = {{0}, {0}}, one;
    for (int k = 0; pdyn_solid_name(sim, k); k++) {
        get(sim, k, &one);
        vec3_add(sum.force, 1.0, one.force);
        vec3_add(sum.moment, 1.0, one.moment);
    }
    return sum;
}

static double mass_of(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    double sum = 0.0;
    for (int i = 0; i < s.particles; i++) sum += s.mass[i];
    return sum;
}

/* ---- balance --------------------------------------------------------------------------------- */

/* The expected loads of a step: with M (x - s) / h^2 + grad V = r, r the residual, the forces on
 * the solids sum to the sum of grad V. */
static struct total expected(const pdyn_sim *sim) {
    const struct objective *objective = &sim->objective;
    struct total sum = {{0}, {0}};
    for (int i = 0; i < objective->particles; i++) {
        double force[3], moment[3], w = objective->mass[i] / (objective->h * objective->h);
        for (int k = 3 * i, a = 0; a < 3; k++, a++)
            force[a] = sim->gradient[k] - w * (sim->x[k] - objective->s[k]);
        vec3_cross(moment, sim->x + 3 * i, force);
        vec3_add(sum.force, 1.0, force);
        vec3_add(sum.moment, 1.0, moment);
    }
    return sum;
}

/* weight - rate of change of momentum, up to the residual */
static void assert_momentum(const pdyn_sim *sim, const pdyn_step_info *info, const double before[3],
                            const double force[3]) {
    double left[3] = {0}, weight = G * mass_of(sim);
    for (int k = 0; k < 3 * sim->objective.particles; k++) left[k % 3] += sim->gradient[k];
    left[1] -= weight;
    for (int a = 0; a < 3; a++) left[a] -= (info->momentum[a] - before[a]) / info->h + force[a];
    if (vec3_length(left) > 1e-9 * weight)
        fail_msg("at %g s %g N of a weight of %g N are missing", info->time, vec3_length(left),
                 weight);
}

/* Takes steps, checks the balance; returns the largest force on the last solid over the weight. */
static double assert_balance(const char *text, int steps) {
    pdyn_sim *sim = test_open(text);
    double weight = G * mass_of(sim), before[3] = {0}, most = 0.0;
    for (int n = 0; n < steps; n++) {
        pdyn_step_info info = test_step(sim);
        struct total found = add_all(sim), due = expected(sim), last;
        assert_momentum(sim, &info, before, found.force);
        if (vec3_distance(found.force, due.force) > 1e-9 * weight ||
            vec3_distance(found.moment, due.moment) > 2e-7 * weight)
            fail_msg("step %d: %g N, %g N m", n, vec3_distance(found.force, due.force),
                     vec3_distance(found.moment, due.moment));
        memcpy(before, info.momentum, sizeof before);
        get(sim, sim->scene.solids - 1, &last);
        most = fmax(most, vec3_length(last.force) / weight);
    }
    test_close(sim);
    return most;
}

/* The mesh is off the origin and rotates; it precedes the tank in the scene and follows it among
 * the boundary points. */
#define PADDLE                                                                                     \
    "{'name': 'ball', 'sphere': {'center': [0.15, 0.2, 0.15], 'radius': 0.06}, 'pivot': [0.2, "    \
    "0.2, 0.15], 'motion': [{'time': 0}, {'time': 1, 'rotate': [0, 90, 0]}]}"
#define RAIN POOL("{'minimum': [0.05, 0.3, 0.05], 'maximum': [0.2, 0.5, 0.25]}", "'viscosity': 0")
/* A sheet that falls on the ball without friction, in rain. */
#define SHEET_ABOVE                                                                                \
    GRID_SHEET("'name': 'sheet', ", "0.24, 0.24", "9, 9",                                          \
               "'translate': [0.15, 0.272, 0.15], 'area_density': 0.3", SPRINGS("500"))

static void test_balance(void **state) {
    (void)state;
    double rain = assert_balance(scene(SOLVED, RAIN, PADDLE ", " TANK), 60);
    double points =
        assert_balance(scene(SOLVED ", 'boundary': 'points'", RAIN, PADDLE ", " TANK), 60);
    double dry = assert_balance(scene(SOLVED ", 'contact': {'thickness': 0.004, 'friction': 0}",
                                      SHEET_ABOVE, TANK ", " PADDLE),
                                40);
    double wet = assert_balance(scene(SOLVED ", 'contact': {'thickness': 0.004, 'friction': 0}",
                                      SHEET_ABOVE ", " RAIN, TANK ", " PADDLE),
                                20);
    print_message("largest force over weight: tank %.2f, %.2f; ball %.2f, %.2f\n", rain, points,
                  dry, wet);
    assert_true(rain > 1.0 && points > 1.0 && dry > 0.5 && wet > 0.1);
}

/* ---- weights --------------------------------------------------------------------------------- */

/* Mean load on a solid from one time to another, N. */
static struct total mean_load(pdyn_sim *sim, int solid, double from, double to) {
    struct total sum = {{0}, {0}}, one;
    double time = 0.0;
    while (pdyn_time(sim) < to) {
        pdyn_step_info info = test_step(sim);
        if (info.time < from) continue;
        get(sim, solid, &one);
        vec3_add(sum.force, info.h, one.force);
        vec3_add(sum.moment, info.h, one.moment);
        time += info.h;
    }
    for (int a = 0; a < 3; a++) sum.force[a] /= time, sum.moment[a] /= time;
    return sum;
}

/* Water at rest: the load is its weight, at its centre of mass. */
static void test_tank(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(scene("'time_step': {'maximum': 0.005}", POOL(DEEP, "'viscosity': 0.3"), TANK));
    double weight = G * mass_of(sim);
    struct total mean = mean_load(sim, 0, 0.8, 1.2);
    const double force[3] = {0, -weight, 0}, moment[3] = {0.15 * weight, 0, -0.15 * weight};
    double off = vec3_distance(mean.force, force), turned = vec3_distance(mean.moment, moment);
    print_message("weight %.3f N, missed by %.4f %%, its moment by %.4f %%\n", weight,
                  100.0 * off / weight, 100.0 * turned / (0.15 * weight));
    assert_true(off < 0.005 * weight && turned < 0.005 * 0.15 * weight);
    test_close(sim);
}

/* Centre of mass of all particles. */
static void centre_of(const pdyn_sim *sim, double centre[3]) {
    double mass = mass_of(sim);
    memset(centre, 0, 3 * sizeof *centre);
    for (int i = 0; i < sim->objective.particles; i++)
        vec3_add(centre, sim->objective.mass[i] / mass, sim->x + 3 * i);
}

/* Impacts under BDF2 in weightlessness: the impulse of the loads, and that of the body's probe, is
 * the momentum that the body loses; by symmetry the load acts below the centre of the body. */
static void assert_impulse(const char *contact, double speed, double error, const char *bodies) {
    char head[512];
    pdyn_context *c = test_context(2);
    snprintf(head, sizeof head,
             "%s'gravity': [0, 0, 0], 'time_step': {'fixed': 0.004}, "
             "'solver': {'tolerance': 0.001, 'outer_iterations': 200}, "
             "'probes': [{'name': 'push', 'body': 'it'}]",
             contact);
    pdyn_sim *sim = test_load(c, scene(head, bodies,
                                       "{'name': 'floor', 'box': {'minimum': [-0.4, -0.1, -0.4], "
                                       "'maximum': [0.7, 0, 0.7]}}"));
    double impulse = 0.0, turned[3] = {0}, pushed = 0.0, brought = speed * mass_of(sim), centre[3];
    centre_of(sim, centre);
    struct total load;
    pdyn_step_info info;
    do {
        info = test_step(sim);
        get(sim, 0, &load);
        impulse -= info.h * load.force[1];
        vec3_add(turned, info.h, load.moment);
        pushed += info.h * pdyn_get_probe(sim, 0).value[1];
    } while (info.time < 0.4);
    double lost = brought + info.momentum[1];
    print_message("impulse %.4f, of the body %.4f of the momentum lost\n", impulse / lost,
                  pushed / lost);
    assert_true(lost > 0.5 * brought && fabs(impulse / lost - 1.0) < error);
    assert_true(fabs(pushed / lost - 1.0) < error);
    assert_true(fabs(turned[0] - centre[2] * impulse) < 0.005 * centre[2] * impulse);
    assert_true(fabs(turned[2] + centre[0] * impulse) < 0.005 * centre[0] * impulse);
    test_close(sim);
}

#define TOUCHING "'contact': {'thickness': 0.004, 'friction': 0}, "

static void test_impacts(void **state) {
    (void)state;
    assert_impulse("", 2.0, 0.05,
                   "{'name': 'it', 'velocity': [0, -2, 0], 'particles': {'radius': 0.0125, 'fill': "
                   "[{'box': {'minimum': "
                   "[0, 0.05, 0], 'maximum': [0.2, 0.25, 0.2]}}]}, "
                   "'constraints': [{'type': 'fluid', 'sound_speed': 100}]}");
    assert_impulse(TOUCHING, 0.4, 0.002,
                   GRID_SHEET("'name': 'it', 'velocity': [0, -0.4, 0], ", "0.24, 0.24", "9, 9",
                              "'translate': [0.15, 0.05, 0.15], 'area_density': 0.3",
                              SPRINGS("500")));
    assert_impulse(TOUCHING, 4.0, 0.002,
                   "{'name': 'it', 'velocity': [0, -4, 0], 'volume': {'grid': {'size': [0.2, 0.2, "
                   "0.2], 'cells': [3, 3, 3]}, 'translate': [0.1, 0.12, 0.1], 'density': 125}, "
                   "'constraints': [{'type': 'tet', 'stiffness': 1e5}]}");
    assert_impulse(
        TOUCHING, 2.0, 0.002,
        "{'name': 'it', 'velocity': [0, -2, 0], 'rigid': {'box': {'minimum': [0, 0.05, 0], "
        "'maximum': [0.1, 0.15, 0.1]}, 'density': 500}}");
}

/* Water falls on a fixed ball above a floor: first the whole load is on the ball, then on the
 * floor. */
static void test_obstacle(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        scene(SOLVED, RAIN,
              "{'name': 'floor', 'box': {'minimum': [-0.4, -0.1, -0.4], 'maximum': [0.7, 0.6, "
              "0.7]}, 'open': ['-x', '+x', '+y', '-z', '+z']}, "
              "{'name': 'ball', 'sphere': {'center': [0.125, 0.2, 0.15], 'radius': 0.06}}"));
    double weight = G * mass_of(sim), most = 0.0, later = 0.0;
    struct total floor, ball;
    while (pdyn_time(sim) < 0.4) {
        test_step(sim);
        get(sim, 0, &floor), get(sim, 1, &ball);
        bool first = pdyn_time(sim) < 0.15;
        if (first && vec3_length(floor.force) + vec3_length(floor.moment) > 0.0)
            fail_msg("a force on the floor at %g s", pdyn_time(sim));
        assert_true(ball.force[1] < 0.01 * weight);
        most = fmin(most, ball.force[1]), later = fmin(later, floor.force[1]);
    }
    print_message("force over weight: ball %.2f, then floor %.2f\n", most / weight, later / weight);
    assert_true(most < -0.2 * weight && later < -weight);
    test_close(sim);
}

/* A ball is lowered into water and held: the load on it is the weight of the displaced water,
 * upwards; the tank carries the opposite. */
static void test_buoyancy(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        scene("'time_step': {'maximum': 0.005}", POOL(DEEP, "'viscosity': 0.3"),
              "{'name': 'ball', 'sphere': {'center': [0.15, 0.52, 0.15], 'radius': 0.08}, "
              "'motion': [{'time': 0}, {'time': 0.5, 'translate': [0, -0.3, 0]}]}, " TANK));
    double weight = G * 1000.0 * 4.0 / 3.0 * acos(-1.0) * 0.08 * 0.08 * 0.08;
    struct total ball = mean_load(sim, 0, 0.9, 1.2);
    print_message("lift over the weight of the ball's volume of water: %.3f\n",
                  ball.force[1] / weight);
    assert_true(fabs(ball.force[1] / weight - 1.0) < 0.15);
    assert_true(fabs(ball.force[0]) < 0.1 * weight && fabs(ball.force[2]) < 0.1 * weight);
    test_close(sim);
}

/* ---- contact and friction -------------------------------------------------------------------- */

#define LYING                                                                                      \
    "'solver': {'tolerance': 1e-4, 'outer_iterations': 100}, 'time_step': {'fixed': 0.01, "        \
    "'integrator': '%s'}, 'gravity': [%.17g, %.17g, 0], 'contact': {'thickness': 0.004, "          \
    "'friction': %g}"
#define SHEET_ON_FLOOR                                                                             \
    GRID_SHEET("", "0.5, 0.5", "9, 9", "'translate': [0.2, 0.0035, 0.1], 'area_density': 0.2",     \
               SPRINGS("500"))
#define BLOCK_ON_FLOOR                                                                             \
    "{'volume': {'grid': {'size': [0.1, 0.1, 0.1], 'cells': [2, 2, 2]}, 'translate': [0.2, "       \
    "0.054, "                                                                                      \
    "0.1], 'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': 1e5, 'damping': 0.01}]}"
#define FLOOR "{'name': 'floor', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 4}}"

/* A body at rest on a floor tilted by an angle, rad: the load includes friction. */
static void assert_carries(const char *body, const char *integrator, double angle) {
    char head[512];
    double g[3] = {G * sin(angle), -G * cos(angle), 0.0}, moment[3];
    snprintf(head, sizeof head, LYING, integrator, g[0], g[1], angle > 0.0 ? 0.8 : 0.0);
    pdyn_sim *sim = test_open(scene(head, body, FLOOR));
    double centre[3];
    struct total mean = mean_load(sim, 0, 1.0, 1.5);
    centre_of(sim, centre);
    for (int a = 0; a < 3; a++) g[a] *= mass_of(sim);
    vec3_cross(moment, centre, g);
    double off = vec3_distance(mean.force, g) / vec3_length(g);
    double turned = vec3_distance(mean.moment, moment) / vec3_length(moment);
    print_message("%s, %g rad: weight missed by %.2g, its moment by %.2g\n", integrator, angle, off,
                  turned);
    assert_true(off < 0.01 && turned < 0.02);
    test_close(sim);
}

static void test_floor(void **state) {
    (void)state;
    assert_carries(SHEET_ON_FLOOR, "bdf2", 0.0);
    assert_carries(SHEET_ON_FLOOR, "euler", 0.3);
    assert_carries(BLOCK_ON_FLOOR, "bdf2", 0.0);
    assert_carries(BLOCK_ON_FLOOR, "bdf2", 0.3);
}

/* ---- calls ----------------------------------------------------------------------------------- */

static const char *splash(void) {
    return scene(SOLVED ", 'contact': {'thickness': 0.004}", SHEET_ABOVE ", " RAIN,
                 TANK ", " PADDLE);
}

/* The same bits for any number of threads and in repeated calls. */
static void test_threads(void **state) {
    (void)state;
    struct total load[2], first[2], again;
    for (int threads = 1; threads <= 3; threads++) {
        pdyn_context *c = test_context(threads);
        pdyn_sim *sim = test_load(c, splash());
        for (int n = 0; n < 15; n++) test_step(sim);
        for (int k = 0; k < 2; k++) get(sim, k, &load[k]);
        get(sim, 0, &again);
        assert_memory_equal(&again, &load[0], sizeof again);
        if (threads == 1) memcpy(first, load, sizeof first);
        assert_memory_equal(first, load, sizeof first);
        assert_true(vec3_length(load[1].force) > 0.0);
        test_close(sim);
    }
}

/* ---- sources --------------------------------------------------------------------------------- */

/* A block of twice the density of water stands on the floor of a tank of water. */
#define SUNK                                                                                       \
    "{'name': 'block', 'rigid': {'box': {'minimum': [0.1, 0.002, 0.1], 'maximum': [0.2, 0.102, "   \
    "0.2]}, 'density': 2000}}"
#define BY(kind, name, source)                                                                     \
    "{'name': '" name "_" source "', '" kind "': '" name "', 'source': '" source "'}"
static const char *sunk(void) {
    return scene(
        SOLVED
        ", 'contact': {'thickness': 0.002}, 'probes': [" BY("solid", "tank", "fluid") ", " BY(
            "solid", "tank", "contact") ", " BY("body", "block", "fluid") ", " BY("body", "block",
                                                                                  "contact") "]",
        POOL("{'minimum': [0, 0, 0], 'maximum': [0.3, 0.2, 0.3]}", "'viscosity': 0.3") ", " SUNK,
        TANK);
}

static struct total load_by(const pdyn_sim *sim, bool body, pdyn_load_source source) {
    struct total load;
    assert_int_equal((body ? pdyn_body_load_by(sim, 1, source, load.force, load.moment)
                           : pdyn_solid_load_by(sim, 0, source, load.force, load.moment)),
                     PDYN_OK);
    return load;
}

static void assert_sum(const struct total *a, const struct total *b, const struct total *sum) {
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(a->force[k] + b->force[k] - sum->force[k]) < 1e-7);
        assert_true(fabs(a->moment[k] + b->moment[k] - sum->moment[k]) < 1e-7);
    }
}

/* Fluid and contact sum to the load; contact of two is opposite; probes have the same numbers. At
 * rest the floor carries the weight and the water above the block, as no water is below. */
static void test_sources(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, sunk());
    struct total by[2][3], mean = {{0}, {0}};
    int steps = 0;
    while (pdyn_time(sim) < 0.6) {
        test_step(sim);
        for (int k = 0; k < 6; k++) by[k / 3][k % 3] = load_by(sim, k / 3, k % 3);
        for (int k = 0; k < 2; k++)
            assert_sum(&by[k][PDYN_LOAD_FLUID], &by[k][PDYN_LOAD_CONTACT], &by[k][PDYN_LOAD_ALL]);
        for (int a = 0; a < 3; a++)
            assert_true(
                fabs(by[0][PDYN_LOAD_CONTACT].force[a] + by[1][PDYN_LOAD_CONTACT].force[a]) < 1e-7);
        for (int k = 0; k < 4; k++)
            assert_memory_equal(pdyn_get_probe(sim, k).value, &by[k / 2][1 + k % 2],
                                sizeof(struct total));
        if (pdyn_time(sim) < 0.4) continue;
        steps++;
        vec3_add(mean.force, 1.0, by[1][PDYN_LOAD_FLUID].force);
        vec3_add(mean.moment, 1.0, by[1][PDYN_LOAD_CONTACT].force);
    }
    double fluid = mean.force[1] / steps, floor = mean.moment[1] / steps;
    print_message("block of %.2f N: fluid %.2f N, floor %.2f N\n", 2.0 * G, fluid, floor);
    assert_true(fabs(fluid + floor - 2.0 * G) < 0.05 * G);
    assert_true(floor > 0.5 * G && fabs(fluid) > 0.1 * G);
    pdyn_free(sim);
}

static void assert_zero(const pdyn_sim *sim) {
    struct total load = {{1, 1, 1}, {1, 1, 1}}, none = {{0}, {0}};
    get(sim, 1, &load);
    assert_memory_equal(&load, &none, sizeof load);
}

static void test_calls(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, splash());
    double v[3], w[3];
    assert_string_equal(pdyn_solid_name(sim, 0), "tank");
    assert_string_equal(pdyn_solid_name(sim, 1), "ball");
    assert_null(pdyn_solid_name(sim, 2));
    assert_null(pdyn_solid_name(sim, -1));
    assert_int_equal(pdyn_solid_load(NULL, 0, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_solid_load(sim, 0, NULL, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_solid_load(sim, 0, v, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_solid_load(sim, -1, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_solid_load(sim, 2, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_solid_load_by(sim, 0, 3, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_solid_load_by(sim, 2, PDYN_LOAD_FLUID, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_body_load_by(sim, 99, PDYN_LOAD_FLUID, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_body_load_by(sim, 0, -1, v, w), PDYN_BAD_CALL);
    assert_zero(sim);
    for (int n = 0; n < 15; n++) test_step(sim);
    test_allow(&counter, 0);
    assert_int_equal(pdyn_solid_load(sim, 1, v, w), PDYN_OK); /* allocates nothing */
    test_allow(&counter, -1);
    assert_true(vec3_length(v) > 0.0);
    assert_int_equal(pdyn_save(sim, "state.pdyn"), PDYN_OK);
    assert_int_equal(pdyn_restore(sim, "state.pdyn"), PDYN_OK);
    assert_zero(sim);
    test_remove_file("state.pdyn");
    pdyn_free(sim);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

/* Asking for loads does not change later steps. */
static void test_untouched(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int asks = 0; asks < 2; asks++) {
        pdyn_sim *sim = test_load(context, splash());
        struct total load;
        for (int n = 0; n < 15; n++) {
            test_step(sim);
            if (asks) get(sim, 0, &load);
        }
        hash[asks] = pdyn_state_hash(sim);
        pdyn_free(sim);
    }
    assert_true(hash[0] == hash[1]);
}

static void assert_load(const pdyn_sim *sim, pdyn_load_source source, const struct total *due) {
    struct total load, missed;
    assert_int_equal(pdyn_body_load_by(sim, 0, source, load.force, load.moment), PDYN_OK);
    vec3_subtract(missed.force, load.force, due->force);
    assert_true(vec3_length(missed.force) <= 1e-9 * vec3_length(due->force));
}

/* A type of a plug-in says by a flag that its forces are loads by fluids. */
static void test_flag(void **state) {
    (void)state;
    static pdyn_constraint_type jet, rope;
    static const pdyn_constraint_type *const types[] = {&jet, &rope, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "sources", types, NULL};
    jet = rope = *registry_constraint(context, "pin");
    jet.name = "jet", jet.flags |= PDYN_FLUID, rope.name = "rope";
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim = test_load(
        context,
        scene(SOLVED,
              "{'surface': {'grid': {'size': [0.4, 0.4], 'vertices': [5, 5]}, 'area_density': "
              "0.3}, 'constraints': [{'type': 'spring', 'stretching_stiffness': 500}, {'type': "
              "'jet', 'vertices': {'vertices': [0]}}, {'type': 'rope', 'vertices': {'vertices': "
              "[24]}}]}",
              ""));
    struct total by_jet, none = {{0}, {0}};
    for (int n = 0; n < 3; n++) test_step(sim);
    assert_int_equal(pdyn_constraint_load(sim, 1, by_jet.force, by_jet.moment), PDYN_OK);
    assert_true(vec3_length(by_jet.force) > 0.0);
    assert_load(sim, PDYN_LOAD_FLUID, &by_jet);
    assert_load(sim, PDYN_LOAD_CONTACT, &none);
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_balance),   cmocka_unit_test(test_tank),
        cmocka_unit_test(test_impacts),   cmocka_unit_test(test_obstacle),
        cmocka_unit_test(test_buoyancy),  cmocka_unit_test(test_floor),
        cmocka_unit_test(test_threads),   cmocka_unit_test(test_calls),
        cmocka_unit_test(test_untouched), cmocka_unit_test(test_sources),
        cmocka_unit_test(test_flag),
    };
    return cmocka_run_group_tests_name("solid_load", tests, scene_set_up, scene_tear_down);
}
