/* Impacts with bdf2 (docs/theory/time-integration.md#impacts). */
#include "impacts.h"

#include "sim/rigid_bodies.h"

#include "base/groups.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* The part of an impulse, dv, m/s, that points get: it changes v by at most twice the distance to
 * the Euler velocity, (x_next - x) / h, and v_before by at most twice the distance to v; each is
 * the norm over the points. Without this bound, a light vertex or body that other forces hold
 * against the impulse would get far too large a velocity. */
static double kept_part(const struct pdyn_sim *sim, int first, int points, double h,
                        const double *dv) {
    double part = sim->objective.h / h, size = 0.0, missing = 0.0, changed = 0.0;
    for (int k = 3 * first; k < 3 * (first + points); k++) {
        double left = (sim->x_next[k] - sim->x[k]) / h - sim->v[k];
        double change = sim->v[k] - sim->v_before[k];
        size += dv[k] * dv[k], missing += left * left, changed += change * change;
    }
    double kept = 1.0, lost = (1.0 - part) * sqrt(size), gained = part * sqrt(size);
    if (lost * lost > 4.0 * missing) kept = 2.0 * sqrt(missing) / lost;
    return gained > 2.0 * sqrt(changed) ? fmin(kept, 2.0 * sqrt(changed) / gained) : kept;
}

struct impulses {    /* of the impacts of a step, over the mass */
    double *all;     /* particles x 3, m/s */
    double *between; /* particles x 3, m/s: of impacts between particles alone */
    double *kept;    /* particles: the part that the velocities receive */
};

/* Sets `kept` of a body. The points of a rigid body have the same part: with different ones, an
 * impulse would get another moment. */
static void find_kept(const struct pdyn_sim *sim, const struct objective_body *body, double h,
                      const struct impulses *impulses) {
    const struct rigid_map *map = sim->objective.rigid;
    int rigid = map ? map->owner[body->first] : -1, end = body->first + body->count;
    if (rigid < 0) {
        for (int i = body->first; i < end; i++)
            impulses->kept[i] = kept_part(sim, i, 1, h, impulses->all);
        return;
    }
    double kept = kept_part(sim, end - RIGID_POINTS, RIGID_POINTS, h, impulses->all);
    for (int i = body->first; i < end; i++) impulses->kept[i] = kept;
}

/* Moves the impulses of a body in v from the weight h_e to the weight h_e^2 / h, and adds the
 * latter to v_before. The pins of the body get the rest (sim->impacts.passed_on). */
static void shift_velocities(struct pdyn_sim *sim, int b, double h, struct impulses *impulses) {
    const struct objective *objective = &sim->objective;
    const struct objective_body *body = &objective->body[b];
    const double *impulse = impulses->all;
    double part = objective->h / h, *passed_on = sim->impacts.passed_on + 3 * (size_t)b;
    bool pinned = sim_pins_body(sim, b);
    memset(passed_on, 0, 3 * sizeof *passed_on);
    find_kept(sim, body, h, impulses);
    for (int i = body->first; i < body->first + body->count; i++) {
        double own = impulses->kept[i], left = objective->mass[i] * (1.0 - own);
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            sim->v[k] -= own * (1.0 - part) * impulse[k];
            sim->v_before[k] += own * part * impulse[k];
            passed_on[k % 3] += pinned ? left / objective->h * impulse[k] : 0.0;
        }
        if (pinned) impulses->kept[i] = 1.0;
    }
}

/* share[i]: size of the impulse of particle i, kg m/s; for the points of a rigid body four times
 * the root of their mean square, which is the same for all four points that can stand for the body.
 */
static void find_shares(const struct pdyn_sim *sim, const double *between, double *share) {
    const struct objective *objective = &sim->objective;
    const struct rigid_map *map = objective->rigid;
    for (int i = 0; i < objective->particles; i++)
        share[i] = objective->mass[i] * vec3_length(between + 3 * (size_t)i);
    for (int b = 0; map && b < map->bodies; b++) {
        double *point = share + map->body[b].first + map->body[b].vertices, sum = 0.0;
        for (int k = 0; k < RIGID_POINTS; k++) sum += point[k] * point[k];
        for (int k = 0; k < RIGID_POINTS; k++) point[k] = sqrt(RIGID_POINTS * sum);
    }
}

/* Groups of particles that impacts join in this step. A rigid body is in one group. With impacts of
 * an operator between particles, which has no rows, all particles are. */
static void find_groups(struct pdyn_sim *sim) {
    const struct rigid_map *map = sim->objective.rigid;
    int *group = sim->impacts.group;
    bool all = false;
    for (int b = 0; b < sim->objective.batches; b++) {
        const struct batch *batch = sim->objective.batch[b];
        all |= !sim->anchored && batch->op && batch_has_impacts(batch);
    }
    for (int i = 0; i < sim->objective.particles; i++) {
        int owner = map ? map->owner[i] : -1;
        group[i] = all ? 0 : owner < 0 ? i : map->body[owner].first;
    }
    for (int b = 0; b < sim->objective.batches && !all; b++)
        batch_join_impacts(sim->objective.batch[b], group);
}

/* Whether `kept` takes a part of an impulse between particles away. */
static bool loses_momentum(const struct objective *objective, const struct impulses *impulses) {
    for (int i = 0; i < objective->particles; i++)
        if (impulses->kept[i] < 1.0 && objective->mass[i] > 0.0 &&
            vec3_length(impulses->between + 3 * (size_t)i) > 0.0)
            return true;
    return false;
}

struct group_sums { /* at the first particle of each group */
    double *lost;   /* particles x 3, kg m/s: the rest of the impulses between particles */
    double *shares; /* particles: mass times share */
};

/* Adds the part of body b in the lost momenta to its velocities. The pins of a pinned body take it.
 */
static void give_to_body(struct pdyn_sim *sim, int b, double h, const double *share,
                         const struct group_sums *sums) {
    const struct objective *objective = &sim->objective;
    const struct objective_body *body = &objective->body[b];
    double part = objective->h / h, *passed_on = sim->impacts.passed_on + 3 * (size_t)b;
    bool pinned = sim_pins_body(sim, b);
    for (int i = body->first; i < body->first + body->count; i++) {
        int first = groups_first(sim->impacts.group, i);
        const double *lost = sums->lost + 3 * (size_t)first;
        double given = sums->shares[first] > 0.0 ? share[i] / sums->shares[first] : 0.0;
        if (pinned) {
            vec3_add(passed_on, objective->mass[i] * given / objective->h, lost);
            continue;
        }
        vec3_add(sim->v + 3 * (size_t)i, -(1.0 - part) * given, lost);
        vec3_add(sim->v_before + 3 * (size_t)i, part * given, lost);
    }
}

/* Gives the momentum that the rest of the impulses between particles takes away back to the
 * particles of the same group, in proportion to their impulses: a light particle changes its
 * velocity no more than a heavy one with the same impulse, and a particle without an impulse not at
 * all. Overwrites impulses->all; share: particles x 3. */
static void give_back(struct pdyn_sim *sim, double h, const struct impulses *impulses,
                      double *share) {
    const struct objective *objective = &sim->objective;
    const struct group_sums sums = {impulses->all, share + objective->particles};
    if (!loses_momentum(objective, impulses)) return;
    find_shares(sim, impulses->between, share);
    find_groups(sim);
    memset(sums.lost, 0, objective_bytes(objective));
    memset(sums.shares, 0, (size_t)objective->particles * sizeof *sums.shares);
    for (int i = 0; i < objective->particles; i++) {
        int first = groups_first(sim->impacts.group, i);
        double left = objective->mass[i] * (1.0 - impulses->kept[i]);
        vec3_add(sums.lost + 3 * (size_t)first, left, impulses->between + 3 * (size_t)i);
        sums.shares[first] += objective->mass[i] * share[i];
    }
    for (int b = 0; b < sim->bodies; b++) give_to_body(sim, b, h, share, &sums);
}

/* Whether a particle can be held by forces that are no impacts, of pins or membranes. */
static bool has_other_forces(const struct pdyn_sim *sim) {
    bool others = false;
    for (int b = 0; b < sim->objective.batches; b++)
        others |= !batch_has_impacts(sim->objective.batch[b]);
    return others;
}

/* Acceleration of points by all constraints over that by one-sided ones, particles x 3, at most 1;
 * each is the norm over the points. */
static double yield_of(const struct pdyn_sim *sim, int first, int points, const double *one_sided) {
    double all = 0.0, part = 0.0, h = sim->objective.h;
    for (int k = 3 * first; k < 3 * (first + points); k++) {
        double moved = sim->x_next[k] - sim->objective.s[k];
        all += moved * moved, part += one_sided[k] * one_sided[k];
    }
    all = sqrt(all) / (h * h), part = sqrt(part);
    return all < part ? all / part : 1.0;
}

/* The yields of particles: a pinned vertex does not yield to water, however light it is. A rigid
 * body has one: with one for each vertex, an impact would depend on the triangles of a flat face.
 * one_sided, particles x 3, becomes the acceleration by one-sided constraints. */
static void find_yield(struct pdyn_sim *sim, const struct velocity_change *change,
                       double *one_sided, double *yield) {
    struct objective *objective = &sim->objective;
    const struct rigid_map *map = objective->rigid;
    memset(one_sided, 0, objective_bytes(objective));
    for (int b = 0; b < objective->batches; b++) {
        if (!batch_has_impacts(objective->batch[b])) continue;
        batch_find_acceleration(objective->batch[b], change);
        objective_axpy(objective, 1.0, change->acceleration, one_sided);
    }
    for (int b = 0; b < objective->bodies; b++) {
        int first = objective->body[b].first, end = first + objective->body[b].count;
        bool rigid = map && map->owner[first] >= 0;
        double whole = rigid ? yield_of(sim, end - RIGID_POINTS, RIGID_POINTS, one_sided) : 1.0;
        for (int i = first; i < end; i++) yield[i] = rigid ? whole : yield_of(sim, i, 1, one_sided);
    }
}

/* Forces of impacts between particles alone, N; false: there are none. Where something is anchored,
 * those of the operators of fluids, which walls take part in, are left out. */
static bool find_between(struct pdyn_sim *sim, const double *force, double *between) {
    bool any = !sim->anchored;
    if (any) memcpy(between, force, objective_bytes(&sim->objective));
    else memset(between, 0, objective_bytes(&sim->objective));
    for (int b = 0; sim->anchored && b < sim->objective.batches; b++)
        any |= batch_impacts_between(sim->objective.batch[b], between);
    return any;
}

/* Replaces forces, N, with the sign of the gradient, by what they add to velocities in h_e, m/s. */
static void to_velocities(struct pdyn_sim *sim, double *force) {
    const struct objective *objective = &sim->objective;
    objective_pull(objective, force);
    for (int k = 0; k < 3 * objective->particles; k++)
        force[k] = -objective->h * force[k] / objective->inertia[k / 3];
}

/* Computes the forces of impacts on particles, N, with the sign of the gradient; returns the number
 * of constraints with an impact. Overwrites sim->trial, direction and rhs. */
static int find_impacts(struct pdyn_sim *sim, double h, double *force) {
    struct objective *objective = &sim->objective;
    double *slowed = sim->trial;
    struct velocity_change change = {.slowed = slowed,
                                     .after = sim->v,
                                     .start = sim->x,
                                     .lists = objective_lists(objective),
                                     .taken = 1.0 - objective->h / h,
                                     .particles = objective->particles,
                                     .mass = objective->inertia,
                                     .rigid = objective->rigid,
                                     .h = objective->h,
                                     .solved = sim->solved,
                                     .acceleration = sim->direction};
    int count = 0;
    memcpy(slowed, sim->v_before, objective_bytes(objective));
    objective_axpy(objective, -1.0, sim->v, slowed);
    if (has_other_forces(sim)) {
        find_yield(sim, &change, force, sim->rhs);
        change.yield = sim->rhs;
    }
    memset(force, 0, objective_bytes(objective));
    for (int b = 0; b < objective->batches; b++)
        count += batch_impacts(objective->batch[b], &change, force);
    return count;
}

void impacts_correct(struct pdyn_sim *sim, double h) {
    double part = sim->objective.h / h;
    struct impulses impulses = {
        .all = sim->trial_gradient, .between = sim->trial, .kept = sim->rhs};
    if (!sim->v_before) return;
    sim->impacts.left_out = 1.0 - part * part;
    sim->impacts.count = find_impacts(sim, h, impulses.all);
    bool any = find_between(sim, impulses.all, impulses.between);
    to_velocities(sim, impulses.all);
    if (any) to_velocities(sim, impulses.between);
    for (int b = 0; b < sim->bodies; b++) shift_velocities(sim, b, h, &impulses);
    if (any) give_back(sim, h, &impulses, sim->direction);
    for (int b = 0; b < sim->objective.batches; b++)
        batch_keep_impacts(sim->objective.batch[b], impulses.kept);
    rigid_bodies_project(sim, sim->x_next, sim->v);
    rigid_bodies_project(sim, sim->x, sim->v_before);
}
