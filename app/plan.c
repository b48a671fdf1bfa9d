/* A grid of the length of the steps and of how far each is solved, then what differs in kind. */
#include "plan.h"
#include "scene_json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- making a setting ------------------------------------------------------------------------ */

/* The kinematic viscosity of a fluid goes with its viscosity over the length of the step. */
static void keep_viscous(struct setting *d, const json_t *scene, double factor) {
    size_t body, k;
    const json_t *fluid = scene_fluid(scene, &body, &k);
    if (fluid && factor != 1.0)
        setting_add(d, "bodies.%zu.constraints.%zu.viscosity=%.9g", body, k,
                    fmin(1.0, factor * scene_viscosity(fluid)));
}

/* Steps of `factor` times the length. What the scene does not say is as in docs/scene.md. */
static void scale_step(struct setting *d, const json_t *scene, double factor) {
    const json_t *step = json_object_get(scene, "time_step");
    double fixed = scene_number(step, "fixed", 0.0);
    if (factor == 1.0) return;
    keep_viscous(d, scene, factor);
    if (fixed > 0.0) {
        setting_add(d, "time_step.fixed=%.9g", factor * fixed);
        return;
    }
    setting_add(d, "time_step.maximum=%.9g", factor * scene_number(step, "maximum", 0.005));
    setting_add(d, "time_step.cfl=%.9g", factor * scene_number(step, "cfl", 1.0));
}

static const char *integrator_of(const json_t *scene) {
    const char *name =
        json_string_value(json_object_get(json_object_get(scene, "time_step"), "integrator"));
    return name ? name : "bdf2";
}

/* Steps solved to a residual. */
static void solve_to(struct setting *d, double tolerance) {
    setting_add(d, "solver.tolerance=%g", tolerance);
    setting_add(d, "solver.linear_tolerance=0.1");
    setting_add(d, "solver.outer_iterations=100");
    setting_add(d, "solver.linear_iterations=500");
}

/* Steps cut short. */
static void cut_short(struct setting *d, int outer, int linear) {
    d->cut = true;
    setting_add(d, "solver.tolerance=0.001");
    setting_add(d, "solver.linear_tolerance=0");
    setting_add(d, "solver.outer_iterations=%d", outer);
    setting_add(d, "solver.linear_iterations=%d", linear);
}

/* Takes the draft, also one that failed. */
static bool keep(struct plan *plan, struct setting *d, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static bool keep(struct plan *plan, struct setting *d, const char *format, ...) {
    va_list args;
    va_start(args, format);
    if (vasprintf(&d->name, format, args) < 0) d->name = NULL;
    va_end(args);
    if (plan->count == plan->capacity) {
        int capacity = 2 * plan->capacity + 16;
        struct setting *grown = realloc(plan->setting, (size_t)capacity * sizeof *grown);
        if (!grown) return false; /* and lost: the end is near */
        plan->setting = grown, plan->capacity = capacity;
    }
    plan->setting[plan->count++] = *d;
    return d->name && !d->failed;
}

/* ---- the plan -------------------------------------------------------------------------------- */

static bool grid_solved(struct plan *plan, const json_t *scene) {
    static const struct {
        double factor, tolerance;
    } points[] = {{8, 1},       {8, 0.1},    {4, 10},     {4, 1},    {4, 0.1},    {2, 10},
                  {2, 1},       {2, 0.1},    {1, 10},     {1, 1},    {1, 0.1},    {0.5, 10},
                  {0.5, 1},     {0.5, 0.1},  {0.25, 10},  {0.25, 1}, {0.25, 0.1}, {0.125, 1},
                  {0.125, 0.1}, {0.0625, 1}, {0.03125, 1}};
    bool good = true;
    for (size_t k = 0; k < sizeof points / sizeof *points && good; k++) {
        struct setting d = {0};
        scale_step(&d, scene, points[k].factor);
        solve_to(&d, points[k].tolerance);
        good = keep(plan, &d, "h x %g, to residual %g", points[k].factor, points[k].tolerance);
    }
    return good;
}

/* The integrator that the scene does not use. */
static bool try_integrator(struct plan *plan, const json_t *scene) {
    static const struct {
        double factor, tolerance;
    } points[] = {{4, 1}, {2, 1}, {1, 1}, {1, 0.1}, {0.5, 1}, {0.5, 0.1}, {0.25, 1}, {0.125, 1}};
    const char *other = strcmp(integrator_of(scene), "euler") ? "euler" : "bdf2";
    bool good = true;
    for (size_t k = 0; k < sizeof points / sizeof *points && good; k++) {
        struct setting d = {0};
        scale_step(&d, scene, points[k].factor);
        setting_add(&d, "time_step.integrator=%s", other);
        solve_to(&d, points[k].tolerance);
        good = keep(plan, &d, "%s, h x %g, to residual %g", other, points[k].factor,
                    points[k].tolerance);
    }
    return good;
}

/* A push travels one spacing with a linear iteration. */
static bool grid_short(struct plan *plan, const json_t *scene, double finer) {
    static const double factors[] = {4, 2, 1, 0.5};
    static const int iterations[][2] = {{1, 8}, {2, 8}, {2, 24}, {4, 24}};
    bool good = true;
    for (size_t k = 0; k < 16 && good; k++) {
        double factor = factors[k / 4];
        int outer = iterations[k % 4][0], linear = (int)round(finer * iterations[k % 4][1]);
        struct setting d = {0};
        scale_step(&d, scene, factor);
        cut_short(&d, outer, linear);
        good = keep(plan, &d, "h x %g, %d x %d iterations", factor, outer, linear);
    }
    return good;
}

/* Steps that nothing else shortens. */
static bool try_fixed(struct plan *plan, const json_t *scene, double finer) {
    static const double factors[] = {1, 2, 4};
    int linear = (int)round(24.0 * finer);
    const json_t *step = json_object_get(scene, "time_step");
    double longest = scene_number(step, "maximum", 0.005);
    bool good = true;
    if (scene_number(step, "fixed", 0.0) > 0.0) return true;
    for (int k = 0; k < 6 && good; k++) {
        double ms = 1e3 * factors[k / 2] * longest;
        struct setting d = {0};
        setting_add(&d, "time_step={\"fixed\": %.9g, \"integrator\": \"%s\"}", 1e-3 * ms,
                    integrator_of(scene));
        keep_viscous(&d, scene, factors[k / 2]);
        if (k % 2) solve_to(&d, 1.0);
        else cut_short(&d, 2, linear);
        good = k % 2 ? keep(plan, &d, "all steps %g ms, to residual 1", ms)
                     : keep(plan, &d, "all steps %g ms, 2 x %d iterations", ms, linear);
    }
    return good;
}

static bool try_solvers(struct plan *plan, const char *solver) {
    static const char *const others[] = {"cg", "hybrid", "dual"};
    bool good = true;
    for (int k = 0; k < 3 && good; k++) {
        struct setting d = {0};
        if (!strcmp(others[k], solver)) continue;
        setting_add(&d, "solver.type=%s", others[k]);
        good = keep(plan, &d, "solver %s", others[k]);
    }
    return good;
}

static bool try_steps(struct plan *plan) {
    static const int outer[] = {5, 20};
    static const double linear[] = {0.3, 0.01};
    bool good = true;
    for (int k = 0; k < 2 && good; k++) {
        struct setting d = {0};
        setting_add(&d, "solver.type=auto");
        d.cut = true;
        setting_add(&d, "solver.step=projective");
        setting_add(&d, "solver.outer_iterations=%d", outer[k]);
        good = keep(plan, &d, "projective step, %d iterations", outer[k]);
    }
    for (int k = 0; k < 2 && good; k++) {
        struct setting d = {0};
        setting_add(&d, "solver.linear_tolerance=%g", linear[k]);
        good = keep(plan, &d, "linear solves to %g", linear[k]);
    }
    return good;
}

static bool as_it_is(struct plan *plan, const json_t *scene) {
    static const double factors[] = {1, 2, 0.5};
    bool good = true;
    for (int k = 0; k < 3 && good; k++) {
        struct setting d = {0};
        scale_step(&d, scene, factors[k]);
        good = k ? keep(plan, &d, "h x %g", factors[k]) : keep(plan, &d, "the scene as it is");
    }
    return good;
}

static bool make_references(struct plan *plan, const json_t *scene) {
    bool good = true;
    for (int k = 0; k < PLAN_REFERENCES; k++) {
        struct setting *d = &plan->reference[k];
        double factor = 0.25 / (double)(1 << k);
        scale_step(d, scene, factor);
        setting_add(d, "time_step.integrator=bdf2"); /* converges faster */
        solve_to(d, 0.01);
        if (asprintf(&d->name, "bdf2, h x %g, to residual 0.01", factor) < 0) d->name = NULL;
        good &= d->name && !d->failed;
    }
    return good;
}

bool plan_make(struct plan *plan, const json_t *scene, const char *solver, double finer) {
    *plan = (struct plan){0};
    return as_it_is(plan, scene) && grid_short(plan, scene, finer) && grid_solved(plan, scene) &&
           try_integrator(plan, scene) && try_fixed(plan, scene, finer) &&
           try_solvers(plan, solver) && try_steps(plan) && make_references(plan, scene);
}

void plan_free(struct plan *plan) {
    for (int k = 0; k < plan->count; k++) setting_free(&plan->setting[k]);
    for (int k = 0; k < PLAN_REFERENCES; k++) setting_free(&plan->reference[k]);
    free(plan->setting);
}
