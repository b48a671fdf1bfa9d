#include "falling_jet.h"

#include "live_particles.h"
#include "scene/inlet_motion.h"
#include "sim.h"

#include "projdyn/vec3.h"

struct layer { /* means over its particles */
    int count;
    double centre[3], v[3], pressure;
};

static struct layer measure(const struct pdyn_sim *sim, int pusher) {
    struct layer sum = {0};
    for (int i = 0; i < sim->objective.particles; i++) {
        if (sim->live->pusher[i] != pusher) continue;
        vec3_add(sum.centre, 1.0, sim->x + 3 * (size_t)i);
        vec3_add(sum.v, 1.0, sim->v + 3 * (size_t)i);
        sum.pressure += sim->pressure[i], sum.count++;
    }
    double part = 1.0 / fmax(1.0, sum.count);
    for (int a = 0; a < 3; a++) sum.centre[a] *= part, sum.v[a] *= part;
    sum.pressure *= part;
    return sum;
}

/* From the axis through the centre of the layer along n to particle i. */
static void radius_of(const struct pdyn_sim *sim, const struct layer *layer, const double n[3],
                      int i, double r[3]) {
    vec3_subtract(r, sim->x + 3 * (size_t)i, layer->centre);
    vec3_add(r, -vec3_dot(r, n), n);
}

static double largest_radius(const struct pdyn_sim *sim, const struct layer *layer,
                             const double n[3], int pusher) {
    double r[3], largest = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) {
        if (sim->live->pusher[i] != pusher) continue;
        radius_of(sim, layer, n, i, r);
        largest = fmax(largest, vec3_length(r));
    }
    return largest;
}

/* Adds `rate` times the radius to the velocity, as if it had moved so before. */
static void add_radial(struct pdyn_sim *sim, int i, double rate, const double r[3]) {
    vec3_add(sim->v + 3 * (size_t)i, rate, r);
    if (!sim->x_before) return;
    vec3_add(sim->v_before + 3 * (size_t)i, rate, r);
    vec3_add(sim->x_before + 3 * (size_t)i, -rate * sim->history, r);
}

void falling_jet_narrow(struct pdyn_sim *sim, const struct live_inlet *inlet, int pusher) {
    const double *gravity = sim->scene.settings.gravity;
    const pdyn_body *body = &sim->body[inlet->body];
    const struct layer layer = measure(sim, pusher);
    double n[3], r[3], spacing = 2.0 * body->radius;
    inlet_direction(inlet->from, sim->time, n);
    double g = vec3_dot(gravity, n), speed = vec3_dot(layer.v, n);
    double pressure_of_layer = body->rest_density * vec3_length(gravity) * spacing;
    if (!layer.count || !(g > 0.0) || !(speed > 0.0) || layer.pressure > pressure_of_layer) return;
    /* bounded by the speed of the jet over its radius */
    double rate =
        -fmin(0.5 * g / speed, speed / fmax(spacing, largest_radius(sim, &layer, n, pusher)));
    for (int i = 0; i < sim->objective.particles; i++) {
        if (sim->live->pusher[i] != pusher) continue;
        radius_of(sim, &layer, n, i, r);
        add_radial(sim, i, rate, r);
    }
}
