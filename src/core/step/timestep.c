#include "timestep.h"

#include "projdyn/vec3.h"

#include <math.h>

/* The largest speed of a particle with a radius at the end of a step of length h, as predicted. */
static double fastest(const struct pdyn_sim *sim, double h, double *radius) {
    double speed = 0.0;
    *radius = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (body->radius == 0.0) continue;
        *radius = body->radius;
        for (int i = body->first; i < body->first + body->count; i++)
            speed = fmax(speed, vec3_length(sim->v + 3 * i));
    }
    return speed + h * vec3_length(sim->scene.settings.gravity);
}

/* What holds up a body of water at rest, Pa: its weight on its lowest layer. */
static double resting_pressure(const struct pdyn_sim *sim, const pdyn_body *body) {
    const double *g = sim->scene.settings.gravity;
    double low = INFINITY, high = -INFINITY;
    for (int i = body->first; i < body->first + body->count; i++) {
        double depth = vec3_dot(g, sim->x + 3 * i);
        low = fmin(low, depth), high = fmax(high, depth);
    }
    return body->rest_density * fmax(0.0, high - low);
}

/* The pressure below which nearly all of the body is, Pa: the eighth power mean of what lasted for
 * two steps, 1.3 times, which is the pressure on the floor of water at rest. What an impact leaves
 * is gone in the next step; single particles count little. */
static double lasting_pressure(const struct pdyn_sim *sim, const pdyn_body *body) {
    double sum = 0.0, count = 1e-300;
    for (int i = body->first; i < body->first + body->count; i++) {
        double p = fmin(sim->pressure[i], sim->pressure_before[i]), squared = p * p;
        sum += squared * squared * squared * squared, count += p > 0.0;
    }
    return 1.3 * pow(sum / count, 0.125);
}

/* Particles under pressure swing in their arrangement as if tied by springs: its waves travel at
 * sqrt(p / rho). A step with multipliers takes the directions of the forces from where it starts,
 * so it must be short enough for these waves. Measured with one linearisation a step, in water at
 * rest: stable at 0.64 radii, not at 0.8. */
static const double most_swing = 0.6; /* radii */

static double swing_limit(const struct pdyn_sim *sim) {
    double limit = INFINITY;
    for (int b = 0; b < sim->bodies && sim->solver->dual; b++) {
        const pdyn_body *body = &sim->body[b];
        if (body->radius == 0.0) continue;
        double pressure =
            sim->last_h > 0.0 ? lasting_pressure(sim, body) : resting_pressure(sim, body);
        limit = fmin(limit, most_swing * body->radius * sqrt(body->rest_density / pressure));
    }
    return limit;
}

/* CFL (Weiler et al. 2016): no particle and no solid travels more than `cfl` radii in a step. A
 * step shrinks as far as it must at once, and grows by at most a tenth. */
static double adaptive(const struct pdyn_sim *sim) {
    const struct scene_settings *set = &sim->scene.settings;
    double radius, h = sim->last_h > 0.0 ? fmin(set->h_max, 1.1 * sim->last_h) : set->h_max;
    double speed =
        fmax(fastest(sim, h, &radius), kinematic_speed(&sim->motion, sim->time, sim->time + h));
    if (radius > 0.0 && speed * h > set->cfl * radius) h = set->cfl * radius / speed;
    return fmax(fmin(h, swing_limit(sim)), set->h_min);
}

/* What differs from the last step by rounding is as long as that: a factor of the matrix then
 * stays. */
static double same_length(const struct pdyn_sim *sim, double h) {
    return fabs(h - sim->last_h) < 1e-9 * h ? sim->last_h : h;
}

/* The rest of the way to the next frame is cut into equal steps, so that none is tiny. */
struct moment timestep_choose(const struct pdyn_sim *sim, double longest) {
    const struct scene_settings *set = &sim->scene.settings;
    double h = fmin(longest, set->h_fixed > 0.0 ? set->h_fixed : adaptive(sim));
    double rest = (double)(sim->frame + 1) * set->frame_interval - sim->time;
    double steps = ceil(rest / h * (1.0 - 1e-9));
    return (struct moment){same_length(sim, rest / fmax(1.0, steps)), steps <= 1.0};
}

/* The CFL condition would have a shorter step than the shortest. */
static void check_speed(struct pdyn_sim *sim, double h) {
    const struct scene_settings *set = &sim->scene.settings;
    double radius, way = fastest(sim, 0.0, &radius) * h;
    if (sim->warned || radius == 0.0 || way <= 2.0 * set->cfl * radius) return;
    sim->warned = true;
    context_log(
        sim->context, PDYN_LOG_WARNING,
        "at %g s: a particle travels %.3g radii in the shortest step of %g s (\"minimum\"); "
        "walls may not hold it",
        sim->time, way / radius, h);
}

void timestep_check(struct pdyn_sim *sim, double h, double residual) {
    const struct scene_settings *set = &sim->scene.settings;
    if (set->h_fixed == 0.0 && h <= set->h_min) check_speed(sim, h);
    bool solved = residual <= set->tolerance;
    double limit = set->h_fixed > 0.0 && !solved && !sim->warned ? swing_limit(sim) : INFINITY;
    if (h <= limit) return;
    sim->warned = true;
    context_log(sim->context, PDYN_LOG_WARNING,
                "at %g s: the fixed step of %g s is longer than the %g s that the pressure allows, "
                "and it was cut short (step residual %.2g): water this deep may be thrown about; "
                "use \"maximum\" instead of \"fixed\", or more iterations",
                sim->time, h, limit, residual);
}

void timestep_advance(struct pdyn_sim *sim, const struct moment *end) {
    if (end->frame) sim->frame++;
    sim->time =
        end->frame ? (double)sim->frame * sim->scene.settings.frame_interval : sim->time + end->h;
}
