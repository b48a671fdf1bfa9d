/* The settings of a plan: a grid of step lengths and solution accuracies, then other
 * integrators, step types, solvers and tolerances. Step lengths are factors on that of the scene
 * ("h x 2"); those of fixed steps divide the frame interval, as the steps of a run do. */
#include "plan.h"
#include "scene_json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A setting that solves its steps. */
struct point {
    double factor, tolerance;
};

/* ---- parts of a setting ---------------------------------------------------------------------- */

/* Multiplies the viscosity of fluids by the factor on the step length h, at most to 1: the
 * kinematic viscosity is proportional to viscosity / h and must not change. */
static void scale_viscosity(struct setting *setting, const json_t *scene, double factor) {
    size_t k;
    for (size_t b = 0; b < json_array_size(json_object_get(scene, "bodies")); b++) {
        const json_t *fluid = scene_fluid(scene, b, &k);
        if (fluid)
            setting_add(setting, "bodies.%zu.constraints.%zu.viscosity=%.9g", b, k,
                        fmin(1.0, factor * scene_viscosity(fluid)));
    }
}

/* Length of the steps that a run takes with the fixed step `fixed`: equal parts of a frame
 * interval. */
static double divide_interval(double interval, double fixed) {
    return interval / fmax(1.0, ceil(interval / fixed * (1.0 - 1e-9)));
}

/* Fixed step of the scene, as its own runs take it; 0: its steps are adaptive. */
static double scene_step(const struct plan *plan) {
    double fixed = scene_number(json_object_get(plan->scene, "time_step"), "fixed", 0.0);
    return fixed > 0.0 ? divide_interval(plan->window->scene_interval, fixed) : 0.0;
}

/* The factor on the step length that the runs take, which is less than the asked one where a fixed
 * step is shortened to divide the frame interval. */
static double real_factor(const struct plan *plan, double factor) {
    double h = scene_step(plan);
    if (h == 0.0) return factor;
    double real = divide_interval(plan->window->frame_interval, factor * h) / h;
    return fabs(real - factor) < 1e-9 * factor ? factor : real;
}

/* Multiplies the step length by a real factor. Defaults for missing keys are those of
 * docs/guide/scene.md. */
static void scale_step(struct setting *setting, const struct plan *plan, double factor) {
    const json_t *step = json_object_get(plan->scene, "time_step");
    if (factor == 1.0) return;
    scale_viscosity(setting, plan->scene, factor);
    if (scene_step(plan) > 0.0) {
        setting_add(setting, "time_step.fixed=%.12g", factor * scene_step(plan));
        return;
    }
    double maximum = factor * scene_number(step, "maximum", 0.005);
    setting_add(setting, "time_step.maximum=%.9g", maximum);
    if (maximum < scene_number(step, "minimum", 1e-5))
        setting_add(setting, "time_step.minimum=%.9g", maximum);
    setting_add(setting, "time_step.cfl=%.9g", factor * scene_number(step, "cfl", 1.0));
}

static const char *scene_integrator(const json_t *scene) {
    const char *name =
        json_string_value(json_object_get(json_object_get(scene, "time_step"), "integrator"));
    return name ? name : "bdf2";
}

/* Solves each step to a residual, with iteration limits that are not reached in practice. */
static void set_tolerance(struct setting *setting, double tolerance) {
    setting_add(setting, "solver.tolerance=%g", tolerance);
    setting_add(setting, "solver.linear_tolerance=0.1");
    setting_add(setting, "solver.outer_iterations=100");
    setting_add(setting, "solver.linear_iterations=500");
}

/* Limits the iterations of each step to numbers that usually end it before it is solved. */
static void truncate_iterations(struct setting *setting, int outer, int linear) {
    setting->truncated = true;
    setting_add(setting, "solver.tolerance=0.001");
    setting_add(setting, "solver.linear_tolerance=0");
    setting_add(setting, "solver.outer_iterations=%d", outer);
    setting_add(setting, "solver.linear_iterations=%d", linear);
}

/* Appends a setting with a name formatted as by printf; the plan owns it, even if it is
 * incomplete. false if memory ran out. */
static bool append_setting(struct plan *plan, struct setting *setting, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static bool append_setting(struct plan *plan, struct setting *setting, const char *format, ...) {
    va_list args;
    va_start(args, format);
    if (vasprintf(&setting->name, format, args) < 0) setting->name = NULL;
    va_end(args);
    if (plan->count == plan->capacity) {
        int capacity = 2 * plan->capacity + 16;
        struct setting *grown = realloc(plan->setting, (size_t)capacity * sizeof *grown);
        if (!grown) return setting_free(setting), false;
        plan->setting = grown, plan->capacity = capacity;
    }
    plan->setting[plan->count++] = *setting;
    return setting->name && !setting->failed;
}

/* ---- the plan -------------------------------------------------------------------------------- */

/* Whether an earlier point has the same real step and tolerance. */
static bool is_repeated(const struct plan *plan, const struct point *point, size_t k) {
    double factor = real_factor(plan, point[k].factor);
    for (size_t j = 0; j < k; j++)
        if (point[j].tolerance == point[k].tolerance &&
            real_factor(plan, point[j].factor) == factor)
            return true;
    return false;
}

/* Adds settings of step lengths and residuals, with another integrator than that of the scene where
 * one is given. */
static bool add_points(struct plan *plan, const struct point *points, size_t count,
                       const char *integrator) {
    bool good = true;
    for (size_t k = 0; k < count && good; k++) {
        double factor = real_factor(plan, points[k].factor);
        struct setting setting = {0};
        if (is_repeated(plan, points, k)) continue;
        scale_step(&setting, plan, factor);
        if (integrator) setting_add(&setting, "time_step.integrator=%s", integrator);
        set_tolerance(&setting, points[k].tolerance);
        good = append_setting(plan, &setting, "%s%sh x %g, to residual %g",
                              integrator ? integrator : "", integrator ? ", " : "", factor,
                              points[k].tolerance);
    }
    return good;
}

/* Step lengths x residuals. */
static bool add_solved_grid(struct plan *plan) {
    static const struct point points[] = {
        {8, 1},     {8, 0.1},  {4, 10},     {4, 1},     {4, 0.1},     {2, 10},     {2, 1},
        {2, 0.1},   {1, 10},   {1, 1},      {1, 0.1},   {0.5, 10},    {0.5, 1},    {0.5, 0.1},
        {0.25, 10}, {0.25, 1}, {0.25, 0.1}, {0.125, 1}, {0.125, 0.1}, {0.0625, 1}, {0.03125, 1}};
    return add_points(plan, points, sizeof points / sizeof *points, NULL);
}

/* The integrator that the scene does not use, of euler and bdf2. */
static bool add_other_integrator(struct plan *plan) {
    static const struct point points[] = {{4, 1},   {2, 1},     {1, 1},    {1, 0.1},
                                          {0.5, 1}, {0.5, 0.1}, {0.25, 1}, {0.125, 1}};
    const char *other = strcmp(scene_integrator(plan->scene), "euler") ? "euler" : "bdf2";
    return add_points(plan, points, sizeof points / sizeof *points, other);
}

/* Step lengths x iteration limits. */
static bool add_truncated_grid(struct plan *plan) {
    static const double factors[] = {4, 2, 1, 0.5};
    static const int iterations[][2] = {{1, 8}, {2, 8}, {2, 24}, {4, 24}};
    bool good = true;
    for (size_t k = 0; k < 16 && good; k++) {
        double factor = real_factor(plan, factors[k / 4]);
        int outer = iterations[k % 4][0],
            linear = (int)round(plan->coarsening * iterations[k % 4][1]);
        struct setting setting = {0};
        if (k >= 4 && real_factor(plan, factors[k / 4 - 1]) == factor) continue;
        scale_step(&setting, plan, factor);
        truncate_iterations(&setting, outer, linear);
        good = append_setting(plan, &setting, "h x %g, %d x %d iterations", factor, outer, linear);
    }
    return good;
}

/* Fixed step lengths instead of steps limited by the CFL number; none if the scene has fixed
 * steps. */
static bool add_fixed_steps(struct plan *plan) {
    int linear = (int)round(24.0 * plan->coarsening);
    double longest = scene_number(json_object_get(plan->scene, "time_step"), "maximum", 0.005);
    double before = 0.0;
    bool good = true;
    if (scene_step(plan) > 0.0) return true;
    for (int k = 0; k < 3 && good; k++) {
        double h = divide_interval(plan->window->frame_interval, longest * (1 << k));
        for (int solved = 0; solved < 2 && good && h != before; solved++) {
            struct setting setting = {0};
            setting_add(&setting, "time_step={\"fixed\": %.12g, \"integrator\": \"%s\"}", h,
                        scene_integrator(plan->scene));
            scale_viscosity(&setting, plan->scene, h / longest);
            if (solved) set_tolerance(&setting, 1.0);
            else truncate_iterations(&setting, 2, linear);
            good =
                solved
                    ? append_setting(plan, &setting, "fixed steps of %g ms, to residual 1", 1e3 * h)
                    : append_setting(plan, &setting, "fixed steps of %g ms, 2 x %d iterations",
                                     1e3 * h, linear);
        }
        before = h;
    }
    return good;
}

static bool has_fluid(const json_t *scene) {
    size_t k;
    for (size_t b = 0; b < json_array_size(json_object_get(scene, "bodies")); b++)
        if (scene_fluid(scene, b, &k)) return true;
    return false;
}

/* Solvers other than that of the scene; the unknowns of dual are the pressures of a fluid. */
static bool add_solvers(struct plan *plan) {
    static const char *const others[] = {"cg", "hybrid", "dual"};
    bool good = true;
    for (int k = 0; k < 3 && good; k++) {
        struct setting setting = {0};
        if (!strcmp(others[k], plan->window->solver)) continue;
        if (!strcmp(others[k], "dual") && !has_fluid(plan->scene)) continue;
        setting_add(&setting, "solver.type=%s", others[k]);
        good = append_setting(plan, &setting, "solver %s", others[k]);
    }
    return good;
}

/* The projective step with two iteration limits; other linear tolerances. */
static bool add_step_types(struct plan *plan) {
    static const int outer[] = {5, 20};
    static const double linear[] = {0.3, 0.01};
    bool good = true;
    for (int k = 0; k < 2 && good; k++) {
        struct setting setting = {0};
        setting_add(&setting, "solver.type=auto");
        setting.truncated = true;
        setting_add(&setting, "solver.step=projective");
        setting_add(&setting, "solver.outer_iterations=%d", outer[k]);
        good = append_setting(plan, &setting, "projective step, %d iterations", outer[k]);
    }
    for (int k = 0; k < 2 && good; k++) {
        struct setting setting = {0};
        setting_add(&setting, "solver.linear_tolerance=%g", linear[k]);
        good = append_setting(plan, &setting, "linear tolerance %g", linear[k]);
    }
    return good;
}

/* The scene unchanged, and with other step lengths. */
static bool add_scene_steps(struct plan *plan) {
    static const double factors[] = {1, 2, 0.5};
    bool good = true;
    for (int k = 0; k < 3 && good; k++) {
        double factor = real_factor(plan, factors[k]);
        struct setting setting = {0};
        if (k && real_factor(plan, 1.0) == factor) continue;
        scale_step(&setting, plan, factor);
        good = factor != 1.0 ? append_setting(plan, &setting, "h x %g", factor)
                             : append_setting(plan, &setting, "scene unchanged");
    }
    return good;
}

/* References use bdf2, whose error decreases faster with the step length than that of euler. */
static bool make_references(struct plan *plan) {
    bool good = true;
    for (int k = 0; k < PLAN_REFERENCES; k++) {
        struct setting *setting = &plan->reference[k];
        double factor = 0.25 / (double)(1 << k) * real_factor(plan, 1.0);
        scale_step(setting, plan, factor);
        setting_add(setting, "time_step.integrator=bdf2");
        set_tolerance(setting, 0.01);
        if (asprintf(&setting->name, "bdf2, h x %g, to residual 0.01", factor) < 0)
            setting->name = NULL;
        good &= setting->name && !setting->failed;
    }
    return good;
}

bool plan_make(struct plan *plan, const json_t *scene, const struct time_window *window,
               double coarsening) {
    *plan = (struct plan){.scene = scene, .window = window, .coarsening = coarsening};
    return add_scene_steps(plan) && add_truncated_grid(plan) && add_solved_grid(plan) &&
           add_other_integrator(plan) && add_fixed_steps(plan) && add_solvers(plan) &&
           add_step_types(plan) && make_references(plan);
}

void plan_free(struct plan *plan) {
    for (int k = 0; k < plan->count; k++) setting_free(&plan->setting[k]);
    for (int k = 0; k < PLAN_REFERENCES; k++) setting_free(&plan->reference[k]);
    free(plan->setting);
}
