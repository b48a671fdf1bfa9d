#include "rigid_bodies.h"

#include "free_rotation.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- angular momentum ------------------------------------------------------------------------ */

/* Of the points at x with velocities v, about their centre. */
static void angular_momentum(const struct rigid_body *body, const double *x, const double *v,
                             double L[3]) {
    double c[3], sum[3];
    rigid_body_centre(body, x, c);
    rigid_body_moment(body, body->first + body->vertices, x, c, v, sum, L);
    for (int a = 0; a < 3; a++) L[a] *= body->mass / RIGID_POINTS;
}

/* Sets v of the body at positions x with the momentum m velocity and the angular momentum L. */
static void set_velocities(const struct rigid_body *body, const double *x, const double velocity[3],
                           const double L[3], double *v) {
    double c[3], I[9], w[3];
    rigid_body_centre(body, x, c);
    rigid_body_inertia(body, x, c, I);
    vec3_solve(w, I, L);
    rigid_body_set_motion(body, x, c, velocity, w, v);
}

void rigid_bodies_project(const struct pdyn_sim *sim, const double *x, double *v) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++) {
        double velocity[3], L[3];
        rigid_body_centre(&map->body[k], v, velocity);
        angular_momentum(&map->body[k], x, v, L);
        set_velocities(&map->body[k], x, velocity, L, v);
    }
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* L^ = L_n + c (L_n - L_(n-1)); change: the difference. */
static void base_momentum(const struct pdyn_sim *sim, const struct rigid_body *body, double L[3],
                          double change[3]) {
    double before[3], part = sim->objective.extrapolation;
    memset(change, 0, 3 * sizeof *change);
    angular_momentum(body, sim->x, sim->v, L);
    if (part == 0.0) return;
    angular_momentum(body, sim->x_before, sim->v_before, before);
    vec3_subtract(change, L, before);
    vec3_add(L, part, change);
}

/* rad: beyond this c (e - h_b I^-1 (L_n - L_(n-1))) is left out. It is a rotation of second order
 * in the step, but an impact on a rod turns the rod about its axis by radians, which do not add up.
 */
static const double largest_correction = 0.1;

/* R^, from R_n. */
static void base_rotation(const struct pdyn_sim *sim, const struct rigid_body *body,
                          const double change[3], double R[9]) {
    double L[3], before[9], free[9], error[3], I[9], w[3], part = sim->objective.extrapolation;
    rigid_body_matrix(body, sim->x, R);
    if (part == 0.0) return;
    rigid_body_matrix(body, sim->x_before, before);
    angular_momentum(body, sim->x_before, sim->v_before, L);
    rotate_free(body, L, sim->history, before);
    rotation_multiply_transposed(R, before, free);
    rotation_vector(free, error);
    rigid_inertia_at(body, R, I);
    vec3_solve(w, I, change);
    for (int a = 0; a < 3; a++) error[a] = part * (error[a] - sim->history * w[a]);
    angular_momentum(body, sim->x, sim->v, L);
    rotate_free(body, L, sim->objective.length - sim->objective.h, R);
    if (vec3_length(error) <= largest_correction) rotation_turn(error, R);
}

/* s of the centre, and the angular momentum by the forces that a program applies, which act at x_n.
 */
static void add_applied(const struct pdyn_sim *sim, struct rigid_body *body, double s[3]) {
    double h_e = sim->objective.h, c[3], velocity[3], force[3] = {0}, moment[3] = {0};
    rigid_body_centre(body, sim->x, c);
    if (sim->control.force)
        rigid_body_moment(body, body->first, sim->x, c, sim->control.force, force, moment);
    rigid_body_centre(body, sim->x_base, s);
    rigid_body_centre(body, sim->v_base, velocity);
    vec3_add(s, h_e, velocity);
    vec3_add(s, h_e * h_e, sim->scene.settings.gravity);
    vec3_add(s, h_e * h_e / body->mass, force);
    vec3_add(body->momentum, h_e, moment);
}

static void predict_bodies(void *arg, int first, int last, int block) {
    (void)block;
    struct pdyn_sim *sim = arg;
    for (int k = first; k < last; k++) {
        struct rigid_body *body = &sim->objective.rigid->body[k];
        double c[3], s[3], R[9], change[3];
        base_momentum(sim, body, body->momentum, change);
        base_rotation(sim, body, change, R);
        rigid_body_centre(body, sim->x_base, c);
        add_applied(sim, body, s);
        rigid_body_place(body, c, R, sim->x_base);
        rotate_free(body, body->momentum, sim->objective.h, R);
        rigid_body_place(body, s, R, sim->objective.s);
    }
}

void rigid_bodies_predict(struct pdyn_sim *sim) {
    const struct rigid_map *map = sim->objective.rigid;
    if (map) pool_for(sim->context->pool, map->bodies, RIGID_GRAIN, predict_bodies, sim);
}

/* L += h_e T, with the moment T about the centre of the forces of constraints. At the end of a step
 * they equal the inertial forces m (x - s) / h_e^2 of the points, m: the body's mass over their
 * number. */
static void add_impulse(const struct pdyn_sim *sim, const struct rigid_body *body, double L[3]) {
    double c[3], moment[3] = {0}, h_e = sim->objective.h;
    rigid_body_centre(body, sim->x_next, c);
    for (int i = body->first + body->vertices; i < rigid_body_end(body); i++) {
        double r[3], moved[3], turn[3];
        vec3_subtract(r, sim->x_next + 3 * (size_t)i, c);
        vec3_subtract(moved, sim->x_next + 3 * (size_t)i, sim->objective.s + 3 * (size_t)i);
        vec3_cross(turn, r, moved);
        vec3_add(moment, body->mass / RIGID_POINTS / h_e, turn);
    }
    vec3_add(L, 1.0, moment);
}

void rigid_bodies_set_velocities(struct pdyn_sim *sim) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++) {
        const struct rigid_body *body = &map->body[k];
        double velocity[3], L[3] = {body->momentum[0], body->momentum[1], body->momentum[2]};
        rigid_body_centre(body, sim->v, velocity);
        add_impulse(sim, body, L);
        set_velocities(body, sim->x_next, velocity, L, sim->v);
    }
}

/* ---- creation -------------------------------------------------------------------------------- */

/* Share of its mass that a body's vertices have, so that no particle has the mass 0. */
static const double vertex_share = 1e-14;

static void start_body(struct pdyn_sim *sim, int b, struct rigid_body *body) {
    const struct scene_body *from = &sim->scene.body[b];
    double *mass = sim->objective.mass + sim->body[b].first;
    *body = (struct rigid_body){
        .first = sim->body[b].first, .vertices = sim->body[b].count, .mass = from->mass};
    for (int i = 0; i < rigid_body_particles(body); i++)
        mass[i] = i < body->vertices ? vertex_share * from->mass / body->vertices
                                     : from->mass / RIGID_POINTS;
    rigid_body_set_motion(body, sim->x, from->centre, from->velocity, from->angular_velocity,
                          sim->v);
}

pdyn_status rigid_bodies_create(struct pdyn_sim *sim) {
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) count += sim->scene.body[b].is_rigid;
    if (!count) return PDYN_OK;
    struct rigid_map *map = sim->objective.rigid = NEW_ARRAY(sim->context, 1, struct rigid_map);
    if (!map) return PDYN_NO_MEMORY;
    map->context = sim->context, map->particles = sim->objective.particles;
    map->body = NEW_ARRAY(sim->context, count, struct rigid_body);
    if (!map->body) return PDYN_NO_MEMORY;
    for (int b = 0; b < sim->bodies; b++)
        if (sim->scene.body[b].is_rigid) start_body(sim, b, &map->body[map->bodies++]);
    pdyn_status status = rigid_map_create(map, sim->rest);
    return status == PDYN_OK ? rigid_matrix_create(map, &sim->objective.rigid_matrix) : status;
}
