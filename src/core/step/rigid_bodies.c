#include "rigid_bodies.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- rotations, 3 x 3 matrices row by row ---------------------------------------------------- */

/* C = A B' */
static void multiply_transposed(const double A[9], const double B[9], double C[9]) {
    for (int k = 0; k < 9; k++) C[k] = vec3_dot(A + 3 * (k / 3), B + 3 * (k % 3));
}

/* R becomes exp([w]) R, by Rodrigues' formula for each column. */
static void rotate(const double w[3], double R[9]) {
    double angle = vec3_length(w), half = 0.5 * angle;
    double s = angle > 1e-8 ? sin(angle) / angle : 1.0;
    double c = angle > 1e-8 ? 2.0 * sin(half) * sin(half) / (angle * angle) : 0.5;
    for (int k = 0; k < 3; k++) {
        const double column[3] = {R[k], R[3 + k], R[6 + k]};
        double once[3], twice[3];
        vec3_cross(once, w, column);
        vec3_cross(twice, w, once);
        for (int a = 0; a < 3; a++) R[3 * a + k] += s * once[a] + c * twice[a];
    }
}

/* The vector w with exp([w]) = R, for angles below pi. */
static void logarithm(const double R[9], double w[3]) {
    const double axis[3] = {R[7] - R[5], R[2] - R[6], R[3] - R[1]}; /* 2 sin(angle) axis */
    double sine = 0.5 * vec3_length(axis), angle = atan2(sine, 0.5 * (R[0] + R[4] + R[8] - 1.0));
    double scale = sine > 1e-8 ? 0.5 * angle / sine : 0.5;
    for (int a = 0; a < 3; a++) w[a] = scale * axis[a];
}

/* ---- free rotation --------------------------------------------------------------------------- */

/* I = R I_0 R', with the inertia tensor I_0 at rest. */
static void turn_inertia(const struct rigid_body *body, const double R[9], double I[9]) {
    double half[9];
    multiply_transposed(R, body->inertia, half);
    multiply_transposed(half, R, I);
}

/* w = I^-1 L at the rotation exp([turn]) R. */
static void spin_at(const struct rigid_body *body, const double turn[3], const double R[9],
                    const double L[3], double w[3]) {
    double turned[9], I[9];
    memcpy(turned, R, sizeof turned);
    rotate(turn, turned);
    turn_inertia(body, turned, I);
    vec3_solve(w, I, L);
}

/* A substep of the commutator-free method of order 4 by Celledoni, Marthinsen and Owren (2003). */
static void turn_free(const struct rigid_body *body, const double L[3], double t, double R[9]) {
    double k[4][3], turn[3], half[9];
    spin_at(body, (const double[3]){0}, R, L, k[0]);
    for (int m = 1; m < 3; m++) {
        for (int a = 0; a < 3; a++) turn[a] = 0.5 * t * k[m - 1][a];
        spin_at(body, turn, R, L, k[m]);
    }
    memcpy(half, R, sizeof half);
    for (int a = 0; a < 3; a++) turn[a] = 0.5 * t * k[0][a];
    rotate(turn, half);
    for (int a = 0; a < 3; a++) turn[a] = t * (k[2][a] - 0.5 * k[0][a]);
    spin_at(body, turn, half, L, k[3]);
    for (int m = 0; m < 2; m++) {
        double first = m ? -1.0 : 3.0, last = m ? 3.0 : -1.0;
        for (int a = 0; a < 3; a++)
            turn[a] = t / 12.0 * (first * k[0][a] + 2.0 * k[1][a] + 2.0 * k[2][a] + last * k[3][a]);
        rotate(turn, R);
    }
}

/* Angle of a substep, and the number of these in a step at most. */
static const double max_angle = 0.02;
enum { MAX_SUBSTEPS = 1000 };

/* R becomes F(t; R, L). */
static void rotate_free(const struct rigid_body *body, const double L[3], double t, double R[9]) {
    double w[3];
    spin_at(body, (const double[3]){0}, R, L, w);
    double angle = fabs(t) * vec3_length(w);
    int count = angle < max_angle * MAX_SUBSTEPS ? 1 + (int)(angle / max_angle) : MAX_SUBSTEPS;
    for (int k = 0; k < count; k++) turn_free(body, L, t / count, R);
}

/* ---- angular momentum ------------------------------------------------------------------------ */

/* Of the points at x with velocities v, about their centre. */
static void angular_momentum(const struct rigid_body *body, const double *x, const double *v,
                             double L[3]) {
    double c[3], sum[3];
    rigid_body_centre(body, x, c);
    rigid_body_moment(body, body->first + body->vertices, x, c, v, sum, L);
    for (int a = 0; a < 3; a++) L[a] *= body->mass / RIGID_POINTS;
}

/* v = velocity + w x (x - c) for the body's particles */
static void set_motion(const struct rigid_body *body, const double *x, const double c[3],
                       const double velocity[3], const double w[3], double *v) {
    for (int i = body->first; i < body->first + body->vertices + RIGID_POINTS; i++) {
        double r[3];
        vec3_subtract(r, x + 3 * (size_t)i, c);
        vec3_cross(v + 3 * (size_t)i, w, r);
        vec3_add(v + 3 * (size_t)i, 1.0, velocity);
    }
}

/* Sets v of the body at positions x with the momentum m velocity and the angular momentum L. */
static void set_velocities(const struct rigid_body *body, const double *x, const double velocity[3],
                           const double L[3], double *v) {
    double c[3], I[9], w[3];
    rigid_body_centre(body, x, c);
    rigid_body_inertia(body, x, c, I);
    vec3_solve(w, I, L);
    set_motion(body, x, c, velocity, w, v);
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

/* R^, from R_n. */
static void base_rotation(const struct pdyn_sim *sim, const struct rigid_body *body,
                          const double change[3], double R[9]) {
    double L[3], before[9], free[9], error[3], I[9], w[3], part = sim->objective.extrapolation;
    rigid_body_matrix(body, sim->x, R);
    if (part == 0.0) return;
    rigid_body_matrix(body, sim->x_before, before);
    angular_momentum(body, sim->x_before, sim->v_before, L);
    rotate_free(body, L, sim->history, before);
    multiply_transposed(R, before, free);
    logarithm(free, error);
    turn_inertia(body, R, I);
    vec3_solve(w, I, change);
    for (int a = 0; a < 3; a++) error[a] = part * (error[a] - sim->history * w[a]);
    angular_momentum(body, sim->x, sim->v, L);
    rotate_free(body, L, sim->objective.length - sim->objective.h, R);
    rotate(error, R);
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

/* h_e T, from the inertial forces m (x - s) / h_e^2 of the points, which balance those of
 * constraints. The part of them without moment is the same in x and s. */
static void add_impulse(const struct pdyn_sim *sim, const struct rigid_body *body, double L[3]) {
    double c[3], moment[3] = {0}, h_e = sim->objective.h;
    rigid_body_centre(body, sim->x_next, c);
    for (int i = body->first + body->vertices; i < body->first + body->vertices + RIGID_POINTS;
         i++) {
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

/* ---- what a program sets --------------------------------------------------------------------- */

/* Mean of the vertices of a body in a vector. */
static void mean_of(const struct rigid_body *body, const double *x, double mean[3]) {
    memset(mean, 0, 3 * sizeof *mean);
    for (int i = 0; i < body->vertices; i++)
        vec3_add(mean, 1.0 / body->vertices, x + 3 * (size_t)i);
}

/* The pose whose vertices are closest to x (vertices x 3) in their affine map. */
static void fit_pose(const struct rigid_body *body, double *x) {
    double *own = x + 3 * (size_t)body->first, mean[3], rest[3], M[9] = {0}, N[9] = {0}, A[9], R[9];
    mean_of(body, own, mean), mean_of(body, body->rest, rest);
    for (int i = 0; i < body->vertices; i++) {
        double r[3], q[3];
        vec3_subtract(r, own + 3 * (size_t)i, mean);
        vec3_subtract(q, body->rest + 3 * (size_t)i, rest);
        for (int k = 0; k < 9; k++) M[k] += q[k / 3] * q[k % 3], N[k] += r[k / 3] * q[k % 3];
    }
    for (int k = 0; k < 3; k++) vec3_solve(A + 3 * k, M, N + 3 * k);
    rigid_closest_rotation(A, R);
    double arm[3], turned[3];
    vec3_subtract(arm, body->centre, rest);
    vec3_multiply(turned, R, arm);
    vec3_add(turned, 1.0, mean);
    rigid_body_place(body, turned, R, x);
}

/* The velocities of a rigid motion closest to those of the vertices. */
static void fit_velocities(const struct rigid_body *body, const double *x, double *v) {
    const double *at = x + 3 * (size_t)body->first, *own = v + 3 * (size_t)body->first;
    double middle[3], mean[3], K[9] = {0}, moment[3] = {0}, w[3];
    mean_of(body, at, middle), mean_of(body, own, mean);
    for (int i = 0; i < body->vertices; i++) {
        double r[3], u[3], turn[3];
        vec3_subtract(r, at + 3 * (size_t)i, middle);
        vec3_subtract(u, own + 3 * (size_t)i, mean);
        vec3_cross(turn, r, u);
        vec3_add(moment, 1.0, turn);
        rigid_add_inertia(K, 1.0, r);
    }
    vec3_solve(w, K, moment);
    set_motion(body, x, middle, mean, w, v);
}

static bool is_touched(const struct rigid_body *body, int first, int count) {
    return first < body->first + body->vertices + RIGID_POINTS && first + count > body->first;
}

pdyn_status rigid_bodies_check(const struct pdyn_sim *sim, int first, int count) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++) {
        const struct rigid_body *body = &map->body[k];
        bool whole = first <= body->first && first + count >= body->first + body->vertices;
        if (is_touched(body, first, count) && !whole)
            return context_fail(sim->context, PDYN_BAD_INPUT,
                                "expected all vertices of the rigid body \"%s\", particles %d to "
                                "%d, or none, found particles %d to %d",
                                sim->body[objective_body_of(&sim->objective, body->first)].name,
                                body->first, body->first + body->vertices - 1, first,
                                first + count - 1);
    }
    return PDYN_OK;
}

void rigid_bodies_fit(const struct pdyn_sim *sim, int first, int count, double *x, double *v) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++) {
        if (!is_touched(&map->body[k], first, count)) continue;
        if (v) fit_velocities(&map->body[k], x, v);
        else fit_pose(&map->body[k], x);
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
    for (int i = 0; i < body->vertices + RIGID_POINTS; i++)
        mass[i] = i < body->vertices ? vertex_share * from->mass / body->vertices
                                     : from->mass / RIGID_POINTS;
    set_motion(body, sim->x, from->centre, from->velocity, from->angular_velocity, sim->v);
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
    return rigid_map_create(map, sim->rest, sim->objective.mass);
}
