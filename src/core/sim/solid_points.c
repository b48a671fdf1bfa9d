/* Sampling of solids with boundary points, and the volumes of these. */
#include "solid_points.h"

#include "kinematic_solids.h"
#include "sim.h"
#include "sph/boundary.h"
#include "sph/point_volumes.h"

#include "projdyn/kernel.h"
#include "projdyn/vec3.h"

#include <string.h>

static pdyn_status sample_shape(struct pdyn_sim *sim, const struct scene_solid *solid) {
    const struct boundary_model *model = sim->scene.settings.boundary;
    const struct kernel_model *kernel = sim->scene.settings.kernel;
    double spacing = sim_spacing(sim);
    double beyond = model->volumes ? model->outside : kernel->beyond;
    const struct face_grid grid = {solid->open, model->grid * spacing, sim_behind_faces(sim),
                                   beyond * spacing};
    if (solid->is_vessel)
        return sample_box_surface(sim->context, solid->name, &solid->box, &grid, &sim->boundary);
    return (solid->kind == SOLID_PLANE ? sample_plane_surface : sample_mesh_surface)(
        sim->context, solid->name, &solid->mesh, model->mesh_spacing * spacing, &sim->boundary);
}

/* Samples solid k of the scene. */
static pdyn_status sample_solid(struct pdyn_sim *sim, int k) {
    struct boundary_points *points = &sim->boundary;
    int first = points->at.count;
    pdyn_status status = sample_shape(sim, &sim->scene.solid[k]);
    for (int i = first; status == PDYN_OK && i < points->at.count; i++) points->point[i].solid = k;
    return status;
}

pdyn_status solid_points_sample(struct pdyn_sim *sim) {
    const struct scene *scene = &sim->scene;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < scene->solids && status == PDYN_OK; k++)
        if (!scene->solid[k].motion.keys) status = sample_solid(sim, k);
    for (int k = 0; k < scene->solids && status == PDYN_OK; k++) {
        int first = sim->boundary.at.count;
        if (!scene->solid[k].motion.keys) continue;
        status = sample_solid(sim, k);
        if (status == PDYN_OK) status = kinematic_add(sim, &scene->solid[k], first);
    }
    return status;
}

void solid_points_find_faces(struct pdyn_sim *sim, int first, int count, const double *at) {
    double behind = sim_behind_faces(sim);
    double *face = sim->face_x + 3 * (size_t)first;
    for (int k = 0; k < count; k++, at += 3, face += 3) {
        const struct boundary_point *point = &sim->boundary.point[first + k];
        memcpy(face, at, 3 * sizeof *face);
        if (point->of_box) vec3_add(face, behind, point->normal);
    }
}

static pdyn_status published_volumes(struct pdyn_sim *sim, int first, int count, double *volume) {
    const struct kernel_model *kernel = sim->scene.settings.kernel;
    if (!count) return PDYN_OK;
    return point_volumes(sim->context, count, sim->boundary.at.x + 3 * (size_t)first, kernel,
                         kernel->support * sim_spacing(sim), volume + first);
}

/* Computes the volumes 1 / sum W: of all solids at rest together, and of each moving solid alone,
 * so that they do not change with the motion. */
static pdyn_status compute_published_volumes(struct pdyn_sim *sim, double *volume) {
    const struct kinematic_solids *moving = &sim->kinematic;
    int resting = kinematic_first_point(sim);
    pdyn_status status = published_volumes(sim, 0, resting, volume);
    for (int k = 0; k < moving->solids && status == PDYN_OK; k++)
        status = published_volumes(sim, moving->solid[k].first, moving->solid[k].count, volume);
    return status;
}

pdyn_status solid_points_compute_volumes(struct pdyn_sim *sim, double *volume, bool *is_wall) {
    const struct boundary_model *model = sim->scene.settings.boundary;
    const struct boundary_points *points = &sim->boundary;
    double spacing = sim_spacing(sim), layer = sim->scene.settings.kernel->layer;
    for (int k = 0; k < points->at.count; k++) {
        const struct boundary_point *point = &points->point[k];
        is_wall[k] = model->volumes || point->of_box;
        volume[k] = (point->of_box ? layer : 1.0) * point->area * spacing;
    }
    return model->volumes ? compute_published_volumes(sim, volume) : PDYN_OK;
}
