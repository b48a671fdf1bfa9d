#include "damping.h"

#include <math.h>

/* Damping begins with the first value. Below the last one it is 0: H changes less than a linear
 * solve resolves. */
static const double first_damping = 1e-6, last_damping = 1e-7;

/* Factors by which eps changes. A factor of 10 finds the damping that a step needs in few
 * iterations. A dual solver takes a smaller one, because it changes eps in both directions until
 * steps neither overshoot nor fall short. */
static const double usual_factor = 10.0, dual_factor = 4.0;

/* Beyond this part of the slope before a step, the slope after it says that the step was too long,
 * where it is positive, or too short: half of it is halfway between a step to the minimum and one
 * that has no effect. */
static const double slope_part = 0.5;

static const double smallest_slope = 1e-300; /* no division by 0 */

static double more_damping(double eps, double factor) {
    return fmin(1.0, fmax(factor * eps, first_damping));
}

static double less_damping(double eps, double factor) {
    return eps > last_damping ? eps / factor : 0.0;
}

static double adapt_to_slope(double eps, const struct line_step *step) {
    double overshoot = step->slope_after / fmax(fabs(step->slope), smallest_slope);
    if (step->length < 1.0 || overshoot > slope_part) return more_damping(eps, dual_factor);
    return overshoot < -slope_part ? less_damping(eps, dual_factor) : eps;
}

static double adapt_to_length(double eps, const struct line_step *step) {
    return step->length < 1.0 ? more_damping(eps, usual_factor) : less_damping(eps, usual_factor);
}

double damping_at_start(const struct pdyn_sim *sim) {
    if (!sim->solver->dual) return sim->eps;
    if (!solves_fluid_alone(sim) && sim->far_off) return 0.0;
    return sim->scene.settings.newton ? less_damping(sim->eps, dual_factor) : sim->eps;
}

double damping_after(const struct pdyn_sim *sim, const struct line_step *taken) {
    if (!sim->scene.settings.newton) return sim->eps;
    return sim->solver->dual ? adapt_to_slope(sim->eps, taken) : adapt_to_length(sim->eps, taken);
}
