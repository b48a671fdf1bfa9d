/* Neighbour lists of a simulation, in a scene with a constraint that works on them: the points of
 * SPH sums are particles, samples on surfaces and boundary points on solids. */
#include "build.h"
#include "sim/live_particles.h"
#include "sim/sim.h"
#include "sim/solid_points.h"
#include "sph/boundary.h"
#include "warn.h"

#include "projdyn/kernel.h"

/* Skin of the lists, in particle spacings: lists have 1.7 times the pairs of the cubic spline and
 * are rebuilt less often. */
static const double skin_size = 0.4;

/* The number of particles and samples. */
static int extended_count(const struct pdyn_sim *sim) {
    return sim->objective.particles + (sim->objective.samples ? sim->objective.samples->count : 0);
}

/* Of fluid particles, samples and boundary points; a surface acts by its samples alone. */
static pdyn_status fill_volumes(struct pdyn_sim *sim, double *volume, bool *centre, bool *is_wall) {
    double spacing = sim_spacing(sim);
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!has_neighbour_lists(sim, b)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            volume[i] = spacing * spacing * spacing, centre[i] = true;
    }
    for (int k = 0; sim->objective.samples && k < sim->objective.samples->count; k++)
        volume[sim->objective.particles + k] = sim->objective.samples->rest_volume[k];
    return solid_points_compute_volumes(sim, volume + extended_count(sim), is_wall);
}

static double support_of(const struct pdyn_sim *sim) {
    return sim->scene.settings.kernel->support * sim_spacing(sim);
}

static pdyn_status create_occlusion(struct pdyn_sim *sim) {
    double reach = support_of(sim) + skin_size * sim_spacing(sim);
    pdyn_status status =
        occlusion_create(sim->context, sim->bodies, sim->body, &sim->border,
                         extended_count(sim) + sim->boundary.at.count, reach, &sim->occlusion);
    return status == PDYN_OK ? walls_create(sim, reach) : status;
}

/* Where surfaces may hide boundary points. */
static pdyn_status create_faces(struct pdyn_sim *sim) {
    if (!sim->occlusion) return PDYN_OK;
    sim->face_x = NEW_VECTOR(sim->context, sim->boundary.at.count);
    if (!sim->face_x) return PDYN_NO_MEMORY;
    solid_points_find_faces(sim, 0, kinematic_first_point(sim), sim->boundary.at.x);
    return PDYN_OK;
}

static pdyn_status create_neighbours(struct pdyn_sim *sim) {
    const struct scene_settings *settings = &sim->scene.settings;
    double spacing = sim_spacing(sim);
    int particles = extended_count(sim), boundary = sim->boundary.at.count;
    double *volume = NEW_ARRAY(sim->context, particles + boundary, double);
    bool *centre = NEW_ARRAY(sim->context, particles, bool);
    bool *is_wall = NEW_ARRAY(sim->context, boundary + 1, bool);
    pdyn_status status =
        volume && centre && is_wall ? fill_volumes(sim, volume, centre, is_wall) : PDYN_NO_MEMORY;
    kinematic_move(sim, 0.0);
    const struct neighbours_def def = {
        .particles = particles,
        .centre = centre,
        .boundary = boundary,
        .boundary_x = sim->boundary.at.x,
        .moving = sim->kinematic.points,
        .layer_x = sim->kinematic.layer.x,
        .volume = volume,
        .is_wall = is_wall,
        .support = support_of(sim),
        .surface_support = boundary_support(settings->boundary, settings->kernel) * spacing,
        .skin = skin_size * spacing,
        .has_volumes = settings->boundary->volumes,
        .kernel = settings->kernel,
        .occlusion = sim->occlusion,
        .face_x = sim->face_x,
        .walls = sim->walls.hides,
        .wall_x = sim->walls.x,
        .wall_vertices = sim->walls.vertices,
        .samples = sim->objective.samples};
    if (status == PDYN_OK)
        status = neighbours_create(sim->context, &def, &sim->objective.neighbours);
    FREE_ARRAY(sim->context, volume, particles + boundary);
    FREE_ARRAY(sim->context, centre, particles);
    FREE_ARRAY(sim->context, is_wall, boundary + 1);
    return status;
}

/* Walls close the borders of surfaces: a fluid does not flow around a border that meets a solid, or
 * a body that hides particles from each other. */
static pdyn_status create_border(struct pdyn_sim *sim, double width) {
    int capacity = sim->scene.solids + sim->bodies, walls = 0;
    struct border_wall *wall = NEW_ARRAY(sim->context, capacity, struct border_wall);
    if (!wall) return PDYN_NO_MEMORY;
    for (int s = 0; s < sim->scene.solids; s++)
        wall[walls++] = (struct border_wall){&sim->scene.solid[s].mesh, -1};
    for (int b = 0; b < sim->bodies; b++)
        if (hiding_triangles(&sim->body[b]))
            wall[walls++] = (struct border_wall){&sim->scene.body[b].mesh, b};
    const struct border_def def = {sim->bodies, sim->body, sim->rest, walls, wall, width};
    pdyn_status status = border_create(sim->context, &def, &sim->border);
    FREE_ARRAY(sim->context, wall, capacity);
    return status;
}

/* Makes the limit on displacements where surfaces need it. Walls of a box and the boundary model
 * "points" need none. */
static pdyn_status make_limits(struct pdyn_sim *sim) {
    bool surfaces = sim->objective.samples;
    for (int k = 0; k < sim->boundary.at.count; k++) surfaces |= !sim->boundary.point[k].of_box;
    if (!surfaces || sim->scene.settings.boundary->volumes) return PDYN_OK;
    sim->max_step = NEW_ARRAY(sim->context, extended_count(sim), double);
    return sim->max_step ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status lists_create(struct pdyn_sim *sim) {
    double spacing = sim_spacing(sim);
    if (spacing == 0.0) return PDYN_OK;
    const struct boundary_model *model = sim->scene.settings.boundary;
    const struct samples_def samples = {
        .bodies = sim->bodies,
        .body = sim->body,
        .particles = sim->objective.particles,
        .rest = sim->rest,
        .model = model,
        .kernel = sim->scene.settings.kernel,
        .spacing = spacing,
        .thickness = sim->scene.has_contact ? sim->scene.contact.thickness : 0.0,
        .border = &sim->border};
    pdyn_status status = solid_points_sample(sim);
    if (status == PDYN_OK) status = create_border(sim, model->strip * spacing);
    if (status == PDYN_OK) status = samples_create(sim->context, &samples, &sim->objective.samples);
    if (status == PDYN_OK) status = create_occlusion(sim);
    if (status == PDYN_OK) status = create_faces(sim);
    if (status == PDYN_OK) status = create_neighbours(sim);
    if (status == PDYN_OK) status = make_limits(sim);
    if (status != PDYN_OK) return status;
    live_particles_update_lists(sim);
    status = objective_build_lists(&sim->objective, sim->x);
    for (int b = 0; status == PDYN_OK && b < sim->bodies; b++) {
        if (!has_neighbour_lists(sim, b)) continue;
        warn_of_fills(sim, b);
        status = warn_of_room(sim, b);
    }
    return status;
}

void lists_free(struct pdyn_sim *sim) {
    FREE_ARRAY(sim->context, sim->max_step, extended_count(sim));
    neighbours_free(sim->objective.neighbours);
    samples_free(sim->objective.samples);
    FREE_VECTOR(sim->context, sim->face_x, sim->boundary.at.count);
    walls_free(sim);
    occlusion_free(sim->occlusion);
    border_free(&sim->border);
    boundary_points_free(sim->context, &sim->boundary);
    kinematic_free(sim->context, &sim->kinematic);
}
