/* Construction of contact from bodies and solids: points, faces and edges with their groups, and
 * the memory of all of it. */
#include "base/body.h"
#include "bearings.h"
#include "contact_parts.h"

#include <string.h>

/* ---- sizes ----------------------------------------------------------------------------------- */

static void count_parts(struct contact *c, const struct contact_def *def) {
    const struct scene *scene = def->scene;
    int low = INT32_MAX, high = 0;
    for (int b = 0; b < scene->bodies; b++) {
        const pdyn_body *body = &def->body[b];
        if (!body_is_particles(body)) c->vertices += body->count;
        c->rigids += scene->body[b].is_rigid;
        c->free += body->count, c->free_faces += body->triangles, c->free_edges += body->edges;
        if (body->first < low) low = body->first;
        if (body->first + body->count > high) high = body->first + body->count;
    }
    c->points = c->free, c->faces = c->free_faces, c->edges_room = c->free_edges;
    for (int s = 0; s < scene->solids; s++) {
        const struct mesh *mesh = &scene->solid[s].mesh;
        c->points += mesh->vertices, c->faces += mesh->triangles;
        c->edges_room += 3 * mesh->triangles;
    }
    c->bodies = scene->bodies, c->groups = scene->bodies + scene->solids;
    c->body = (pdyn_body){.name = "all surfaces", .first = low, .count = high - low};
}

/* ---- parts ----------------------------------------------------------------------------------- */

/* Thickness between a fluid particle and a surface, in particle radii. In water at rest, the
 * samples of the surface keep particles farther away, so that contact forces are 0. */
static const double particle_thickness = 0.5;

static void add_body(struct contact *c, const pdyn_body *body, int b, int points) {
    c->name[b] = body->name;
    c->thickness[b] = c->settings->thickness;
    c->permeable[b] = body->permeability > 0.0;
    if (body_is_particles(body))
        c->thickness[b] = fmin(c->thickness[b], particle_thickness * body->radius);
    for (int i = 0; i < body->count; i++) {
        c->column[points + i] = body->first + i;
        c->group[points + i] = b;
    }
    memcpy(c->rest + 3 * (size_t)points, body->rest, 3 * (size_t)body->count * sizeof *c->rest);
}

static void add_bodies(struct contact *c, const struct contact_def *def) {
    int points = 0, particles = c->vertices, faces = 0, edges = 0, rigids = 0;
    for (int b = 0; b < def->scene->bodies; b++) {
        const pdyn_body *body = &def->body[b];
        int *first = body_is_particles(body) ? &particles : &points;
        bool is_rigid = def->scene->body[b].is_rigid;
        add_body(c, body, b, *first);
        if (is_rigid)
            c->rigid[rigids++] =
                (struct contact_rigid){b, points, body->count, body->first + body->count};
        int alone = c->settings->self && !is_rigid ? -1 : b;
        for (int k = 0; k < 3 * body->triangles; k++)
            c->face[3 * faces + k] = points + body->triangle[k];
        for (int k = 0; k < 2 * body->edges; k++) c->edge[2 * edges + k] = points + body->edge[k];
        for (int i = 0; first == &points && i < body->count; i++)
            c->broad.vertex_body[points + i] = alone;
        for (int k = 0; k < body->triangles; k++) c->broad.face_body[faces + k] = alone;
        for (int k = 0; k < body->edges; k++) c->broad.edge_body[edges + k] = alone;
        *first += body->count, faces += body->triangles, edges += body->edges;
    }
}

/* Points that no triangle has belong to no group. */
static void add_solids(struct contact *c, const struct scene *scene) {
    int points = c->free, faces = c->free_faces;
    c->edges = c->free_edges;
    for (int s = 0; s < scene->solids; s++) {
        const struct scene_solid *solid = &scene->solid[s];
        const struct mesh *mesh = &solid->mesh;
        c->name[c->bodies + s] = solid->name;
        c->thickness[c->bodies + s] = c->settings->thickness;
        c->solid[s] = (struct contact_solid){solid, points, mesh->vertices};
        c->moving |= solid->motion.keys > 0;
        for (int i = 0; i < mesh->vertices; i++) c->group[points + i] = -1;
        memcpy(c->rest + 3 * (size_t)points, mesh->vertex,
               3 * (size_t)mesh->vertices * sizeof *c->rest);
        for (int k = 0; k < 3 * mesh->triangles; k++) {
            c->face[3 * faces + k] = points + mesh->triangle[k];
            c->group[points + mesh->triangle[k]] = c->bodies + s;
        }
        c->edges += mesh_edges(mesh, points, c->edge + 2 * c->edges);
        points += mesh->vertices, faces += mesh->triangles;
    }
}

/* The parts of surfaces may have owners. */
static pdyn_status create_trees(struct contact *c) {
    struct broad_phase *b = &c->broad;
    const struct {
        struct bvh *tree;
        int capacity;
        const int *owner;
    } tree[] = {
        {&b->vertex_tree, c->vertices, b->vertex_body},
        {&b->other_tree, c->points - c->vertices, NULL},
        {&b->face_tree[0], c->free_faces, b->face_body},
        {&b->face_tree[1], c->faces - c->free_faces, NULL},
        {&b->edge_tree[0], c->free_edges, b->edge_body},
        {&b->edge_tree[1], c->edges - c->free_edges, NULL},
    };
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < sizeof tree / sizeof *tree && status == PDYN_OK; k++) {
        status = bvh_create(c->context, tree[k].capacity, tree[k].tree);
        tree[k].tree->owner = tree[k].owner;
    }
    return status;
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* The arrays of struct contact and of its parts, in their order. */
static bool resize(struct contact *c, enum array_action action) {
    size_t n = (size_t)c->points, solids = n - (size_t)c->free, edges = (size_t)c->edges_room;
    const struct array_entry table[] = {
        ARRAY(c->thickness, c->groups),
        ARRAY(c->name, c->groups),
        ARRAY(c->group, n),
        ARRAY(c->column, c->free),
        ARRAY(c->rest, 3 * n),
        ARRAY(c->at, 3 * n),
        ARRAY(c->start_at, 3 * n),
        ARRAY(c->face, 3 * (size_t)c->faces),
        ARRAY(c->edge, 2 * edges),
        ARRAY(c->solid, c->groups - c->bodies),
        ARRAY(c->rigid, c->rigids),
        ARRAY(c->permeable, c->groups),
        ARRAY(c->begin, 3 * solids),
        ARRAY(c->goal, 3 * solids),
        ARRAY(c->flat.across, 3 * (size_t)c->faces),
        ARRAY(c->flat.part, c->faces),
        ARRAY(c->flat.edge, edges),
        ARRAY(c->flat.point, n),
        ARRAY(c->common.held, c->bodies),
        ARRAY(c->common.displacement, 3 * (size_t)c->bodies),
        ARRAY(c->common.cluster, c->bodies),
        ARRAY(c->common.members, c->bodies),
        ARRAY(c->common.held_cluster, c->bodies),
        ARRAY(c->broad.region, n),
        ARRAY(c->broad.built, 3 * n),
        ARRAY(c->broad.reach, n),
        ARRAY(c->broad.point_box, n),
        ARRAY(c->broad.face_box, c->faces),
        ARRAY(c->broad.edge_box, edges),
        ARRAY(c->broad.changed, n),
        ARRAY(c->broad.face_changed, c->faces),
        ARRAY(c->broad.edge_changed, edges),
        ARRAY(c->broad.vertex_body, c->vertices),
        ARRAY(c->broad.face_body, c->free_faces),
        ARRAY(c->broad.edge_body, c->free_edges),
        ARRAY(c->pairs.seen, 3 * n),
        ARRAY(c->pairs.moved, n),
        ARRAY(c->pairs.of_group, c->groups),
        ARRAY(c->path.x, 3 * n),
        ARRAY(c->path.step, 3 * n),
        ARRAY(c->path.length, n),
        ARRAY(c->path.taken, n),
        ARRAY(c->path.cut, n),
    };
    return context_arrays(c->context, table, ARRAY_ROWS(table), action);
}

/* ---- all ------------------------------------------------------------------------------------- */

pdyn_status contact_create(pdyn_context *context, const struct contact_def *def,
                           struct contact **out) {
    if (!def->scene->has_contact) return PDYN_OK;
    struct contact *c = *out = NEW_ARRAY(context, 1, struct contact);
    if (!c) return PDYN_NO_MEMORY;
    c->context = context, c->settings = &def->scene->contact, c->live = def->live;
    c->current.view = c->start.view = (pdyn_contacts){.stiffness = c->settings->stiffness,
                                                      .friction = c->settings->friction,
                                                      .particles = def->particles};
    count_parts(c, def);
    if (!resize(c, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    add_bodies(c, def);
    add_solids(c, def->scene);
    for (int i = 0; i < c->points; i++) c->broad.region[i] = box_empty;
    pdyn_status status = contact_find_flat_sides(c);
    if (status == PDYN_OK) status = create_trees(c);
    if (status == PDYN_OK) status = bearings_create(c, def->rigid);
    return status == PDYN_OK ? contact_place(c, def->x) : status;
}

void contact_free(struct contact *c) {
    if (!c) return;
    pdyn_context *x = c->context;
    contact_free_pairs(c);
    contact_list_free(x, &c->current);
    contact_list_free(x, &c->start);
    row_memory_free(x, &c->pressed, sizeof *c->current.force);
    bearings_free(c);
    bvh_free(x, &c->broad.vertex_tree);
    bvh_free(x, &c->broad.other_tree);
    for (int k = 0; k < 2; k++) {
        bvh_free(x, &c->broad.face_tree[k]);
        bvh_free(x, &c->broad.edge_tree[k]);
    }
    resize(c, ARRAYS_FREE);
    FREE_ARRAY(x, c, 1);
}
