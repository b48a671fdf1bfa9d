#include "probe_place.h"

#include "free_rotation.h"
#include "scene/poses.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <string.h>

static const struct rigid_body *find_rigid(const struct pdyn_sim *sim, int body) {
    const struct rigid_map *map = sim->objective.rigid;
    int k = 0;
    while (map->body[k].first != sim->body[body].first) k++;
    return &map->body[k];
}

/* The centre of rotation, m, and the rotation of the carrier now. */
static void find_pose(const struct pdyn_sim *sim, const struct scene_probe *probe, double at[3],
                      double R[9]) {
    if (probe->on_body >= 0) {
        const struct rigid_body *body = find_rigid(sim, probe->on_body);
        rigid_body_centre(body, sim->x, at);
        rigid_body_matrix(body, sim->x, R);
        return;
    }
    struct pose pose = pose_at(&sim->scene.solid[probe->on_solid].motion, sim->time);
    memcpy(at, pose.at.translate, sizeof pose.at.translate);
    vec3_rotation(R, pose.at.rotate);
}

void probe_place_start(const struct pdyn_sim *sim, const struct scene_probe *probe, double *x,
                       struct probe_place *place) {
    *place = (struct probe_place){.probe = probe, .x = x};
    place->moves = probe->on_body >= 0 ||
                   (probe->on_solid >= 0 && sim->scene.solid[probe->on_solid].motion.keys);
    if (probe->at.count) memcpy(x, probe->at.x, 3 * (size_t)probe->at.count * sizeof *x);
    if (place->moves) find_pose(sim, probe, place->rest, place->start);
}

void probe_place_move(const struct pdyn_sim *sim, struct probe_place *place) {
    const struct point_list *points = &place->probe->at;
    double R[9];
    if (!place->moves) return;
    find_pose(sim, place->probe, place->at, R);
    rotation_multiply_transposed(R, place->start, place->R);
    for (int k = 0; k < points->count; k++) {
        double arm[3], *x = place->x + 3 * (size_t)k;
        vec3_subtract(arm, points->x + 3 * (size_t)k, place->rest);
        vec3_multiply(x, place->R, arm);
        vec3_add(x, 1.0, place->at);
    }
}

void probe_place_return(const struct probe_place *place, const double x[3], double x_0[3]) {
    double arm[3];
    memcpy(x_0, place->moves ? place->rest : x, 3 * sizeof *x_0);
    if (!place->moves) return;
    vec3_subtract(arm, x, place->at);
    for (int a = 0; a < 3; a++) vec3_add(x_0, arm[a], place->R + 3 * a);
}
