#include "solid_approach.h"

#include "scene/poses.h"

#include "projdyn/vec3.h"

#include <math.h>

/* Limit of the approach in a step, in thicknesses. Measured with a sphere that hits a hanging cloth
 * at 10 m/s: all steps are solved with limits up to 3; the run is fastest with 1 to 2. */
static const double longest_approach = 2.0;

/* A moving solid in a step. Both maps are affine; each is given by the images of the origin and of
 * the ends of the three unit vectors, m. */
struct moving {
    double rest[4][3];  /* where a point of the solid is at rest */
    double moved[4][3]; /* where it is at the end of the step */
    struct box box;     /* of the mesh at rest */
    double thickness;
};

static struct moving moving_solid(const struct pdyn_sim *sim, const struct scene_solid *solid,
                                  double h) {
    const struct scene_motion *motion = &solid->motion;
    struct moving m = {.box = box_around(solid->mesh.vertex, solid->mesh.vertices),
                       .thickness = sim->scene.contact.thickness};
    for (int k = 0; k < 4; k++) {
        const double point[3] = {k == 1, k == 2, k == 3};
        pose_to_rest(motion, sim->time, point, m.rest[k]);
        pose_place(motion, m.rest[k], 1, sim->time + h, m.moved[k]);
    }
    return m;
}

static void map_point(const double image[4][3], const double *x, double *out) {
    for (int a = 0; a < 3; a++)
        out[a] = image[0][a] + x[0] * (image[1][a] - image[0][a]) +
                 x[1] * (image[2][a] - image[0][a]) + x[2] * (image[3][a] - image[0][a]);
}

/* How far a vertex at x with the velocity v and the solid approach each other in h, m; 0 if they
 * stay farther apart than the thickness. */
static double approach(const struct moving *m, double h, const double *x, const double *v) {
    double rest[3], moved[3], outside = 0.0;
    map_point(m->rest, x, rest);
    map_point(m->moved, x, moved);
    for (int a = 0; a < 3; a++) {
        moved[a] -= x[a] + h * v[a];
        outside = fmax(outside, fmax(m->box.min[a] - rest[a], rest[a] - m->box.max[a]));
    }
    double length = vec3_length(moved);
    return outside < m->thickness + length ? length : 0.0;
}

static double largest_approach(const struct pdyn_sim *sim, const struct scene_solid *solid,
                               double h) {
    const struct moving m = moving_solid(sim, solid, h);
    double largest = 0.0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            largest =
                fmax(largest, approach(&m, h, sim->x + 3 * (size_t)i, sim->v + 3 * (size_t)i));
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
