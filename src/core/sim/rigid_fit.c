#include "rigid_fit.h"

#include "projdyn/vec3.h"

#include <string.h>

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
    rigid_body_set_motion(body, x, middle, mean, w, v);
}

static bool is_touched(const struct rigid_body *body, int first, int count) {
    return first < rigid_body_end(body) && first + count > body->first;
}

pdyn_status rigid_fit_check(const struct pdyn_sim *sim, int first, int count) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++) {
        const struct rigid_body *body = &map->body[k];
        bool whole = first <= body->first && first + count >= body->first + body->vertices;
        if (is_touched(body, first, count) && !whole)
            return set_error(PDYN_BAD_INPUT,
                             "expected all vertices of the rigid body \"%s\", particles %d to "
                             "%d, or none, found particles %d to %d",
                             sim->body[objective_body_of(&sim->objective, body->first)].name,
                             body->first, body->first + body->vertices - 1, first,
                             first + count - 1);
    }
    return PDYN_OK;
}

void rigid_fit_positions(struct pdyn_sim *sim, int first, int count) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++)
        if (is_touched(&map->body[k], first, count)) fit_pose(&map->body[k], sim->x);
}

void rigid_fit_velocities(struct pdyn_sim *sim, int first, int count) {
    const struct rigid_map *map = sim->objective.rigid;
    for (int k = 0; map && k < map->bodies; k++)
        if (is_touched(&map->body[k], first, count)) fit_velocities(&map->body[k], sim->x, sim->v);
}
