#include "walls.h"

#include "scene/poses.h"
#include "sim.h"

#include <string.h>

void walls_move(struct pdyn_sim *sim, double time) {
    double *x = sim->walls.x;
    for (int s = 0; x && s < sim->scene.solids; s++) {
        const struct scene_solid *solid = &sim->scene.solid[s];
        const struct mesh *mesh = &solid->mesh;
        if (solid->motion.keys) pose_place(&solid->motion, mesh->vertex, mesh->vertices, time, x);
        x += 3 * (size_t)mesh->vertices;
    }
}

/* As bodies, whose vertices follow the particles of the system. */
static void list_solids(struct pdyn_sim *sim, pdyn_body *body) {
    struct walls *w = &sim->walls;
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct mesh *mesh = &sim->scene.solid[s].mesh;
        body[s] = (pdyn_body){.first = sim->objective.particles + w->vertices,
                              .triangle = mesh->triangle,
                              .triangles = mesh->triangles};
        w->vertices += mesh->vertices, w->border.triangles += mesh->triangles;
    }
}

static pdyn_status place_at_rest(struct pdyn_sim *sim) {
    double *x = sim->walls.x = NEW_VECTOR(sim->context, sim->walls.vertices);
    if (!x) return PDYN_NO_MEMORY;
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct mesh *mesh = &sim->scene.solid[s].mesh;
        size_t numbers = 3 * (size_t)mesh->vertices;
        memcpy(x, mesh->vertex, numbers * sizeof *x);
        x += numbers;
    }
    walls_move(sim, 0.0);
    return PDYN_OK;
}

pdyn_status walls_create(struct pdyn_sim *sim, double reach) {
    int solids = sim->scene.solids;
    if (!sim->objective.samples || !solids) return PDYN_OK;
    pdyn_body *body = NEW_ARRAY(sim->context, solids, pdyn_body);
    if (!body) return PDYN_NO_MEMORY;
    list_solids(sim, body);
    pdyn_status status = occlusion_create(sim->context, solids, body, &sim->walls.border,
                                          sim->objective.samples->count, reach, &sim->walls.hides);
    FREE_ARRAY(sim->context, body, solids);
    return status == PDYN_OK ? place_at_rest(sim) : status;
}

void walls_free(struct pdyn_sim *sim) {
    occlusion_free(sim->walls.hides);
    FREE_VECTOR(sim->context, sim->walls.x, sim->walls.vertices);
    sim->walls = (struct walls){0};
}
