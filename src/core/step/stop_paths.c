#include "stop_paths.h"

#include "carried.h"
#include "contact/contact.h"
#include "iterate.h"

#include "projdyn/vec3.h"

#include <string.h>

/* Times that paths of rigid bodies are checked before a body whose path stops again does not move:
 * each stop within a turn ends beside the path that was checked, mostly nearer than the last. */
enum { TURN_ROUNDS = 8 };

void set_path_starts(const struct pdyn_sim *sim, double *x) {
    const struct objective *objective = &sim->objective;
    memcpy(x, carried_x(sim), objective_bytes(objective));
    for (int b = 0; b < objective->bodies && objective->contact; b++) {
        const struct objective_body *body = &objective->body[b];
        const double *common = contact_common(objective->contact, b);
        for (int i = body->first; i < body->first + body->count; i++)
            vec3_add(x + 3 * i, 1.0, common);
    }
}

static pdyn_status shorten(struct pdyn_sim *sim, enum paths paths, double *to) {
    struct contact *contact = sim->objective.contact;
    return paths == PATHS_TO_START ? contact_filter_start(contact, sim->x, to)
                                   : contact_filter(contact, sim->x_next, to);
}

/* Makes bodies rigid at the ends of their paths. Returns whether one was not. */
static bool retract(struct pdyn_sim *sim, enum paths paths, double *to) {
    return paths == PATHS_TO_START ? iterate_retract(sim, to) : iterate_retract_moves(sim, to);
}

/* Bodies that were not rigid at the last retraction stay where their paths begin. */
static void keep_bent(struct pdyn_sim *sim, enum paths paths, double *to) {
    const struct rigid_map *map = sim->objective.rigid;
    const double *starts = paths == PATHS_TO_START ? sim->rhs : NULL;
    if (starts) set_path_starts(sim, sim->rhs);
    for (int k = 0; k < map->bodies; k++) {
        const struct rigid_body *body = &map->body[k];
        int end = 3 * rigid_body_end(body);
        for (int j = 3 * body->first; body->bent && j < end; j++) to[j] = starts ? starts[j] : 0.0;
    }
}

pdyn_status stop_paths(struct pdyn_sim *sim, enum paths paths, double *to, double *part) {
    struct contact *contact = sim->objective.contact;
    const struct rigid_map *map = sim->objective.rigid;
    int most = TURN_ROUNDS + (map ? map->bodies : 0); /* until all bodies have stopped */
    pdyn_status status = PDYN_OK;
    bool bent = contact;
    for (int k = 0; status == PDYN_OK && bent && k < most; k++) {
        status = shorten(sim, paths, to);
        *part *= contact_least(contact);
        bent = retract(sim, paths, to) && (k == 0 || contact_least(contact) < 1.0);
        if (!bent || k + 1 < TURN_ROUNDS) continue;
        keep_bent(sim, paths, to);
        *part = 0.0;
    }
    return status;
}
