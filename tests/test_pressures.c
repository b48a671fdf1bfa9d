/* A fluid beside cloth, solved for pressures (solver "dual") and for positions. */
#include "support.h"

#include "../src/solvers/remainder_solve.h"
#include "step/line_search.h"

#include "projdyn/control.h"

#include <string.h>

/* A block of 8 x 5 x 8 particles falls on a sheet that is held at its border. */
#define POUR(solver, stiffness) POUR_ON(solver, stiffness, "0.3", "3000")
#define POUR_ON(solver, stiffness, area_density, stretching)                                       \
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'solver': "     \
          "{" solver "}",                                                                          \
          PAIR(FLUID_BOX("'name': 'water', 'velocity': [0, -0.5, 0], ", "0.02",                    \
                         "-0.16, 0.03, -0.16", "0.16, 0.23, 0.16", ", 'stiffness': " stiffness),   \
               GRID_SHEET("'name': 'sheet', ", "0.5, 0.5", "17, 17",                               \
                          "'area_density': " area_density,                                         \
                          PAIR(SPRINGS(stretching), PINS("'border': true")))),                     \
          "")

#define ROUGH "'tolerance': 0.3, 'outer_iterations': 100"

struct run {
    int steps, unsolved;
    long dual_steps;
    int64_t work;         /* of objective.h */
    double kinetic, x[3]; /* J, m: at the end; mean position of all particles */
    uint64_t hash;
};

static struct run pour(const char *scene, const char *solver, int threads, double seconds) {
    pdyn_context *context = test_context(threads);
    struct run run = {0};
    pdyn_sim *sim = test_load_with(context, scene, &solver, 1);
    while (pdyn_time(sim) < seconds - 1e-9) {
        pdyn_step_info info = test_step(sim);
        run.steps++, run.kinetic = info.kinetic_energy;
        run.unsolved += info.step_residual > sim->scene.settings.tolerance;
        assert_int_equal(info.leaked, 0);
    }
    const pdyn_state s = pdyn_get_state(sim);
    for (int k = 0; k < 3 * s.particles; k++) run.x[k % 3] += s.x[k] / s.particles;
    run.dual_steps = sim->choice.dual_steps, run.work = sim->objective.work;
    run.hash = pdyn_state_hash(sim);
    test_close(sim);
    return run;
}

/* Solved to a small tolerance, both give the same motion through the impact. */
static void test_same_motion(void **state) {
    (void)state;
    const char *scene = POUR("'tolerance': 1e-3, 'outer_iterations': 100", "1e4");
    struct run positions = pour(scene, "solver.type=hybrid", 1, 0.08);
    struct run pressures = pour(scene, "solver.type=dual", 1, 0.08);
    assert_int_equal(positions.unsolved, 0);
    assert_int_equal(pressures.unsolved, 0);
    assert_int_equal(positions.dual_steps, 0);
    assert_int_equal(pressures.dual_steps, pressures.steps);
    assert_true(fabs(pressures.kinetic - positions.kinetic) < 1e-3 * positions.kinetic);
    assert_true(test_distance(pressures.x, positions.x, 3) < 1e-6);
}

/* New solvers, after a change of a weight, go on with the count of steps in pressures. */
static void test_dual_steps(void **state) {
    (void)state;
    const char *solver = "solver.type=dual";
    pdyn_sim *sim = test_load_with(test_context(1), POUR(ROUGH, "1e6"), &solver, 1);
    for (int step = 0; step < 4; step++) {
        double stiffness = 3000.0 + 100.0 * step;
        assert_int_equal(pdyn_set_parameter(sim, 1, "stretching_stiffness", &stiffness, 1),
                         PDYN_OK);
        test_step(sim);
    }
    assert_int_equal(sim->choice.dual_steps, 4);
    test_close(sim);
}

/* With the stiffness of the paper, every step is solved, in less work than in positions, and the
 * water moves as soft water does. */
static void test_stiff(void **state) {
    (void)state;
    struct run soft = pour(POUR(ROUGH, "1e4"), "solver.type=hybrid", 1, 0.1);
    struct run stiff = pour(POUR(ROUGH, "1e6"), "solver.type=auto", 1, 0.1);
    struct run former = pour(POUR(ROUGH, "1e6"), "solver.type=hybrid", 1, 0.1);
    assert_int_equal(stiff.unsolved, 0);
    assert_true(stiff.dual_steps > 0);
    assert_true(3 * stiff.work < 2 * former.work);
    assert_true(fabs(stiff.kinetic - soft.kinetic) < 0.05 * soft.kinetic);
}

/* Nearly incompressible water, beside a light and soft sheet. */
static void test_very_stiff(void **state) {
    (void)state;
    struct run run = pour(POUR_ON("'outer_iterations': 100", "1e7", "0.05", "1000"),
                          "solver.type=auto", 1, 0.15);
    assert_int_equal(run.unsolved, 0);
    assert_true(run.dual_steps > 0);
}

/* The other solver continues a step that takes many times the work of the steps before it, with the
 * damping that it had itself, and is on trial; both have the cost of that step. The first one gets
 * its own damping back. */
static void test_surprise(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(POUR(ROUGH, "1e6"));
    test_step(sim);
    assert_int_equal(sim->choice.active, 0);
    solver_choice_open(sim);
    sim->objective.work += 4 * (int64_t)sim->choice.slot[0].cost;
    assert_false(solver_choice_has_lost(sim, 201));
    sim->objective.work++;
    assert_false(solver_choice_has_lost(sim, 200));
    assert_true(solver_choice_has_lost(sim, 201));
    sim->eps = 0.25;
    assert_true(solver_choice_hand_over(sim));
    assert_int_equal(sim->choice.active, 1);
    assert_true(sim->eps == 0.0);
    assert_false(solver_choice_has_lost(sim, 201));
    solver_choice_step(sim, 1);
    assert_int_equal(sim->choice.active, 1);
    assert_true(sim->choice.slot[0].cost > 0.0);
    assert_true(sim->choice.slot[0].cost == sim->choice.slot[1].cost);
    solver_choice_open(sim);
    sim->objective.work += 2 * (int64_t)sim->choice.slot[0].cost;
    assert_true(solver_choice_has_lost(sim, 1));
    assert_true(solver_choice_hand_over(sim));
    assert_true(sim->eps == 0.25);
    test_close(sim);
}

/* Ends a step of so much work. */
static void end_step(pdyn_sim *sim, int64_t work) {
    solver_choice_open(sim);
    sim->objective.work += work, sim->steps++, sim->solved = true;
    solver_choice_step(sim, 100);
}

/* A single cheap step wins no trial: it takes four steps with a lower mean. */
static void test_trial(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(POUR(ROUGH, "1e6"));
    const int64_t lost[] = {100, 10, 200}, won[] = {10, 150, 100, 90};
    const struct solver_choice *c = &sim->choice;
    end_step(sim, lost[0]);
    assert_true(c->active == 1 && c->trial);
    end_step(sim, lost[1]);
    assert_true(c->active == 1 && c->trial);
    end_step(sim, lost[2]);
    assert_true(c->active == 0 && !c->trial);
    while (!c->trial) end_step(sim, 100);
    for (int k = 0; k < 4; k++) {
        assert_true(c->active == 1 && c->trial);
        end_step(sim, won[k]);
    }
    assert_true(c->active == 1 && !c->trial);
    test_close(sim);
}

/* After a step of the dual solver that ends far from solved, positions are used for 16 steps. The
 * first of these that is far from solved, too, ends this wait. After the next failure of the dual
 * solver it takes two of them. */
static void test_unsolved(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(POUR(ROUGH, "1e6"));
    const struct solver_choice *c = &sim->choice;
    end_step(sim, 100);
    assert_true(c->active == 1 && c->trial);
    for (int failures = 1; failures <= 2; failures++) {
        sim->far_off = true;
        end_step(sim, 10);
        assert_true(c->active == 0 && c->wait == 8 << failures);
        sim->far_off = false;
        end_step(sim, 100);
        assert_int_equal(c->active, 0);
        sim->far_off = true;
        for (int k = 0; k < failures; k++) {
            assert_int_equal(c->active, 0);
            end_step(sim, 100);
        }
        assert_true(c->active == 1 && c->trial);
    }
    test_close(sim);
}

/* A product with H visits each entry of rows once, and each density twice; vectors come in
 * addition.
 */
static void test_work(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(POUR(ROUGH, "1e4"));
    test_step(sim);
    struct objective *o = &sim->objective;
    int64_t before = o->work, entries = (int64_t)WORK_OF_VECTORS * o->particles;
    for (int b = 0; b < o->batches; b++) {
        const struct batch *batch = o->batch[b];
        entries += batch->op ? 30 * batch->one_sided.at.count : batch->entries;
    }
    objective_apply(o, sim->gradient, sim->direction);
    assert_true(entries > 0 && o->work - before == entries);
    test_close(sim);
}

static double remainder_norm(pdyn_model *model, const double *r) {
    return model->remainder->norm(model->remainder, r);
}

/* Solves A y = the forces of equal pressures, where A is H without the density constraints. Returns
 * by how much the residual has fallen. */
static double push_sheet(pdyn_sim *sim, double tolerance, double *y) {
    pdyn_model *model = &sim->model.model;
    const pdyn_body *water = NULL;
    int count = model->one_sided(model, 0, &water).count;
    double *pressure = calloc((size_t)count, sizeof *pressure);
    double *b = calloc(3 * (size_t)model->particles, sizeof *b);
    struct remainder_solve remainder = {0};
    assert_true(pressure && b);
    for (int i = 0; i < count; i++) pressure[i] = 1.0;
    model->force(model, 0, pressure, b);
    double size = remainder_norm(model, b);
    assert_int_equal(remainder_solve_create(&remainder, model), PDYN_OK);
    remainder_solve_update(&remainder, true);
    remainder_solve_apply(&remainder, b, y, tolerance);
    double fallen = remainder_norm(model, b) / size;
    remainder_solve_free(&remainder);
    free(pressure), free(b);
    return fallen;
}

/* A solve with A ends at its tolerance as an error in the norm of A, which is reached long before
 * the residual has fallen as far. */
static void test_remainder_error(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(POUR(ROUGH, "1e4"));
    while (pdyn_time(sim) < 0.05) test_step(sim);
    assert_int_equal(solver_view_linearise(&sim->model, 0.0), PDYN_OK);
    pdyn_model *A = sim->model.model.remainder;
    assert_null(A->matrix);
    int n = 3 * A->particles;
    double *vectors = calloc(3 * (size_t)n, sizeof *vectors);
    assert_non_null(vectors);
    double *exact = vectors, *y = exact + n, *Ay = y + n;
    assert_true(push_sheet(sim, 1e-9, exact) < 1e-6);
    assert_true(push_sheet(sim, 0.3, y) > 0.3);
    A->product(A, exact, Ay);
    double size = sqrt(A->dot(A, exact, Ay));
    for (int k = 0; k < n; k++) y[k] -= exact[k];
    A->product(A, y, Ay);
    assert_true(sqrt(A->dot(A, y, Ay)) < 0.3 * size);
    free(vectors);
    test_close(sim);
}

/* A step of twice the way to the minimum, from water that is 0.1 mm too high. */
static struct line_step overshoot(pdyn_sim *sim, double eps) {
    struct objective *o = &sim->objective;
    const pdyn_body *water = &sim->body[0];
    struct line_step step;
    double energy;
    memcpy(sim->x_next, sim->x, objective_bytes(o));
    memset(sim->direction, 0, objective_bytes(o));
    for (int i = water->first; i < water->first + water->count; i++)
        sim->x_next[3 * i + 1] += 1e-4, sim->direction[3 * i + 1] = -2e-4;
    assert_int_equal(objective_local(o, sim->x_next, &energy, sim->gradient), PDYN_OK);
    sim->eps = eps;
    assert_int_equal(line_search(sim, 2.0 * energy, &energy, &step), PDYN_OK);
    return step;
}

/* Under "dual" damping shortens steps that are too long, and at its largest value the line search.
 */
static void test_overshoot(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(POUR("'type': 'dual', 'tolerance': 0.01", "1e5"));
    while (pdyn_time(sim) < 0.05) test_step(sim);
    struct line_step damped = overshoot(sim, 0.5), largest = overshoot(sim, 1.0);
    assert_true(damped.length == 1.0 && damped.slope_after > -0.7 * damped.slope);
    assert_true(largest.length == 0.5 && fabs(largest.slope_after) < -0.1 * largest.slope);
    test_close(sim);
}

static void test_threads(void **state) {
    (void)state;
    const char *scene = POUR("'outer_iterations': 50", "1e5");
    struct run one = pour(scene, "solver.type=auto", 1, 0.1);
    struct run three = pour(scene, "solver.type=auto", 3, 0.1);
    assert_true(one.hash == three.hash);
    assert_true(one.dual_steps > 0 && one.dual_steps < one.steps);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_motion),     cmocka_unit_test(test_dual_steps),
        cmocka_unit_test(test_stiff),           cmocka_unit_test(test_very_stiff),
        cmocka_unit_test(test_surprise),        cmocka_unit_test(test_trial),
        cmocka_unit_test(test_unsolved),        cmocka_unit_test(test_work),
        cmocka_unit_test(test_remainder_error), cmocka_unit_test(test_overshoot),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests_name("pressures", tests, NULL, NULL);
}
