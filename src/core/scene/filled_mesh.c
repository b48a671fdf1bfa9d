#include "filled_mesh.h"

#include "file_ref.h"
#include "geometry/mesh_query.h"
#include "params.h"

#include <math.h>
#include <string.h>

/* Counts the corners of body->skin that are farther from all tetrahedra than a cell and a twentieth
 * of the body: the tip of a needle is so in cells of any size, but then it is short. corner: of its
 * vertices, whether a triangle has them; others are left out. */
static pdyn_status find_missed(pdyn_context *context, double cell, struct scene_body *body,
                               bool *corner) {
    const struct mesh *skin = &body->skin;
    struct mesh_query outside;
    struct box bounds = box_empty;
    for (int k = 0; k < 3 * skin->triangles; k++) {
        corner[skin->triangle[k]] = true;
        box_add(&bounds, skin->vertex + 3 * (size_t)skin->triangle[k]);
    }
    double far = fmax(cell, 0.05 * box_extent(&bounds));
    pdyn_status status = mesh_query_create(context, &body->mesh, &outside);
    if (status != PDYN_OK) return status;
    for (int i = 0; i < skin->vertices; i++)
        body->missed +=
            corner[i] && !mesh_query_is_close(&outside, skin->vertex + 3 * (size_t)i, far);
    mesh_query_free(context, &outside);
    return PDYN_OK;
}

static pdyn_status count_missed(pdyn_context *context, double cell, struct scene_body *body) {
    bool *corner = NEW_ARRAY(context, body->skin.vertices, bool);
    pdyn_status status = corner ? find_missed(context, cell, body, corner) : PDYN_NO_MEMORY;
    FREE_ARRAY(context, corner, body->skin.vertices);
    return status;
}

/* Fills the closed mesh body->skin, in its place, and says how well the tetrahedra fit. */
static pdyn_status fill(pdyn_context *context, double cell, struct scene_body *body) {
    struct mesh *surface = &body->skin;
    struct mesh_turned turned;
    double filled = 0.0;
    pdyn_status status = mesh_check(surface, "as placed");
    if (status == PDYN_OK) status = mesh_check_closed(context, surface, "\"cell\"");
    if (status == PDYN_OK) status = mesh_orient_pieces(context, surface, &turned);
    if (status == PDYN_OK) status = tets_fill(context, surface, cell, &body->mesh, &body->tets);
    if (status == PDYN_OK) status = tets_finish(context, "filled", &body->mesh, &body->tets);
    if (status != PDYN_OK) return status;
    for (int t = 0; t < body->tets.count; t++) filled += body->tets.volume[t];
    double volume = mesh_volume(surface->triangles, surface->triangle, surface->vertex);
    if (volume < 0.0) mesh_turn(surface);
    body->filled = filled / fabs(volume);
    status = tets_count_small(context, &body->mesh, &body->tets, 8.0 * cell * cell * cell,
                              &body->crumbs);
    return status == PDYN_OK ? count_missed(context, cell, body) : status;
}

pdyn_status filled_mesh_read(const struct json_at *at, const struct json_at *cell_at,
                             const struct transform *transform, struct scene_body *body) {
    double cell;
    pdyn_status status = params_real(cell_at, 1e-6, 1e6, "m", &cell);
    if (status == PDYN_OK) status = file_ref_mesh(at, &body->skin, NULL);
    if (status != PDYN_OK) return status;
    transform_points(transform, body->skin.vertex, body->skin.vertices);
    return json_wrap(at, fill(at->file->context, cell, body));
}

/* Leaves out the vertices that no triangle has. number: vertices. */
static pdyn_status keep_outside(pdyn_context *context, struct mesh *mesh, int *number) {
    struct mesh outside;
    int kept = 0;
    for (int k = 0; k < 3 * mesh->triangles; k++) number[mesh->triangle[k]] = 1;
    for (int i = 0; i < mesh->vertices; i++) number[i] = number[i] ? kept++ : -1;
    pdyn_status status = mesh_allocate(context, kept, mesh->triangles, &outside);
    if (status != PDYN_OK) return status;
    for (int i = 0; i < mesh->vertices; i++)
        if (number[i] >= 0)
            memcpy(outside.vertex + 3 * (size_t)number[i], mesh->vertex + 3 * (size_t)i,
                   3 * sizeof *mesh->vertex);
    for (int k = 0; k < 3 * mesh->triangles; k++) outside.triangle[k] = number[mesh->triangle[k]];
    mesh_free(context, mesh);
    *mesh = outside;
    return PDYN_OK;
}

pdyn_status filled_mesh_read_surface(const struct json_at *at, const struct json_at *cell,
                                     const struct transform *transform, struct scene_body *body) {
    pdyn_context *context = at->file->context;
    pdyn_status status = filled_mesh_read(at, cell, transform, body);
    tets_free(context, &body->tets);
    if (status != PDYN_OK) return status;
    int vertices = body->mesh.vertices, *number = NEW_ARRAY(context, vertices, int);
    status = number ? keep_outside(context, &body->mesh, number) : PDYN_NO_MEMORY;
    FREE_ARRAY(context, number, vertices);
    return status;
}
