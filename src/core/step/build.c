/* Construction of a simulation from a scene: particles, topology, boundary points, neighbour lists,
 * batches, solver. */
#include "base/registry.h"
#include "crossings.h"
#include "geometry/sampling.h"
#include "live_particles.h"
#include "objective/residual.h"
#include "probes.h"
#include "rigid_bodies.h"
#include "scene/scene_file.h"
#include "sim.h"
#include "solid_points.h"
#include "sph/boundary.h"
#include "warn.h"

#include "projdyn/vec3.h"

#include <string.h>

enum {
    SKIN_PERCENT = 20
}; /* of the support: lists have 1.7 times the pairs and are rebuilt less often */

/* ---- services of modules  ------------------------------------------------------------------ */

static void service_for(pdyn_core *core, int count, int grain, pdyn_range_fn *fn, void *arg) {
    pool_for(((pdyn_context *)core)->pool, count, grain, fn, arg);
}
static void *service_allocate(pdyn_core *core, void *block, size_t old_size, size_t new_size) {
    void *moved = context_resize((pdyn_context *)core, block, old_size, new_size);
    if (!moved && new_size) context_no_memory((pdyn_context *)core);
    return moved;
}
static pdyn_status service_fail(pdyn_core *core, pdyn_status status, const char *message) {
    return context_fail((pdyn_context *)core, status, "%s", message);
}
pdyn_services sim_services(pdyn_context *context) {
    return (pdyn_services){(pdyn_core *)context, service_for, service_allocate, service_fail};
}

/* ---- bodies ---------------------------------------------------------------------------------- */

/* The rest positions of all bodies, one after the other. */
static pdyn_status place_bodies(struct pdyn_sim *sim, struct point_list *all) {
    pdyn_context *c = sim->context;
    sim->bodies = sim->scene.bodies;
    sim->body = NEW_ARRAY(c, sim->bodies, pdyn_body);
    sim->topology = NEW_ARRAY(c, sim->bodies, struct topology);
    if (!sim->body || !sim->topology) return PDYN_NO_MEMORY;
    for (int b = 0; b < sim->bodies; b++) {
        const struct scene_body *from = &sim->scene.body[b];
        pdyn_body *body = &sim->body[b];
        *body = (pdyn_body){.name = from->name,
                            .first = all->count,
                            .radius = from->radius,
                            .rest_density = from->rest_density,
                            .area_density = from->area_density};
        pdyn_status status = PDYN_OK;
        if (from->is_surface)
            status = point_list_append(c, all, from->mesh.vertex, from->mesh.vertices);
        else status = point_list_append(c, all, from->start.x, from->start.count);
        for (int k = 0; status == PDYN_OK && k < from->budget; k++)
            status = point_list_add(c, all, (const double[3]){0});
        if (status != PDYN_OK) return status;
        body->count = all->count - body->first;
        if (from->is_rigid) status = point_list_append(c, all, *from->point, RIGID_POINTS);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
}

/* All vectors of the simulation, particles x 3; the last two are the state a step earlier. */
enum { VECTORS = 15, HISTORY_VECTORS = 2 };

static void list_vectors(struct pdyn_sim *sim, double **vector[VECTORS]) {
    double **all[VECTORS] = {&sim->x,           &sim->v,        &sim->x_next,
                             &sim->gradient,    &sim->trial,    &sim->trial_gradient,
                             &sim->direction,   &sim->negative, &sim->constraint_acceleration,
                             &sim->objective.s, &sim->x_base,   &sim->v_base,
                             &sim->rest,        &sim->x_before, &sim->v_before};
    memcpy(vector, all, sizeof all);
}

static pdyn_status allocate_state(struct pdyn_sim *sim, const struct point_list *all) {
    pdyn_context *c = sim->context;
    double **vector[VECTORS];
    int n = sim->objective.particles = all->count;
    int count = sim->scene.settings.integrator->history ? VECTORS : VECTORS - HISTORY_VECTORS;
    list_vectors(sim, vector);
    for (int k = 0; k < count; k++)
        if (!(*vector[k] = NEW_VECTOR(c, n))) return PDYN_NO_MEMORY;
    sim->density = NEW_ARRAY(c, n, double);
    sim->pressure = NEW_ARRAY(c, n, double);
    sim->pressure_before = NEW_ARRAY(c, n, double);
    sim->objective.mass = NEW_ARRAY(c, n, double);
    sim->objective.partial = NEW_ARRAY(c, pool_blocks(n, PARTICLE_GRAIN), double);
    if (!sim->density || !sim->pressure || !sim->pressure_before || !sim->objective.mass ||
        !sim->objective.partial)
        return PDYN_NO_MEMORY;
    memcpy(sim->x, all->x, 3 * (size_t)n * sizeof *sim->x);
    memcpy(sim->rest, all->x, 3 * (size_t)n * sizeof *sim->rest);
    return PDYN_OK;
}

/* Files often have vertices twice along seams. */
static pdyn_status look_for_seams(struct pdyn_sim *sim, const struct scene_body *body) {
    int doubles;
    pdyn_status status = mesh_count_duplicates(sim->context, &body->mesh, &doubles);
    if (status == PDYN_OK && doubles)
        warnings_say(sim->context,
                     warnings_count(&sim->warnings, WARNING_SEAMS, body->name, 0.0, doubles, 0.0),
                     "%d of its vertices lie where another one does already; triangles that do not "
                     "share a vertex are not joined",
                     doubles);
    return status;
}

static pdyn_status describe_surface(struct pdyn_sim *sim, int b) {
    const struct scene_body *from = &sim->scene.body[b];
    struct topology *t = &sim->topology[b];
    pdyn_body *body = &sim->body[b];
    pdyn_status status = look_for_seams(sim, from);
    if (status == PDYN_OK) status = topology_build(sim->context, &from->mesh, t);
    if (status != PDYN_OK) return status;
    body->triangles = from->mesh.triangles, body->triangle = from->mesh.triangle;
    body->across = t->across, body->triangle_area = t->triangle_area;
    body->vertex_area = t->vertex_area, body->edges = t->edges, body->edge = t->edge;
    body->edge_share = t->edge_share;
    body->tets = from->tets.count, body->tet = from->tets.corner;
    body->tet_volume = from->tets.volume;
    return PDYN_OK;
}

/* The points of a rigid body follow its vertices. */
static int particles_of(const struct pdyn_sim *sim, int b) {
    return sim->body[b].count + (sim->scene.body[b].is_rigid ? RIGID_POINTS : 0);
}

static pdyn_status list_bodies(struct pdyn_sim *sim) {
    struct objective *sys = &sim->objective;
    sys->body = NEW_ARRAY(sim->context, sim->bodies, struct objective_body);
    if (!sys->body) return PDYN_NO_MEMORY;
    sys->bodies = sim->bodies;
    for (int b = 0; b < sys->bodies; b++)
        sys->body[b] = (struct objective_body){.of = &sim->body[b],
                                               .first = sim->body[b].first,
                                               .count = particles_of(sim, b),
                                               .weight = 1.0};
    return PDYN_OK;
}

static pdyn_status fill_bodies(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++) {
        const struct scene_body *from = &sim->scene.body[b];
        pdyn_body *body = &sim->body[b];
        double *mass = sim->objective.mass + body->first, spacing = 2.0 * body->radius;
        pdyn_status status = from->is_surface ? describe_surface(sim, b) : PDYN_OK;
        if (status != PDYN_OK) return status;
        body->rest = sim->rest + 3 * (size_t)body->first, body->mass = mass;
        for (int k = 0; k < 4 * body->tets; k++)
            mass[body->tet[k]] += 0.25 * from->density * body->tet_volume[k / 4];
        for (int i = 0; i < body->count; i++) {
            mass[i] += from->is_surface ? body->area_density * body->vertex_area[i]
                                        : body->rest_density * spacing * spacing * spacing;
            if (from->is_surface || i < from->start_v.count)
                memcpy(sim->v + 3 * (size_t)(body->first + i),
                       from->is_surface ? from->velocity : from->start_v.x + 3 * (size_t)i,
                       sizeof from->velocity);
            sim->density[body->first + i] = body->rest_density;
        }
    }
    return PDYN_OK;
}

static const pdyn_body *find_body(const struct pdyn_sim *sim, const char *name) {
    int b = 0;
    while (strcmp(sim->body[b].name, name) != 0) b++;
    return &sim->body[b];
}

/* Resolves names of other bodies in parameters to the bodies. */
static void find_others(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; k < sim->scene.body[b].constraints; k++) {
            const struct scene_constraint *c = &sim->scene.body[b].constraint[k];
            for (const pdyn_param *p = c->type->params; p->name; p++) {
                pdyn_other *other = (pdyn_other *)((char *)c->params + p->offset);
                if (p->kind == PDYN_OTHER && other->name) other->body = find_body(sim, other->name);
            }
        }
}

/* Frees the scene's copy of the start: the state has it. */
static void forget_start(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++) {
        point_list_free(sim->context, &sim->scene.body[b].start);
        point_list_free(sim->context, &sim->scene.body[b].start_v);
    }
}

/* ---- neighbours: fluid, cloth and walls ------------------------------------------------------ */

/* Of fluid particles, samples and boundary points; a surface acts by its samples alone. */
static pdyn_status fill_volumes(struct pdyn_sim *sim, double spacing, int particles, double *volume,
                                bool *centre, bool *is_wall) {
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!has_neighbour_lists(sim, b)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            volume[i] = spacing * spacing * spacing, centre[i] = true;
    }
    for (int k = 0; sim->samples && k < sim->samples->count; k++)
        volume[sim->objective.particles + k] = sim->samples->rest_volume[k];
    return solid_points_compute_volumes(sim, spacing, volume + particles, is_wall);
}

static pdyn_status create_neighbours(struct pdyn_sim *sim, double spacing) {
    int n = sim->objective.particles + (sim->samples ? sim->samples->count : 0);
    double support = 2.0 * spacing, skin = 0.01 * SKIN_PERCENT * support;
    const struct boundary_model *model = sim->scene.settings.boundary;
    double *volume = NEW_ARRAY(sim->context, n + sim->boundary.at.count, double);
    bool *centre = NEW_ARRAY(sim->context, n, bool);
    bool *is_wall = NEW_ARRAY(sim->context, sim->boundary.at.count + 1, bool);
    pdyn_status status = volume && centre && is_wall
                             ? fill_volumes(sim, spacing, n, volume, centre, is_wall)
                             : PDYN_NO_MEMORY;
    if (status == PDYN_OK) {
        status = occlusion_create(sim->context, sim->bodies, sim->body, n + sim->boundary.at.count,
                                  support + skin, &sim->occlusion);
    }
    kinematic_move(sim, 0.0);
    struct neighbours_points points = {.particles = n,
                                       .centre = centre,
                                       .boundary = sim->boundary.at.count,
                                       .boundary_x = sim->boundary.at.x,
                                       .moving = sim->motion.points,
                                       .volume = volume,
                                       .support = support,
                                       .is_wall = is_wall,
                                       .surface_support = model->support * spacing,
                                       .has_volumes = model->volumes,
                                       .skin = skin,
                                       .occlusion = sim->occlusion};
    if (status == PDYN_OK)
        status = neighbours_create(sim->context, &points, sim->samples, &sim->neighbours);
    FREE_ARRAY(sim->context, volume, n + sim->boundary.at.count);
    FREE_ARRAY(sim->context, centre, n);
    FREE_ARRAY(sim->context, is_wall, sim->boundary.at.count + 1);
    return status;
}

/* Particles, then samples. */
static int way_count(const struct pdyn_sim *sim) {
    return sim->objective.particles + (sim->samples ? sim->samples->count : 0);
}

/* Does some surface need the limit on displacements? Walls of a box and boundary "points" do not.
 */
static pdyn_status make_limits(struct pdyn_sim *sim) {
    bool surfaces = sim->samples;
    for (int k = 0; k < sim->boundary.at.count; k++) surfaces |= !sim->boundary.point[k].of_box;
    if (!surfaces || sim->scene.settings.boundary->volumes) return PDYN_OK;
    sim->way = NEW_ARRAY(sim->context, way_count(sim), double);
    return sim->way ? PDYN_OK : PDYN_NO_MEMORY;
}

/* Warns where particles coincide: constraints have no direction to separate them. */
static void warn_coincident(struct pdyn_sim *sim, const pdyn_body *fluid) {
    const pdyn_neighbours *view = neighbours_view(sim->neighbours);
    int count = 0;
    for (int i = fluid->first; i < fluid->first + fluid->count; i++)
        for (int k = view->start[i]; k < view->boundary_start[i]; k++) {
            int j = view->index[k];
            if (j == i || j >= sim->objective.particles) continue;
            if (vec3_distance(sim->x + 3 * i, sim->x + 3 * j) > 0.0) continue;
            count++;
            break;
        }
    if (!count) return;
    warnings_say(sim->context,
                 warnings_count(&sim->warnings, WARNING_COINCIDENT, fluid->name, 0.0, count, 0.0),
                 "%d particles lie at the place of another one; nothing parts them: do volumes of "
                 "its fill overlap?",
                 count);
}

static pdyn_status find_neighbours(struct pdyn_sim *sim) {
    double spacing = sim_spacing(sim);
    if (spacing == 0.0) return PDYN_OK;
    pdyn_status status = solid_points_sample(sim, spacing);
    if (status == PDYN_OK)
        status = samples_create(sim->context, sim->bodies, sim->body, sim->objective.particles,
                                sim->rest, sim->scene.settings.boundary,
                                sim->scene.has_contact ? sim->scene.contact.thickness : 0.0,
                                spacing, &sim->samples);
    if (status == PDYN_OK) status = create_neighbours(sim, spacing);
    if (status == PDYN_OK) status = make_limits(sim);
    if (status != PDYN_OK) return status;
    live_particles_update_lists(sim);
    sim->objective.neighbours = sim->neighbours, sim->objective.samples = sim->samples;
    status = objective_build_lists(&sim->objective, sim->x);
    for (int b = 0; status == PDYN_OK && b < sim->bodies; b++)
        if (has_neighbour_lists(sim, b)) warn_coincident(sim, &sim->body[b]);
    return status;
}

/* ---- constraints and solver ------------------------------------------------------------------ */

static pdyn_status add_batch(struct pdyn_sim *sim, const pdyn_body *body,
                             const struct scene_constraint *c) {
    struct objective *sys = &sim->objective;
    const pdyn_neighbours *lists = sim->neighbours ? neighbours_view(sim->neighbours) : NULL;
    pdyn_status status = batch_create(sim->context, c->type, c->params, body, &sim->services, lists,
                                      false, &sys->batch[sys->batches]);
    if (status == PDYN_OK) sys->batches++;
    return status;
}

static pdyn_status add_constraint(struct pdyn_sim *sim, const pdyn_body *body,
                                  const struct scene_constraint *c) {
    struct objective *sys = &sim->objective;
    pdyn_status status = add_batch(sim, body, c);
    if (status != PDYN_OK) return status;
    if (c->type->matrix_free) sys->batch[sys->batches - 1]->samples = sim->samples;
    sys->dynamic_rows |= c->type->matrix_free || c->type->update;
    bool on_solids = c->type->matrix_free && c->type->matrix_free->boundary_force;
    sim->anchored |= (c->type->flags & PDYN_ANCHORED) || (on_solids && sim->boundary.at.count);
    sim->constraints = sys->batches;
    return batch_join_rows(sys->batch[sys->batches - 1]);
}

static pdyn_status add_damper(struct pdyn_sim *sim, const pdyn_body *body,
                              const struct scene_constraint *c) {
    if (!c->type->damping || c->type->damping(c->params) == 0.0) return PDYN_OK;
    pdyn_status status = add_batch(sim, body, c);
    if (status == PDYN_OK) sim->objective.batch[sim->objective.batches - 1]->damper = true;
    return status;
}

typedef pdyn_status add_fn(struct pdyn_sim *sim, const pdyn_body *body,
                           const struct scene_constraint *c);

/* Calls `add` for every constraint of every body. */
static pdyn_status add_each(struct pdyn_sim *sim, add_fn *add) {
    pdyn_status status = PDYN_OK;
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; k < sim->scene.body[b].constraints && status == PDYN_OK; k++)
            status = add(sim, &sim->body[b], &sim->scene.body[b].constraint[k]);
    return status;
}

/* First all constraints, then the dampers of some of them. */
static pdyn_status make_batches(struct pdyn_sim *sim) {
    struct objective *sys = &sim->objective;
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) count += 2 * sim->scene.body[b].constraints;
    if (sim->scene.has_contact) count += 3; /* contact, its damping, friction */
    if (sim->samples) count++;              /* slip */
    sys->batch = NEW_ARRAY(sim->context, count, struct batch *);
    if (count && !sys->batch) return PDYN_NO_MEMORY;
    sys->capacity = count;
    pdyn_status status = add_each(sim, add_constraint);
    return status == PDYN_OK ? add_each(sim, add_damper) : status;
}

/* ---- the life of a simulation ---------------------------------------------------------------- */

static pdyn_status make_slip(struct pdyn_sim *sim) {
    struct objective *sys = &sim->objective;
    if (!sim->samples) return PDYN_OK;
    pdyn_status status =
        wet_sides_create(sim->context, &sim->scene, sim->body, sys->particles, sim->samples,
                         neighbours_view(sim->neighbours), &sys->wet_sides);
    if (status != PDYN_OK || !sys->wet_sides) return status;
    status = batch_create(sim->context, &pdyn_constraint_slip, NULL, &sys->wet_sides->all, NULL,
                          NULL, false, &sys->batch[sys->batches]);
    if (status != PDYN_OK) return status;
    sys->dynamic_rows = true;
    sys->batches++;
    for (int b = 0; b < sys->batches; b++) sys->batch[b]->view.wet_sides = &sys->wet_sides->view;
    return PDYN_OK;
}

static pdyn_status build(struct pdyn_sim *sim) {
    struct point_list all = {0};
    sim->services = sim_services(sim->context);
    sim->objective.context = sim->context;
    pdyn_status status = place_bodies(sim, &all);
    if (status == PDYN_OK) status = allocate_state(sim, &all);
    point_list_free(sim->context, &all);
    if (status == PDYN_OK) status = list_bodies(sim);
    if (status == PDYN_OK) status = fill_bodies(sim);
    if (status == PDYN_OK) status = rigid_bodies_create(sim);
    if (status == PDYN_OK) find_others(sim);
    if (status == PDYN_OK) status = live_particles_create(sim);
    if (status == PDYN_OK) forget_start(sim);
    if (status == PDYN_OK) status = find_neighbours(sim);
    if (status == PDYN_OK) status = make_batches(sim);
    if (status == PDYN_OK) status = make_slip(sim);
    if (status == PDYN_OK) status = contact_create(sim);
    if (status == PDYN_OK) status = residual_create(&sim->objective);
    if (status == PDYN_OK) status = solid_load_create(sim);
    sim->control.anchored = sim->anchored;
    if (status == PDYN_OK) status = probes_create(sim);
    sim->damping = sim->scene.settings.newton ? 0.0 : 1.0;
    if (status == PDYN_OK)
        status = solver_view_create(&sim->model, &sim->objective, sim->scene.settings.newton,
                                    &sim->services);
    if (status == PDYN_OK) status = solver_choice_create(sim);
    if (status == PDYN_OK) solver_choice_warn(sim);
    if (status == PDYN_OK) status = crossings_create(sim);
    if (status == PDYN_OK) status = energy_budget_create(sim);
    if (status != PDYN_OK) return status;
    sim->floor = warn_floor(sim);
    status = warn_of_scene(sim);
    if (status != PDYN_OK) return status;
    return acceleration_create(&sim->acceleration, sim->scene.settings.acceleration,
                               &sim->objective);
}

pdyn_status pdyn_scene_load(pdyn_scene *scene, pdyn_sim **out) {
    if (out) *out = NULL;
    if (!scene || !out) return PDYN_BAD_CALL;
    pdyn_context *context = scene->json.context;
    struct pdyn_sim *sim = NEW_ARRAY(context, 1, struct pdyn_sim);
    if (!sim) return PDYN_NO_MEMORY;
    sim->context = context;
    pool_check_process(context->pool);
    pdyn_status status = scene_read(&scene->json, &sim->scene);
    if (status == PDYN_OK) status = build(sim);
    if (status == PDYN_OK) return *out = sim, PDYN_OK;
    pdyn_free(sim);
    return status;
}

static void free_system(struct pdyn_sim *sim) {
    pdyn_context *c = sim->context;
    struct objective *sys = &sim->objective;
    for (int b = 0; b < sys->batches; b++) batch_free(sys->batch[b]);
    contact_free(sys->contact);
    rigid_map_free(sys->rigid);
    wet_sides_free(sys->wet_sides);
    residual_free(sys);
    FREE_ARRAY(c, sys->batch, sys->capacity);
    FREE_ARRAY(c, sys->body, sys->bodies);
    FREE_ARRAY(c, sys->mass, sys->particles);
    FREE_ARRAY(c, sys->partial, pool_blocks(sys->particles, PARTICLE_GRAIN));
}

void pdyn_free(pdyn_sim *sim) {
    if (!sim) return;
    pdyn_context *c = sim->context;
    solver_choice_free(sim);
    acceleration_free(&sim->acceleration);
    solver_view_free(&sim->model);
    double **vector[VECTORS];
    list_vectors(sim, vector);
    for (int k = 0; k < VECTORS; k++) FREE_VECTOR(c, *vector[k], sim->objective.particles);
    FREE_ARRAY(c, sim->way, sim->way ? way_count(sim) : 0);
    FREE_ARRAY(c, sim->density, sim->objective.particles);
    FREE_ARRAY(c, sim->pressure, sim->objective.particles);
    FREE_ARRAY(c, sim->pressure_before, sim->objective.particles);
    free_system(sim);
    crossings_free(sim);
    energy_budget_free(sim);
    control_free(sim);
    live_particles_free(sim);
    neighbours_free(sim->neighbours);
    samples_free(sim->samples);
    occlusion_free(sim->occlusion);
    solid_load_free(sim);
    probes_free(sim);
    boundary_points_free(c, &sim->boundary);
    kinematic_free(c, &sim->motion);
    for (int b = 0; sim->topology && b < sim->bodies; b++) topology_free(c, &sim->topology[b]);
    FREE_ARRAY(c, sim->topology, sim->bodies);
    FREE_ARRAY(c, sim->body, sim->bodies);
    scene_free(c, &sim->scene);
    FREE_ARRAY(c, sim, 1);
}
