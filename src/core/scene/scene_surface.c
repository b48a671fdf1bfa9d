/* Reading a surface: a grid or the triangles of a file. */
#include "file_ref.h"
#include "params.h"
#include "scene_body.h"
#include "transform.h"

static pdyn_status read_grid(struct reader *r, const struct json_at *at) {
    static const char *const keys[] = {"size", "vertices", "sag", NULL};
    struct json_at size_at = json_member(at, "size"), vertices_at = json_member(at, "vertices");
    struct json_at sag_at = json_member(at, "sag");
    double size[2], sag = 0.0;
    int *vertices = r->body->grid;
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = params_reals(&size_at, 2, 1e-6, 1e6, "m", size);
    if (status == PDYN_OK) status = params_counts(&vertices_at, 2, 2, vertices);
    if (status == PDYN_OK)
        status = reader_add_particles(r, &vertices_at, (double)vertices[0] * vertices[1]);
    if (status == PDYN_OK && sag_at.value) status = params_real(&sag_at, -1e6, 1e6, "m", &sag);
    if (status != PDYN_OK) return status;
    return json_wrap(at, mesh_grid(r->context, size, vertices, sag, &r->body->mesh));
}

static pdyn_status read_mesh(struct reader *r, const struct json_at *at) {
    pdyn_status status = file_ref_mesh(at, &r->body->mesh, &r->body->obj);
    return status == PDYN_OK ? reader_add_particles(r, at, r->body->mesh.vertices) : status;
}

static const pdyn_param params[] = {
    {"area_density", PDYN_REAL, offsetof(struct scene_body, area_density), true, 0, 1e-6, 1e6,
     "kg/m^2", ""},
    {"fluid_friction", PDYN_REAL, offsetof(struct scene_body, fluid_friction), false, 0, 0, 1e9,
     "Pa s/m", ""},
    {"permeability", PDYN_REAL, offsetof(struct scene_body, permeability), false, 0, 0, 1e6,
     "m/(Pa s)", ""},
    {0}};

static const char *const others[] = {"grid", "mesh", "scale", "rotate", "translate", NULL};

static pdyn_status read(struct reader *r, const struct json_at *at) {
    struct scene_body *body = r->body;
    struct json_at grid = json_member(at, "grid"), mesh = json_member(at, "mesh");
    struct transform transform;
    body->has_mesh = true;
    pdyn_status status = reader_one_of(at, others, 2, NULL);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, &transform);
    if (status != PDYN_OK) return status;
    status = grid.value ? read_grid(r, &grid) : read_mesh(r, &mesh);
    if (status != PDYN_OK) return status;
    transform_points(&transform, body->mesh.vertex, body->mesh.vertices);
    status = mesh_check(&body->mesh, "as placed");
    if (status == PDYN_OK) status = mesh_check_cloth(r->context, &body->mesh, "as placed");
    return json_wrap(grid.value ? &grid : &mesh, status);
}

const struct scene_kind scene_surface = {"surface", params, others, read};
