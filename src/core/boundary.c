#include "boundary.h"

#include "kernel.h"
#include "sim.h"

/* Walls of a box have water on one side. Points that lie behind them push ever harder as a particle
 * comes closer, and go on where it is behind the face. As far away as this, and with this volume, a
 * plane adds 0.150 half a spacing in front of the face, and -1.15 per spacing: the lowest layer of
 * water at rest then has the pressure of its depth. A lattice of particles that touches the faces
 * is at rest (1.00 at walls, edges and in corners): for that, grids go on beyond the edges. A
 * plane's sum varies by 3 % over the grid, that of the surface kernel by 3 % over a mesh
 * (test_interface.c). As published, so far outside, such a lattice has 0.999, 1.000 and 1.004. */
const struct boundary_model boundary_models[] = {
    {.name = "surface",
     .summary = "a surface acts from where it is",
     .grid = 1.0,
     .outside = 1.01,
     .beyond = 0.35,
     .layer = 12.95,
     .spots = 0.5,
     .support = 0.99498743710662}, /* q = d */
    {.name = "points",
     .summary = "boundary particles (Akinci et al. 2012), which hold fluid off by 0.7 spacings",
     .grid = 1.0,
     .outside = 0.6,
     .beyond = 0.6,
     .spots = 0.9,
     .support = 2.0,
     .volumes = true},
};
const int boundary_model_count = sizeof boundary_models / sizeof *boundary_models;

pdyn_status boundary_volumes(pdyn_context *context, const struct boundary_model *model, int count,
                             const double *x, const double *area, double thickness, double spacing,
                             double *volume) {
    double factor = surface_kernel_farther(fmin(0.5 * thickness / spacing, 0.3));
    if (model->volumes)
        return neighbours_surface_volumes(context, count, x, model->support * spacing, volume);
    for (int k = 0; k < count; k++) volume[k] = factor * area[k] * spacing;
    return PDYN_OK;
}

static pdyn_status sample_shape(struct pdyn_sim *sim, const struct scene_solid *solid,
                                double spacing) {
    const struct boundary_model *model = sim->scene.settings.boundary;
    const struct face_grid grid = {solid->open, model->grid * spacing, model->outside * spacing,
                                   model->beyond * spacing};
    if (!solid->is_box)
        return sample_mesh_surface(sim->context, &solid->mesh, model->spots * spacing,
                                   &sim->boundary);
    return sample_box_surface(sim->context, &solid->box, &grid, &sim->boundary);
}

/* Solid number k of the scene. */
static pdyn_status sample_solid(struct pdyn_sim *sim, int k, double spacing) {
    struct patches *all = &sim->boundary;
    int first = all->at.count;
    pdyn_status status = sample_shape(sim, &sim->scene.solid[k], spacing);
    for (int i = first; status == PDYN_OK && i < all->at.count; i++) all->patch[i].solid = k;
    return status;
}

pdyn_status boundary_sample(struct pdyn_sim *sim, double spacing) {
    const struct scene *scene = &sim->scene;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < scene->solids && status == PDYN_OK; k++)
        if (!scene->solid[k].keys) status = sample_solid(sim, k, spacing);
    for (int k = 0; k < scene->solids && status == PDYN_OK; k++) {
        int first = sim->boundary.at.count;
        if (!scene->solid[k].keys) continue;
        status = sample_solid(sim, k, spacing);
        if (status == PDYN_OK) status = motion_add(sim, &scene->solid[k], first);
    }
    return status;
}

static pdyn_status published_volumes(struct pdyn_sim *sim, int first, int count, double spacing,
                                     double *volume) {
    double support = sim->scene.settings.boundary->support * spacing;
    return neighbours_surface_volumes(sim->context, count, sim->boundary.at.x + 3 * (size_t)first,
                                      support, volume + first);
}

/* Volumes 1 / sum W: of all that rests together, and of each solid that moves by itself, for these
 * stay the same. */
static pdyn_status fill_published(struct pdyn_sim *sim, double spacing, double *volume) {
    const struct motion *motion = &sim->motion;
    int resting = sim->boundary.at.count - motion->points;
    pdyn_status status = published_volumes(sim, 0, resting, spacing, volume);
    for (int k = 0; k < motion->solids && status == PDYN_OK; k++)
        status =
            published_volumes(sim, motion->solid[k].first, motion->solid[k].count, spacing, volume);
    return status;
}

pdyn_status boundary_fill(struct pdyn_sim *sim, double spacing, double *volume, bool *is_wall) {
    const struct boundary_model *model = sim->scene.settings.boundary;
    const struct patches *all = &sim->boundary;
    for (int k = 0; k < all->at.count; k++) {
        const struct patch *patch = &all->patch[k];
        is_wall[k] = model->volumes || patch->of_box;
        volume[k] = (patch->of_box ? model->layer : 1.0) * patch->area * spacing;
    }
    return model->volumes ? fill_published(sim, spacing, volume) : PDYN_OK;
}
