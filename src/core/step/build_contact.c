/* Contact of a simulation: points, faces and edges of all surfaces and solids, and the batches of
 * contact, its damping and friction. */
#include "base/registry.h"
#include "build.h"
#include "contact/bearings.h"
#include "live_particles.h"
#include "scene/poses.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <stdlib.h>
#include <string.h>

/* ---- sizes ----------------------------------------------------------------------------------- */

static int compare_edges(const void *a, const void *b) { return memcmp(a, b, 2 * sizeof(int)); }

/* Writes the edges of a mesh, each once, as pairs of points that count from `first`. edge has room
 * for 3 x triangles of them. Returns the number of edges. */
static int mesh_edges(const struct mesh *mesh, int first, int *edge) {
    int count = 3 * mesh->triangles, kept = 0;
    for (int k = 0; k < count; k++) {
        int a = mesh->triangle[k], b = mesh->triangle[k / 3 * 3 + (k + 1) % 3];
        edge[2 * k] = first + (a < b ? a : b), edge[2 * k + 1] = first + (a < b ? b : a);
    }
    qsort(edge, (size_t)count, 2 * sizeof *edge, compare_edges);
    for (int k = 0; k < count; k++) {
        if (k && !compare_edges(edge + 2 * k, edge + 2 * kept - 2)) continue;
        memmove(edge + 2 * kept++, edge + 2 * k, 2 * sizeof *edge);
    }
    return kept;
}

static void count_parts(struct contact *c, const struct pdyn_sim *sim) {
    int low = INT32_MAX, high = 0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (body->triangles) c->vertices += body->count;
        c->rigids += sim->scene.body[b].is_rigid;
        c->free += body->count, c->free_faces += body->triangles, c->free_edges += body->edges;
        if (body->first < low) low = body->first;
        if (body->first + body->count > high) high = body->first + body->count;
    }
    c->points = c->free, c->faces = c->free_faces, c->edges_room = c->free_edges;
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct mesh *mesh = &sim->scene.solid[s].mesh;
        c->points += mesh->vertices, c->faces += mesh->triangles;
        c->edges_room += 3 * mesh->triangles;
    }
    c->bodies = sim->bodies, c->groups = sim->bodies + sim->scene.solids;
    c->body = (pdyn_body){.name = "all surfaces", .first = low, .count = high - low};
}

/* ---- parts ----------------------------------------------------------------------------------- */

/* Thickness between a fluid particle and a surface, in particle radii. In water at rest, the
 * samples of the surface keep particles farther away, so that contact forces are 0. */
static const double particle_thickness = 0.5;

static void add_body(struct contact *c, const struct pdyn_sim *sim, int b, int points) {
    const pdyn_body *body = &sim->body[b];
    c->name[b] = body->name;
    c->thickness[b] = c->settings->thickness;
    c->permeable[b] = body->permeability > 0.0;
    if (!body->triangles)
        c->thickness[b] = fmin(c->thickness[b], particle_thickness * body->radius);
    for (int i = 0; i < body->count; i++) {
        c->column[points + i] = body->first + i;
        c->group[points + i] = b;
    }
    memcpy(c->rest + 3 * (size_t)points, body->rest, 3 * (size_t)body->count * sizeof *c->rest);
}

static void add_bodies(struct contact *c, const struct pdyn_sim *sim) {
    int points = 0, particles = c->vertices, faces = 0, edges = 0, rigids = 0;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        int *first = body->triangles ? &points : &particles;
        bool is_rigid = sim->scene.body[b].is_rigid;
        add_body(c, sim, b, *first);
        if (is_rigid)
            c->rigid[rigids++] =
                (struct contact_rigid){b, points, body->count, body->first + body->count};
        int alone = c->settings->self && !is_rigid ? -1 : b;
        for (int k = 0; k < 3 * body->triangles; k++)
            c->face[3 * faces + k] = points + body->triangle[k];
        for (int k = 0; k < 2 * body->edges; k++) c->edge[2 * edges + k] = points + body->edge[k];
        for (int k = 0; k < body->triangles; k++) c->broad.face_body[faces + k] = alone;
        for (int k = 0; k < body->edges; k++) c->broad.edge_body[edges + k] = alone;
        *first += body->count, faces += body->triangles, edges += body->edges;
    }
}

/* Points that no triangle has belong to no group. Points of solids that move are stored relative to
 * the pivot. */
static void add_solids(struct contact *c, const struct pdyn_sim *sim) {
    int points = c->free, faces = c->free_faces;
    c->edges = c->free_edges;
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct scene_solid *solid = &sim->scene.solid[s];
        const struct mesh *mesh = &solid->mesh;
        c->name[c->bodies + s] = solid->name;
        c->thickness[c->bodies + s] = c->settings->thickness;
        c->solid[s] = (struct contact_solid){solid, points, mesh->vertices};
        c->moving |= solid->motion.keys > 0;
        for (int i = 0; i < mesh->vertices; i++) {
            c->group[points + i] = -1;
            memcpy(c->rest + 3 * (points + i), mesh->vertex + 3 * i, 3 * sizeof *c->rest);
            if (solid->motion.keys) vec3_add(c->rest + 3 * (points + i), -1.0, solid->motion.pivot);
        }
        for (int k = 0; k < 3 * mesh->triangles; k++) {
            c->face[3 * faces + k] = points + mesh->triangle[k];
            c->group[points + mesh->triangle[k]] = c->bodies + s;
        }
        c->edges += mesh_edges(mesh, points, c->edge + 2 * c->edges);
        points += mesh->vertices, faces += mesh->triangles;
    }
}

/* The trees of faces or edges of surfaces and of solids; owner: of the former. */
static pdyn_status create_pair_of_trees(struct contact *c, struct bvh tree[2], int surfaces,
                                        int solids, const int *owner) {
    pdyn_status status = bvh_create(c->context, surfaces, &tree[0]);
    if (status == PDYN_OK) status = bvh_create(c->context, solids, &tree[1]);
    tree[0].owner = owner;
    return status;
}

static pdyn_status create_trees(struct contact *c) {
    struct bvh *faces[] = {c->broad.face_tree, c->broad.changed_faces},
               *edges[] = {c->broad.edge_tree, c->broad.changed_edges};
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 2 && status == PDYN_OK; k++) {
        status = create_pair_of_trees(c, faces[k], c->free_faces, c->faces - c->free_faces,
                                      c->broad.face_body);
        if (status == PDYN_OK)
            status = create_pair_of_trees(c, edges[k], c->free_edges, c->edges - c->free_edges,
                                          c->broad.edge_body);
    }
    return status;
}

/* ---- batches --------------------------------------------------------------------------------- */

static pdyn_status add_batch(struct pdyn_sim *sim, const pdyn_constraint_type *type,
                             struct batch **out) {
    struct objective *objective = &sim->objective;
    pdyn_status status = objective_add_batch(
        objective, &(struct batch_def){.type = type, .body = &objective->contact->body});
    if (status == PDYN_OK) *out = objective->batch[objective->batches - 1];
    return status;
}

/* Shows all constraints the contacts: those of the local step, or of the beginning of the step. */
static void show(struct pdyn_sim *sim) {
    struct contact *c = sim->objective.contact;
    const pdyn_contacts contacts = {.stiffness = c->settings->stiffness,
                                    .friction = c->settings->friction,
                                    .particles = sim->objective.particles};
    c->current.view = c->start.view = contacts;
    for (int k = 0; k < sim->objective.batches; k++) {
        struct batch *b = sim->objective.batch[k];
        bool always = b->type->flags & PDYN_EVERY_ITERATION;
        b->view.contacts = always ? &c->current.view : &c->start.view;
    }
}

static pdyn_status add_batches(struct pdyn_sim *sim) {
    struct contact *c = sim->objective.contact;
    sim->objective.dynamic_rows = true;
    pdyn_status status = add_batch(sim, &pdyn_constraint_contact, &c->barrier);
    if (status == PDYN_OK) status = bearings_create(c, sim->objective.rigid);
    if (status == PDYN_OK && c->bearings)
        status = add_batch(sim, &pdyn_constraint_contact_damping, &c->damping);
    if (status == PDYN_OK && c->settings->friction > 0.0)
        status = add_batch(sim, &pdyn_constraint_friction, &c->friction);
    show(sim);
    return status;
}

/* Places solids at time 0, finds the first contacts and checks them. */
static pdyn_status place(struct pdyn_sim *sim) {
    struct contact *c = sim->objective.contact;
    for (int i = 0; i < c->points; i++) c->broad.region[i] = box_empty;
    for (int s = 0; s < c->groups - c->bodies; s++) {
        const struct contact_solid *solid = &c->solid[s];
        const double *from = c->rest + 3 * (size_t)solid->first;
        double *goal = c->goal + 3 * (size_t)(solid->first - c->free);
        if (solid->solid->motion.keys)
            pose_place(&solid->solid->motion, from, solid->count, 0.0, goal);
        else memcpy(goal, from, 3 * (size_t)solid->count * sizeof *from);
    }
    if (c->goal)
        memcpy(c->at + 3 * (size_t)c->free, c->goal,
               3 * (size_t)(c->points - c->free) * sizeof *c->at);
    pdyn_status status = contact_local(c, sim->x);
    return status == PDYN_OK ? contact_check(c) : status;
}

pdyn_status contact_create(struct pdyn_sim *sim) {
    if (!sim->scene.has_contact) return PDYN_OK;
    struct contact *c = sim->objective.contact = NEW_ARRAY(sim->context, 1, struct contact);
    if (!c) return PDYN_NO_MEMORY;
    c->context = sim->context, c->settings = &sim->scene.contact;
    c->live = sim->live ? sim->live->live : NULL;
    count_parts(c, sim);
    if (!contact_resize(c, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    add_bodies(c, sim);
    add_solids(c, sim);
    pdyn_status status = contact_find_flat_sides(c);
    if (status == PDYN_OK) status = create_trees(c);
    if (status == PDYN_OK) status = add_batches(sim);
    return status == PDYN_OK ? place(sim) : status;
}
