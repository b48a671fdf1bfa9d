#include "solid_approach.h"

#include "scene/poses.h"

#include "projdyn/box.h"
#include "projdyn/vec3.h"

#include <math.h>

/* A sphere that hits a hanging cloth with 10 m/s: all steps are solved up to three times the
 * thickness, and a run takes least time at one to two. */
static const double longest_approach = 2.0;

/* How far a vertex at x with the velocity v and the solid approach each other in h, m; 0 if they
 * stay farther apart than the thickness. box: of the solid in its initial placement. */
static double approach(const struct scene_motion *motion, const struct box *box, double thickness,
                       double time, double h, const double *x, const double *v) {
    double rest[3], from_pivot[3], moved[3], outside = 0.0;
    pose_to_rest(motion, time, x, rest);
    vec3_subtract(from_pivot, rest, motion->pivot);
    pose_place(motion, from_pivot, 1, time + h, moved);
    for (int a = 0; a < 3; a++) moved[a] -= x[a] + h * v[a];
    for (int a = 0; a < 3; a++)
        outside = fmax(outside, fmax(box->min[a] - rest[a], rest[a] - box->max[a]));
    double length = vec3_length(moved);
    return outside < thickness + length ? length : 0.0;
}

static double largest_approach(const struct pdyn_sim *sim, const struct scene_solid *solid,
                               double h) {
    struct box box = box_empty;
    double largest = 0.0, thickness = sim->scene.contact.thickness;
    for (int i = 0; i < solid->mesh.vertices; i++)
        box_add(&box, solid->mesh.vertex + 3 * (size_t)i);
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        for (int i = body->first; body->triangles && i < body->first + body->count; i++)
            largest = fmax(largest, approach(&solid->motion, &box, thickness, sim->time, h,
                                             sim->x + 3 * (size_t)i, sim->v + 3 * (size_t)i));
    }
    return largest;
}

double solid_approach_limit(const struct pdyn_sim *sim, double h) {
    double largest = 0.0, most = longest_approach * sim->scene.contact.thickness;
    for (int s = 0; sim->scene.has_contact && s < sim->scene.solids; s++)
        if (sim->scene.solid[s].motion.keys)
            largest = fmax(largest, largest_approach(sim, &sim->scene.solid[s], h));
    return largest > most ? h * most / largest : h;
}
