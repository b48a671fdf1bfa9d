/* The warning "squeezed": particles of a fluid in a gap without room for them, between two surfaces
 * that do not yield. The fluid rests half a spacing from a surface, so a gap needs a whole one:
 *
 *     ===== solid =====
 *       o   o   o   o      gap < spacing: the particles are compressed, and load both surfaces
 *     ===== solid =====    with a force that no water has
 */
#include "sim/live_particles.h"
#include "sim/sim.h"
#include "sph/surface_samples.h"
#include "warn_of_step.h"

#include "projdyn/vec3.h"

/* Relative density error of a particle that counts, in this step and in the one before. Between
 * solids 0.6 spacings apart it is 0.3, and 0.01 where there is room for it. */
static const double max_error = 0.1;
/* Share of the pressure that it had one step earlier, at least: an impact rises at once. */
static const double lasting = 0.5;
/* The nearest points of two surfaces on opposite sides: cosine of the angle between the ways to
 * them. */
static const double opposite = -0.5;

/* ---- surfaces around a particle -------------------------------------------------------------- */

enum { MAX_SURFACES = 8 };

struct near {        /* the nearest point of a surface */
    int surface;     /* solids, then bodies */
    double distance; /* m, to the surface */
    double way[3];   /* unit vector to it */
};

struct around {
    int count;
    struct near near[MAX_SURFACES];
};

static void add_point(struct around *around, int surface, const double *x, const double *point,
                      double behind) {
    struct near new = {.surface = surface};
    int k = 0;
    vec3_subtract(new.way, point, x);
    new.distance = fmax(0.0, vec3_normalise(new.way) - behind);
    while (k < around->count && around->near[k].surface != surface) k++;
    if (k == MAX_SURFACES) return;
    if (k == around->count) around->near[around->count++] = new;
    else if (new.distance < around->near[k].distance) around->near[k] = new;
}

/* Whether a body does not yield: a rigid one that is held. */
static bool is_held(const struct pdyn_sim *sim, int b) {
    return sim->scene.body[b].is_rigid && sim_pins_body(sim, b);
}

static struct around look_around(const struct pdyn_sim *sim, int i) {
    const pdyn_neighbours *lists = objective_lists(&sim->objective);
    const struct surface_samples *samples = sim->objective.samples;
    const double *x = sim->x + 3 * (size_t)i;
    double behind = sim_behind_faces(sim);
    struct around around = {0};
    for (int m = lists->surface_start[i]; m < lists->boundary_start[i]; m++) {
        int sample = lists->index[m] - sim->objective.particles;
        int b = objective_body_of(&sim->objective, samples->vertex[3 * (size_t)sample]);
        double point[3];
        if (!is_held(sim, b)) continue;
        samples_at(samples, sample, sim->x, point);
        add_point(&around, sim->scene.solids + b, x, point, 0.0);
    }
    for (int m = lists->boundary_start[i]; m < lists->end[i]; m++) {
        int k = lists->index[m] - lists->particles;
        const struct boundary_point *point = &sim->boundary.point[k];
        add_point(&around, point->solid, x, sim->boundary.at.x + 3 * (size_t)k,
                  point->of_box ? behind : 0.0);
    }
    return around;
}

/* ---- the warning ----------------------------------------------------------------------------- */

static const char *name_of(const struct pdyn_sim *sim, int surface) {
    int solids = sim->scene.solids;
    return surface < solids ? sim->scene.solid[surface].name : sim->body[surface - solids].name;
}

/* Two surfaces on opposite sides of the particle, closer together than a spacing: pair, ascending.
 */
static bool is_between(const struct pdyn_sim *sim, const struct around *around, int pair[2]) {
    double spacing = sim_spacing(sim);
    for (int a = 0; a < around->count; a++)
        for (int b = a + 1; b < around->count; b++) {
            const struct near *p = &around->near[a], *q = &around->near[b];
            if (vec3_dot(p->way, q->way) > opposite || p->distance + q->distance >= spacing)
                continue;
            bool ordered = p->surface < q->surface;
            pair[0] = ordered ? p->surface : q->surface;
            pair[1] = ordered ? q->surface : p->surface;
            return true;
        }
    return false;
}

static double error_of(const struct pdyn_sim *sim, const pdyn_body *body, int i) {
    if (!particle_is_live(sim, i) || sim->pressure_before[i] < lasting * sim->pressure[i])
        return 0.0;
    return sim->density[i] / body->rest_density - 1.0;
}

void warn_of_gaps(struct pdyn_sim *sim, double density_error_max) {
    if (density_error_max <= max_error || !sim->objective.neighbours) return;
    int pair[2] = {0}, found[2] = {0}, count = 0;
    double worst = 0.0;
    const pdyn_body *fluid = NULL;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++) {
            double error = error_of(sim, body, i);
            if (error <= max_error) continue;
            struct around around = look_around(sim, i);
            if (!is_between(sim, &around, found)) continue;
            count++;
            if (error > worst) worst = error, fluid = body, pair[0] = found[0], pair[1] = found[1];
        }
    }
    if (!count) return;
    struct warning *w = sim_warning(sim, WARNING_SQUEEZED, name_of(sim, pair[1]), 1, worst);
    warnings_say(sim->context, w,
                 "in %ld of %ld steps particles of \"%s\" are squeezed between it and \"%s\", "
                 "compressed by up to %.3g %%: a gap below %.3g m, their spacing, has no room for "
                 "them, and the load on both is not that of the fluid",
                 w->count, sim->steps, fluid->name, name_of(sim, pair[0]), 100.0 * w->worst,
                 sim_spacing(sim));
}
