/* Reading a volume of tetrahedra: a grid, those of a file, or a mesh filled with cells. */
#include "file_ref.h"
#include "filled_mesh.h"
#include "params.h"
#include "scene_body.h"
#include "transform.h"

static const pdyn_param params[] = {
    {"density", PDYN_REAL, offsetof(struct scene_body, density), true, 0, 1e-6, 1e6, "kg/m^3", ""},
    {"fluid_friction", PDYN_REAL, offsetof(struct scene_body, fluid_friction), false, 0, 0, 1e9,
     "Pa s/m", ""},
    {0}};

static pdyn_status read_tet_grid(struct reader *r, const struct json_at *at) {
    static const char *const keys[] = {"size", "cells", NULL};
    struct json_at size_at = json_member(at, "size"), cells_at = json_member(at, "cells");
    double size[3], vertices = 0.0;
    int cells[3];
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = params_reals(&size_at, 3, 1e-6, 1e6, "m", size);
    if (status == PDYN_OK) status = params_counts(&cells_at, 3, 1, cells);
    if (status == PDYN_OK) vertices = (1.0 + cells[0]) * (1.0 + cells[1]) * (1.0 + cells[2]);
    if (status == PDYN_OK) status = reader_add_particles(r, &cells_at, vertices);
    if (status == PDYN_OK && vertices > MAX_PARTICLES / 16)
        status = json_fail(&cells_at, "more than %d vertices", MAX_PARTICLES / 16);
    if (status != PDYN_OK) return status;
    return json_wrap(at, tets_grid(r->context, size, cells, &r->body->mesh, &r->body->tets));
}

static pdyn_status read_tet_mesh(struct reader *r, const struct json_at *at) {
    pdyn_status status = file_ref_tets(at, &r->body->mesh, &r->body->tets);
    return status == PDYN_OK ? reader_add_particles(r, at, r->body->mesh.vertices) : status;
}

/* Places tetrahedra. */
static pdyn_status place_tets(struct reader *r, const struct json_at *at,
                              const struct transform *transform) {
    struct scene_body *body = r->body;
    transform_points(transform, body->mesh.vertex, body->mesh.vertices);
    return json_wrap(at, tets_finish(r->context, "as placed", &body->mesh, &body->tets));
}

static const char *const others[] = {"grid", "mesh", "cell", "scale", "rotate", "translate", NULL};

static pdyn_status read(struct reader *r, const struct json_at *at) {
    struct scene_body *body = r->body;
    struct json_at grid = json_member(at, "grid"), mesh = json_member(at, "mesh");
    struct json_at cell = json_member(at, "cell");
    struct transform transform;
    body->has_mesh = true;
    pdyn_status status = reader_one_of(at, others, 2, NULL);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, &transform);
    if (status == PDYN_OK && cell.value && grid.value)
        status = json_fail_at_key(&cell, "\"cell\" needs a \"mesh\"");
    if (status != PDYN_OK) return status;
    if (cell.value) {
        status = filled_mesh_read(&mesh, &cell, &transform, body);
        return status == PDYN_OK ? reader_add_particles(r, &mesh, body->mesh.vertices) : status;
    }
    status = grid.value ? read_tet_grid(r, &grid) : read_tet_mesh(r, &mesh);
    return status == PDYN_OK ? place_tets(r, grid.value ? &grid : &mesh, &transform) : status;
}

const struct scene_kind scene_volume = {"volume", params, others, read};
