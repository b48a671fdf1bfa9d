/* Choice of the step length, and warnings about steps that are too long. */
#include "timestep.h"

#include "sim/extent.h"
#include "sim/inlets.h"
#include "sim/live_particles.h"
#include "solid_approach.h"

#include "projdyn/vec3.h"

#include <math.h>

/* Upper bound of the acceleration of fluid particles by gravity and applied forces, m/s^2. */
static double max_acceleration(const struct pdyn_sim *sim) {
    const double *force = sim->control.force;
    double applied = 0.0;
    for (int b = 0; force && b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            applied = fmax(applied, vec3_length(force + 3 * i) / sim->objective.mass[i]);
    }
    return applied + vec3_length(sim->scene.settings.gravity);
}

static double max_speed(const struct pdyn_sim *sim, const pdyn_body *body) {
    double speed = 0.0;
    for (int i = body->first; i < body->first + body->count; i++)
        speed = fmax(speed, vec3_length(sim->v + 3 * i));
    return speed;
}

/* The largest number of its radii that a fluid particle travels in a step h at a speed of at least
 * `others` + h `acceleration`, m/s and m/s^2; 0: there are none. */
static double max_radii(const struct pdyn_sim *sim, double h, double acceleration, double others) {
    double radii = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        double speed = fmax(others, max_speed(sim, body) + h * acceleration);
        radii = fmax(radii, speed * h / body->radius);
    }
    return radii;
}

/* The largest speed of a vertex of a surface or a body that may meet fluid within h, m/s: it is in
 * the box around the fluids, or no farther away than it travels. */
static double surface_speed(const struct pdyn_sim *sim, double h) {
    const struct box fluids = sim->objective.samples ? extent_of_fluids(sim) : box_empty;
    double largest = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        for (int i = body->first; !body_is_particles(body) && i < body->first + body->count; i++) {
            double speed = vec3_length(sim->v + 3 * (size_t)i);
            struct box near = fluids;
            box_grow(&near, h * speed);
            if (box_contains(&near, sim->x + 3 * (size_t)i)) largest = fmax(largest, speed);
        }
    }
    return largest;
}

/* Hydrostatic pressure at the bottom of the fluids at rest, Pa, if all were the densest one. */
static double resting_pressure(const struct pdyn_sim *sim) {
    const double *g = sim->scene.settings.gravity;
    double low = INFINITY, high = -INFINITY, density = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        density = fmax(density, body->rest_density);
        for (int i = body->first; i < body->first + body->count; i++) {
            if (!particle_is_live(sim, i)) continue;
            double depth = vec3_dot(g, sim->x + 3 * i);
            low = fmin(low, depth), high = fmax(high, depth);
        }
    }
    return density * fmax(0.0, high - low);
}

/* The pressure below which nearly all particles of the body are, Pa: 1.3 times the eighth power
 * mean of the minimum over two steps. In water at rest it is the pressure on the floor. The
 * pressure of an impact, which lasts one step, and single particles have little effect. */
static double lasting_pressure(const struct pdyn_sim *sim, const pdyn_body *body) {
    double sum = 0.0, count = 1e-300;
    for (int i = body->first; i < body->first + body->count; i++) {
        double p = fmin(sim->pressure[i], sim->pressure_before[i]), squared = p * p;
        sum += squared * squared * squared * squared, count += p > 0.0;
    }
    return 1.3 * pow(sum / count, 0.125);
}

/* The arrangement of particles under pressure p oscillates like a lattice of springs with wave
 * speed sqrt(p / rho). A step with multipliers linearises forces at its start and must be short
 * compared with these waves. Measured with one linearisation per step in water at rest: stable at
 * 0.64 radii, unstable at 0.8. */
static const double max_rearrangement = 0.6; /* particle radii */

static double rearrangement_limit(const struct pdyn_sim *sim) {
    double limit = INFINITY;
    for (int b = 0; b < sim->bodies && solves_fluid_alone(sim); b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        double pressure = sim->last_h > 0.0 ? lasting_pressure(sim, body) : resting_pressure(sim);
        limit = fmin(limit, max_rearrangement * body->radius * sqrt(body->rest_density / pressure));
    }
    return limit;
}

double timestep_count(double time, double h) { return fmax(1.0, ceil(time / h * (1.0 - 1e-9))); }

/* The longest step after the last one, s: longer by 10 %. Ten steps or fewer, longer by 10 %, are
 * still as many in a frame: at its beginning a step may be so long that one fewer fills it. */
static double grown(const struct pdyn_sim *sim) {
    double interval = sim->scene.settings.frame_interval, last = sim->last_h;
    double begun = sim->time - (double)sim->frame * interval, longer = 1.1 * last;
    if (last == 0.0) return INFINITY;
    if (begun > 0.5 * last) return longer;
    return fmax(longer, interval / fmax(1.0, timestep_count(interval, last) - 1.0));
}

/* CFL condition (Weiler et al. 2016): no particle, surface near fluid, solid and inlet travels more
 * than `cfl` radii per step, radii of its body. Pressure and contact with moving solids limit the
 * step, too. The step length may shrink at once and grows slowly. */
static double adaptive(const struct pdyn_sim *sim) {
    const struct scene_settings *settings = &sim->scene.settings;
    double h = fmin(settings->h_max, grown(sim));
    double end = sim->time + h;
    double others = fmax(kinematic_speed(&sim->kinematic, sim->time, end),
                         inlets_top_speed(sim, sim->time, end));
    others = fmax(others, surface_speed(sim, h));
    double radii = max_radii(sim, h, max_acceleration(sim), others);
    if (radii > settings->cfl) h *= settings->cfl / radii;
    h = solid_approach_limit(sim, fmin(h, rearrangement_limit(sim)));
    return fmax(h, settings->h_min);
}

/* Returns the last length if h equals it up to rounding, so that a factored matrix stays valid. */
static double same_length(const struct pdyn_sim *sim, double h) {
    return fabs(h - sim->last_h) < 1e-9 * h ? sim->last_h : h;
}

/* A step that a program has given may end just before a frame, by less than this part of the next
 * step: that frame is left out. */
static const double least_rest = 1e-3;

/* Divides the time to the next frame into equal steps, which avoids a tiny last step. */
struct step_end timestep_choose(const struct pdyn_sim *sim, double longest) {
    const struct scene_settings *settings = &sim->scene.settings;
    double h = fmin(longest, settings->h_fixed > 0.0 ? settings->h_fixed : adaptive(sim));
    double frame = (double)(sim->frame + 1) * settings->frame_interval;
    if (frame - sim->time < least_rest * h) frame += settings->frame_interval;
    double rest = frame - sim->time, steps = timestep_count(rest, h);
    h = same_length(sim, rest / steps);
    return (struct step_end){h, steps <= 1.0 ? frame : sim->time + h, steps <= 1.0, false};
}

/* Number of frames up to a time, up to rounding. */
static long frames_until(const struct pdyn_sim *sim, double time) {
    return (long)floor(time / sim->scene.settings.frame_interval + 1e-9);
}

struct step_end timestep_given(const struct pdyn_sim *sim, double h) {
    h = same_length(sim, h);
    double time = sim->time + h;
    return (struct step_end){h, time, frames_until(sim, time) > sim->frame, true};
}

/* Warns if the CFL condition asks for a step shorter than the minimum. */
static void check_speed(struct pdyn_sim *sim, double h) {
    const struct scene_settings *settings = &sim->scene.settings;
    double radii = max_radii(sim, h, 0.0, 0.0);
    if (radii <= 2.0 * settings->cfl) return;
    struct warning *w = sim_warning(sim, WARNING_SHORT_STEP, "", 1, radii);
    warnings_say(sim->context, w,
                 "a particle travels up to %.3g radii in the shortest step of %g s (\"minimum\"): "
                 "walls may not hold it",
                 w->worst, h);
}

void timestep_check(struct pdyn_sim *sim, const struct step_end *end) {
    const struct scene_settings *settings = &sim->scene.settings;
    double h = end->h;
    bool free = settings->h_fixed > 0.0 || end->given;
    if (settings->h_fixed == 0.0 && h <= settings->h_min) check_speed(sim, h);
    double limit = free && !sim->solved ? rearrangement_limit(sim) : INFINITY;
    if (h <= limit) return;
    struct warning *w = sim_warning(sim, WARNING_LONG_STEP, "", 1, h / limit);
    warnings_say(sim->context, w,
                 "the %s step of %g s is up to %.2g times as long as the pressure allows, and "
                 "it is unsolved: water this deep may be thrown about",
                 end->given ? "given" : "fixed", h, w->worst);
}

void timestep_advance(struct pdyn_sim *sim, const struct step_end *end) {
    sim->frame = frames_until(sim, end->time); /* a frame may have been left out */
    sim->time = end->time;
}
