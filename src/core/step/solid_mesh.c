/* The mesh of a solid where the solid is at the current time. */
#include "scene/poses.h"
#include "sim.h"

#include <string.h>

int pdyn_solid_vertices(const pdyn_sim *sim, int solid, double *x) {
    if (!pdyn_solid_name(sim, solid)) return 0;
    const struct scene_solid *s = &sim->scene.solid[solid];
    if (x && s->keys) pose_place_mesh(s, sim->time, x);
    else if (x) memcpy(x, s->mesh.vertex, 3 * (size_t)s->mesh.vertices * sizeof *x);
    return s->mesh.vertices;
}
