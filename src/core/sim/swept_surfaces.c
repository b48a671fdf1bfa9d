#include "swept_surfaces.h"

#include "scene/poses.h"
#include "sim.h"

static bool resize_set(pdyn_context *context, struct swept_triangles *set,
                       enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(set->surface, set->capacity),
        ARRAY(set->triangle, set->capacity),
        ARRAY(set->box, set->capacity),
    };
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

static bool resize_solid(pdyn_context *context, struct swept_surface *s, enum array_action action) {
    const size_t count = s->moves ? 3 * (size_t)s->vertices : 0;
    const size_t sides = s->is_solid ? 3 * (size_t)s->triangles : 0;
    const struct array_entry table[] = {ARRAY(s->pose[0], count), ARRAY(s->pose[1], count),
                                        ARRAY(s->own_across, sides)};
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

static pdyn_status add_solid(struct pdyn_sim *sim, struct swept_surface *s,
                             const struct scene_solid *solid) {
    const struct mesh *mesh = &solid->mesh;
    *s = (struct swept_surface){.name = solid->name,
                                .is_solid = true,
                                .triangle = mesh->triangle,
                                .triangles = mesh->triangles,
                                .vertices = mesh->vertices,
                                .begin = mesh->vertex,
                                .end = mesh->vertex,
                                .moves = solid->motion.keys ? solid : NULL};
    if (!resize_solid(sim->context, s, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    if (s->moves) s->begin = s->pose[0], s->end = s->pose[1];
    s->across = s->own_across;
    return mesh_find_border(sim->context, mesh, s->own_across);
}

static pdyn_status list_surfaces(struct pdyn_sim *sim, bool bodies, struct swept_surfaces *swept) {
    for (int b = 0; b < sim->bodies && bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body->triangles || body->permeability > 0.0) continue;
        swept->surface[swept->count++] =
            (struct swept_surface){.name = body->name,
                                   .triangle = body->triangle,
                                   .across = body->across,
                                   .triangles = body->triangles,
                                   .begin = sim->x + 3 * (size_t)body->first,
                                   .end = sim->x_next + 3 * (size_t)body->first};
    }
    for (; swept->solids < sim->scene.solids; swept->solids++) {
        const struct scene_solid *solid = &sim->scene.solid[swept->solids];
        pdyn_status status = add_solid(sim, &swept->surface[swept->count++], solid);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
}

static bool is_at_rest(const struct swept_surface *s) { return s->begin == s->end; }

static pdyn_status fill_set(pdyn_context *context, const struct swept_surfaces *swept, bool resting,
                            struct swept_triangles *set) {
    for (int s = 0; s < swept->count; s++)
        if (is_at_rest(&swept->surface[s]) == resting) set->capacity += swept->surface[s].triangles;
    if (!resize_set(context, set, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int s = 0; s < swept->count; s++)
        for (int t = 0;
             is_at_rest(&swept->surface[s]) == resting && t < swept->surface[s].triangles; t++)
            set->surface[set->count] = s, set->triangle[set->count++] = t;
    return bvh_create(context, set->capacity, &set->tree);
}

/* The box around the path of each triangle. */
static void build_tree(const struct swept_surfaces *swept, struct swept_triangles *set) {
    for (int k = 0; k < set->count; k++) {
        const struct swept_surface *s = &swept->surface[set->surface[k]];
        const int *corner = s->triangle + 3 * (size_t)set->triangle[k];
        set->box[k] = box_empty;
        for (int i = 0; i < 3; i++) {
            box_add(&set->box[k], s->begin + 3 * (size_t)corner[i]);
            box_add(&set->box[k], s->end + 3 * (size_t)corner[i]);
        }
    }
    bvh_build(&set->tree, set->box, set->count);
}

pdyn_status swept_surfaces_create(struct pdyn_sim *sim, bool bodies, struct swept_surfaces *swept) {
    pdyn_context *context = sim->context;
    swept->capacity = sim->bodies + sim->scene.solids;
    swept->surface = NEW_ARRAY(context, swept->capacity, struct swept_surface);
    if (!swept->surface) return PDYN_NO_MEMORY;
    pdyn_status status = list_surfaces(sim, bodies, swept);
    if (status == PDYN_OK) status = fill_set(context, swept, true, &swept->resting);
    if (status == PDYN_OK) status = fill_set(context, swept, false, &swept->moving);
    if (status == PDYN_OK) build_tree(swept, &swept->resting);
    return status;
}

void swept_surfaces_free(pdyn_context *context, struct swept_surfaces *swept) {
    for (int s = 0; s < swept->count; s++) resize_solid(context, &swept->surface[s], ARRAYS_FREE);
    struct swept_triangles *sets[] = {&swept->resting, &swept->moving};
    for (int k = 0; k < 2; k++) {
        resize_set(context, sets[k], ARRAYS_FREE);
        bvh_free(context, &sets[k]->tree);
    }
    FREE_ARRAY(context, swept->surface, swept->capacity);
}

void swept_surfaces_step(const struct pdyn_sim *sim, struct swept_surfaces *swept, double h) {
    for (int k = 0; k < swept->count; k++) {
        const struct swept_surface *s = &swept->surface[k];
        for (int end = 0; s->moves && end < 2; end++)
            pose_place(&s->moves->motion, s->moves->mesh.vertex, s->vertices, sim->time + end * h,
                       s->pose[end]);
    }
    build_tree(swept, &swept->moving);
}
