#include "probe_wall.h"

#include "probes.h"
#include "scene/poses.h"
#include "sim.h"
#include "sph/surface_samples.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- points of walls ------------------------------------------------------------------------- */

struct wall {
    const struct pdyn_sim *sim;
    const struct scene_probe *probe;
    const double *at; /* m */
    double radius;    /* m */
    int points;       /* boundary points; samples of a wall of a rigid body */
    int solid;        /* whose rotation is R; -1: none yet */
    double R[9];      /* rotation of the solid from its initial placement */
};

struct wall_point {
    double x[3], normal[3], area; /* m, 1, m^2 */
    const double *force;          /* N */
};

static struct wall wall_at(const struct pdyn_sim *sim, const struct probe_place *place,
                           double radius) {
    const struct scene_probe *probe = place->probe;
    int samples = sim->objective.samples ? sim->objective.samples->count : 0;
    return (struct wall){.sim = sim,
                         .probe = probe,
                         .at = place->x,
                         .radius = radius,
                         .points = probe->on_body >= 0 ? samples : sim->boundary.at.count,
                         .solid = -1};
}

/* The normal of a boundary point where its solid is. The points of a solid follow each other, so
 * its pose is computed once. */
static void turn_normal(struct wall *wall, const struct boundary_point *point, double normal[3]) {
    const struct scene_motion *motion = &wall->sim->scene.solid[point->solid].motion;
    memcpy(normal, point->normal, sizeof point->normal);
    if (!motion->keys) return;
    if (wall->solid != point->solid) {
        struct pose pose = pose_at(motion, wall->sim->time);
        vec3_rotation(wall->R, pose.at.rotate);
        wall->solid = point->solid;
    }
    vec3_multiply(normal, wall->R, point->normal);
}

static bool is_near(const struct wall *wall, const double *x) {
    return vec3_distance(x, wall->at) < wall->radius;
}

static bool find_boundary_point(struct wall *wall, int k, struct wall_point *out) {
    const struct boundary_points *points = &wall->sim->boundary;
    int on = wall->probe->on_solid;
    if (on >= 0 && points->point[k].solid != on) return false;
    memcpy(out->x, points->at.x + 3 * (size_t)k, sizeof out->x);
    if (!is_near(wall, out->x)) return false;
    turn_normal(wall, &points->point[k], out->normal);
    out->area = points->point[k].area;
    out->force = wall->sim->loads->force + 3 * (size_t)k;
    return true;
}

static bool find_sample(const struct wall *wall, int k, struct wall_point *out) {
    const struct pdyn_sim *sim = wall->sim;
    const struct surface_samples *samples = sim->objective.samples;
    if (!body_has(&sim->body[wall->probe->on_body], samples->vertex[3 * (size_t)k])) return false;
    samples_at(samples, k, sim->x, out->x);
    if (!is_near(wall, out->x)) return false;
    samples_normal(samples, k, sim->x, out->normal);
    vec3_normalise(out->normal);
    out->area = samples->rest_area[k];
    out->force = sim->probes->sample_force + 3 * (size_t)k;
    return true;
}

/* Whether point k of the wall is within the radius. */
static bool find_point(struct wall *wall, int k, struct wall_point *out) {
    return wall->probe->on_body >= 0 ? find_sample(wall, k, out)
                                     : find_boundary_point(wall, k, out);
}

/* ---- sums ------------------------------------------------------------------------------------ */

/* The normal of the wall at the place: of the point within the radius whose plane is nearest to the
 * place. Both faces of a thin wall may have points within the radius. 0: there is none. */
static void wall_normal(struct wall *wall, double normal[3]) {
    double nearest = INFINITY;
    normal[0] = normal[1] = normal[2] = 0.0;
    for (int k = 0; k < wall->points; k++) {
        struct wall_point point;
        double d[3];
        if (!find_point(wall, k, &point)) continue;
        vec3_subtract(d, point.x, wall->at);
        if (vec3_dot(point.normal, point.normal) == 0.0 ||
            fabs(vec3_dot(point.normal, d)) >= nearest)
            continue;
        nearest = fabs(vec3_dot(point.normal, d));
        memcpy(normal, point.normal, sizeof point.normal);
    }
}

/* The area of the points around the place, m^2, and the force on them, N, with weights
 * 1 - distance^2 / radius^2. Points whose normal is more than 60 degrees from that of the wall do
 * not count: they are on its other face, or around a corner. force NULL: not wanted. */
static double near_area(struct wall *wall, double force[3]) {
    double area = 0.0, normal[3];
    wall_normal(wall, normal);
    for (int k = 0; k < wall->points; k++) {
        struct wall_point point;
        if (!find_point(wall, k, &point) || vec3_dot(point.normal, normal) < 0.5) continue;
        double d = vec3_distance(point.x, wall->at) / wall->radius;
        area += (1.0 - d * d) * point.area;
        if (force) vec3_add(force, 1.0 - d * d, point.force);
    }
    return area;
}

bool probe_wall_exists(const struct pdyn_sim *sim, const struct probe_place *place, double radius) {
    struct wall wall = wall_at(sim, place, radius);
    return near_area(&wall, NULL) > 0.0;
}

double probe_wall_pressure(const struct pdyn_sim *sim, const struct probe_place *place,
                           double radius) {
    struct wall wall = wall_at(sim, place, radius);
    double force[3] = {0};
    solid_load_compute(sim, PDYN_LOAD_FLUID);
    double area = near_area(&wall, force);
    return area > 0.0 ? vec3_length(force) / area : 0.0;
}

/* ---- forces on samples ----------------------------------------------------------------------- */

/* batch_force leaves the gradient with respect to samples in their output. The volumes of samples
 * on a rigid body are constant, so they add no force. */
void probe_wall_sum(const struct pdyn_sim *sim) {
    const struct surface_samples *samples = sim->objective.samples;
    double *force = sim->probes->sample_force;
    memset(force, 0, 3 * (size_t)samples->count * sizeof *force);
    for (int b = 0; b < sim->objective.batches; b++) {
        struct batch *batch = sim->objective.batch[b];
        if (!batch->op) continue;
        batch_force(batch, batch->one_sided.mean, sim->trial);
        for (int k = 0; k < samples->active_count; k++)
            vec3_add(force + 3 * (size_t)samples->active[k], -1.0,
                     samples->output + 3 * (size_t)(samples->particles + samples->active[k]));
    }
}
