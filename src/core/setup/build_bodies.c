/* Bodies of a simulation, from those of its scene: their particles, one body after the other, with
 * masses and the state at the start. */
#include "base/param_kind.h"
#include "build.h"
#include "scene/derived.h"
#include "sim/sim.h"
#include "step/integrator.h"

#include <string.h>

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
                            .area_density = from->area_density,
                            .permeability = from->permeability};
        pdyn_status status = PDYN_OK;
        if (from->has_mesh)
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

static bool resize_state(struct pdyn_sim *sim, enum array_action action) {
    const struct integrator *integrator = sim->scene.settings.integrator;
    size_t n = (size_t)sim->objective.particles, vector = VECTOR_LENGTH(n);
    size_t history = integrator && integrator->history ? vector : 0;
    const struct array_entry table[] = {
        ARRAY(sim->x, vector),
        ARRAY(sim->v, vector),
        ARRAY(sim->x_next, vector),
        ARRAY(sim->gradient, vector),
        ARRAY(sim->trial, vector),
        ARRAY(sim->trial_gradient, vector),
        ARRAY(sim->direction, vector),
        ARRAY(sim->rhs, vector),
        ARRAY(sim->constraint_acceleration, vector),
        ARRAY(sim->x_base, vector),
        ARRAY(sim->v_base, vector),
        ARRAY(sim->rest, vector),
        ARRAY(sim->x_before, history),
        ARRAY(sim->v_before, history),
        ARRAY(sim->density, n),
        ARRAY(sim->pressure, n),
        ARRAY(sim->pressure_before, n),
        ARRAY(sim->objective.s, vector),
        ARRAY(sim->objective.mass, n),
        ARRAY(sim->impacts.passed_on, 3 * (size_t)sim->bodies),
        ARRAY(sim->impacts.group, n),
        ARRAY(sim->momentum_group, n),
        ARRAY(sim->objective.partial, pool_blocks((int)n, PARTICLE_GRAIN)),
    };
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
}

/* Allocates the state and sets its positions. */
static pdyn_status start_state(struct pdyn_sim *sim, const struct point_list *all) {
    sim->objective.particles = all->count;
    if (!resize_state(sim, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    memcpy(sim->x, all->x, objective_bytes(&sim->objective));
    memcpy(sim->rest, all->x, objective_bytes(&sim->objective));
    sim->objective.inertia = sim->objective.mass;
    return PDYN_OK;
}

/* Files often have vertices twice along seams. */
static pdyn_status look_for_seams(struct pdyn_sim *sim, const struct scene_body *body) {
    int doubles;
    pdyn_status status = mesh_count_duplicates(sim->context, &body->mesh, &doubles);
    if (status == PDYN_OK && doubles)
        warnings_say(sim->context, sim_warning(sim, WARNING_SEAMS, body->name, doubles, 0.0),
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
    struct objective *objective = &sim->objective;
    objective->body = NEW_ARRAY(sim->context, sim->bodies, struct objective_body);
    if (!objective->body) return PDYN_NO_MEMORY;
    objective->bodies = sim->bodies;
    for (int b = 0; b < objective->bodies; b++)
        objective->body[b] = (struct objective_body){.of = &sim->body[b],
                                                     .first = sim->body[b].first,
                                                     .count = particles_of(sim, b),
                                                     .weight = 1.0};
    return PDYN_OK;
}

/* A vertex has a third of its triangles and a fourth of its tetrahedra, a particle a cube as wide
 * as the spacing. */
static void set_masses(struct pdyn_sim *sim, int b) {
    const struct scene_body *from = &sim->scene.body[b];
    const pdyn_body *body = &sim->body[b];
    double *mass = sim->objective.mass + body->first, spacing = 2.0 * body->radius;
    for (int k = 0; k < 4 * body->tets; k++)
        mass[body->tet[k]] += 0.25 * from->density * body->tet_volume[k / 4];
    for (int i = 0; i < body->count; i++)
        mass[i] += from->has_mesh ? body->area_density * body->vertex_area[i]
                                  : body->rest_density * spacing * spacing * spacing;
}

/* All vertices have the velocity of the body, particles of "fill" one each, and those of inlets 0.
 */
static void set_velocities(struct pdyn_sim *sim, int b) {
    const struct scene_body *from = &sim->scene.body[b];
    double *v = sim->v + 3 * (size_t)sim->body[b].first;
    if (!from->has_mesh && from->start_v.count)
        memcpy(v, from->start_v.x, 3 * (size_t)from->start_v.count * sizeof *v);
    for (int i = 0; from->has_mesh && i < sim->body[b].count; i++)
        memcpy(v + 3 * (size_t)i, from->velocity, sizeof from->velocity);
}

static pdyn_status set_bodies(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++) {
        pdyn_body *body = &sim->body[b];
        pdyn_status status = sim->scene.body[b].has_mesh ? describe_surface(sim, b) : PDYN_OK;
        if (status != PDYN_OK) return status;
        body->rest = sim->rest + 3 * (size_t)body->first;
        body->mass = sim->objective.mass + body->first;
        set_masses(sim, b);
        set_velocities(sim, b);
        for (int i = body->first; i < body->first + body->count; i++)
            sim->density[i] = body->rest_density;
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
                pdyn_other *other = (pdyn_other *)param_other(p, c->params);
                if (!other || !other->name) continue;
                other->body = find_body(sim, other->name);
                *(pdyn_other *)param_other(p, derived_given(c)) = *other;
            }
        }
}

pdyn_status bodies_create(struct pdyn_sim *sim) {
    struct point_list all = {0};
    pdyn_status status = place_bodies(sim, &all);
    if (status == PDYN_OK) status = start_state(sim, &all);
    point_list_free(sim->context, &all);
    if (status == PDYN_OK) status = list_bodies(sim);
    if (status == PDYN_OK) status = set_bodies(sim);
    if (status == PDYN_OK) find_others(sim);
    return status;
}

void bodies_forget_start(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++) {
        point_list_free(sim->context, &sim->scene.body[b].start);
        point_list_free(sim->context, &sim->scene.body[b].start_v);
    }
}

void bodies_free(struct pdyn_sim *sim) {
    pdyn_context *c = sim->context;
    resize_state(sim, ARRAYS_FREE);
    for (int b = 0; sim->topology && b < sim->bodies; b++) topology_free(c, &sim->topology[b]);
    FREE_ARRAY(c, sim->topology, sim->bodies);
    FREE_ARRAY(c, sim->body, sim->bodies);
    FREE_ARRAY(c, sim->objective.body, sim->objective.bodies);
}
