/* What every move of an iterate obeys: largest displacements, and rigid bodies that stay rigid. */
#include "iterate.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* All particles of a rigid body move by the same part of their displacements. */
static double limit_bodies(const struct pdyn_sim *sim, double *moves) {
    const struct rigid_map *map = sim->objective.rigid;
    double all = 1.0;
    for (int k = 0; map && k < map->bodies; k++) {
        const struct rigid_body *body = &map->body[k];
        int end = rigid_body_end(body);
        double least = 1.0;
        for (int i = body->first; i < end; i++) {
            double length = vec3_length(moves + 3 * (size_t)i);
            if (length > sim->max_step[i]) least = fmin(least, sim->max_step[i] / length);
        }
        for (int j = 3 * body->first; least < 1.0 && j < 3 * end; j++) moves[j] *= least;
        all = fmin(all, least);
    }
    return all;
}

double iterate_limit(const struct pdyn_sim *sim, double *moves) {
    if (!sim->max_step) return 1.0;
    double least = limit_bodies(sim, moves);
    for (int i = 0; i < sim->objective.particles; i++) {
        double *own = moves + 3 * (size_t)i, length = vec3_length(own);
        if (!(length > sim->max_step[i])) continue;
        double part = sim->max_step[i] / length;
        for (int a = 0; a < 3; a++) own[a] *= part;
        least = fmin(least, part);
    }
    return least;
}

bool iterate_retract(const struct pdyn_sim *sim, double *x) {
    return sim->objective.rigid && rigid_map_retract(sim->objective.rigid, x);
}

bool iterate_retract_moves(struct pdyn_sim *sim, double *moves) {
    if (!sim->objective.rigid) return false;
    objective_axpy(&sim->objective, 1.0, sim->x_next, moves);
    bool bent = iterate_retract(sim, moves);
    objective_axpy(&sim->objective, -1.0, sim->x_next, moves);
    return bent;
}

pdyn_status iterate_update_limits(struct pdyn_sim *sim, const double *x) {
    return sim->max_step ? objective_limit(&sim->objective, x, sim->max_step) : PDYN_OK;
}

void iterate_accept_trial(struct pdyn_sim *sim) {
    memcpy(sim->x_next, sim->trial, objective_bytes(&sim->objective));
    memcpy(sim->gradient, sim->trial_gradient, objective_bytes(&sim->objective));
}
