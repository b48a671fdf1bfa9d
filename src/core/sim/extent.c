#include "extent.h"

#include "live_particles.h"

#include "projdyn/vec3.h"

struct box extent_of_body(const struct pdyn_sim *sim, const pdyn_body *body) {
    return box_around(sim->x + 3 * (size_t)body->first, body->count);
}

struct box extent_of_fluids(const struct pdyn_sim *sim) {
    struct box box = box_empty;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        for (int i = body->first; body_is_particles(body) && i < body->first + body->count; i++)
            if (particle_is_live(sim, i)) box_add(&box, sim->x + 3 * (size_t)i);
    }
    return box;
}

struct box extent_of_solids(const struct pdyn_sim *sim, int but) {
    struct box box = box_empty;
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct mesh *mesh = &sim->scene.solid[s].mesh;
        for (int i = 0; s != but && i < mesh->vertices; i++)
            box_add(&box, mesh->vertex + 3 * (size_t)i);
    }
    return box;
}

struct box extent_of_scene(const struct pdyn_sim *sim) {
    struct box box = extent_of_solids(sim, -1);
    for (int i = 0; i < sim->objective.particles; i++)
        if (particle_is_live(sim, i)) box_add(&box, sim->x + 3 * (size_t)i);
    return box;
}

double extent_height(const struct pdyn_sim *sim, const double *x) {
    const double *g = sim->scene.settings.gravity, length = vec3_length(g);
    return length > 0.0 ? -vec3_dot(x, g) / length : 0.0;
}

double extent_floor(const struct pdyn_sim *sim) {
    struct box box = extent_of_scene(sim);
    double height = INFINITY;
    for (int k = 0; k < 8; k++) {
        double corner[3];
        for (int a = 0; a < 3; a++) corner[a] = k >> a & 1 ? box.max[a] : box.min[a];
        /* without fmin, with which GCC 12 for arm64 ends with an internal error */
        double of_corner = extent_height(sim, corner);
        if (of_corner < height) height = of_corner;
    }
    return height - vec3_distance(box.min, box.max);
}
