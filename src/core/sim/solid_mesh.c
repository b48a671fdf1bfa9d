/* The mesh of a solid, where the solid is at the current time. */
#include "contact/contact.h"
#include "scene/poses.h"
#include "sim.h"

#include <string.h>

int pdyn_solid_vertices(const pdyn_sim *sim, int solid, double *x) {
    if (!pdyn_solid_name(sim, solid)) return 0;
    const struct scene_solid *s = &sim->scene.solid[solid];
    const struct contact *contact = sim->objective.contact;
    const double *at = contact ? contact_solid_at(contact, solid) : s->mesh.vertex;
    if (x && s->motion.keys && !contact)
        pose_place(&s->motion, s->mesh.vertex, s->mesh.vertices, sim->time, x);
    else if (x) memcpy(x, at, 3 * (size_t)s->mesh.vertices * sizeof *x);
    return s->mesh.vertices;
}

int pdyn_solid_triangles(const pdyn_sim *sim, int solid, int *triangle) {
    if (!pdyn_solid_name(sim, solid)) return 0;
    const struct mesh *mesh = &sim->scene.solid[solid].mesh;
    if (triangle) memcpy(triangle, mesh->triangle, 3 * (size_t)mesh->triangles * sizeof *triangle);
    return mesh->triangles;
}
