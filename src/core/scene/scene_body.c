/* Reading a body: particles, surface or volume, with its constraints. */
#include "base/registry.h"
#include "file_ref.h"
#include "fill.h"
#include "filled_mesh.h"
#include "inlet.h"
#include "inlet_motion.h"
#include "keyed.h"
#include "params.h"
#include "reader.h"
#include "scene_rigid.h"
#include "transform.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- particles ------------------------------------------------------------------------------- */

static const pdyn_param particles_params[] = {
    {"radius", PDYN_REAL, offsetof(struct scene_body, radius), true, 0, 1e-6, 1e3, "m", ""},
    {"rest_density", PDYN_REAL, offsetof(struct scene_body, rest_density), false, 1000, 1e-3, 1e6,
     "kg/m^3", ""},
    {"budget", PDYN_INT, offsetof(struct scene_body, budget), false, 0, 1, MAX_PARTICLES, "", ""},
    {0}};

static pdyn_status read_fill(struct reader *r, const struct json_at *at, int index) {
    pdyn_status status = fill_read(at, r->body, &r->particles);
    r->body->fill_end[index] = r->body->start.count;
    return status;
}

static pdyn_status read_inlet(struct reader *r, const struct json_at *at, int index) {
    return inlet_read(at, r->body->radius, &r->body->inlet[index]);
}

/* Reads the number of particles that inlets may add. Default: all that they emit, and at least 1,
 * because the scene may end before an inlet starts. */
static pdyn_status read_budget(struct reader *r, const struct json_at *owner,
                               const struct json_at *inlets) {
    struct scene_body *body = r->body;
    struct json_at at = json_member(owner, "budget");
    double total = 0.0, end = r->scene->settings.duration;
    for (int k = 0; k < body->inlets; k++)
        total +=
            inlet_layers(&body->inlet[k], end, 2.0 * body->radius) * body->inlet[k].layer.count;
    if (body->inlets) total = fmax(total, 1.0);
    if (at.value && !body->inlets) return json_fail_at_key(&at, "\"budget\" needs \"inlets\"");
    pdyn_status status =
        fill_count(at.value ? &at : inlets, at.value ? body->budget : total, &r->particles);
    if (status == PDYN_OK && !at.value) body->budget = (int)total;
    return status;
}

static pdyn_status read_inlets(struct reader *r, const struct json_at *owner) {
    struct scene_body *body = r->body;
    struct json_at array = json_member(owner, "inlets");
    pdyn_status status = reader_array(r, &array, "an array of inlets", read_inlet,
                                      sizeof *body->inlet, &body->inlet, &body->inlets);
    return status == PDYN_OK ? read_budget(r, owner, &array) : status;
}

static pdyn_status read_overlap(struct reader *r, const struct json_at *owner) {
    static const char *const names[] = {"remove", "keep"};
    struct json_at at = json_member(owner, "overlap");
    int keep = 0;
    if (!at.value) return PDYN_OK;
    pdyn_status status = reader_choice(&at, "overlap", names, 2, &keep);
    r->body->keep_overlap = keep;
    return status;
}

static pdyn_status read_particles(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"fill", "inlets", "overlap", NULL};
    struct scene_body *body = r->body;
    struct json_at fill = json_member(at, "fill"), inlets = json_member(at, "inlets");
    pdyn_status status = params_check_keys(at, particles_params, others);
    if (status == PDYN_OK) status = params_read(at, particles_params, NULL, body);
    if (status == PDYN_OK)
        status = reader_array(r, &fill, "an array of volumes to fill", read_fill,
                              sizeof *body->fill_end, &body->fill_end, &body->fills);
    if (status == PDYN_OK && !body->fills && !json_array_size(inlets.value))
        status = json_expected(&fill, "at least one volume to fill, or \"inlets\"");
    if (status == PDYN_OK) status = read_overlap(r, at);
    return status == PDYN_OK ? read_inlets(r, at) : status;
}

/* ---- surfaces and volumes -------------------------------------------------------------------- */

static pdyn_status read_grid(struct reader *r, const struct json_at *at, struct mesh *mesh) {
    static const char *const keys[] = {"size", "vertices", "sag", NULL};
    struct json_at size_at = json_member(at, "size"), vertices_at = json_member(at, "vertices");
    struct json_at sag_at = json_member(at, "sag");
    double size[2], sag = 0.0;
    int *vertices = r->body->grid;
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = params_reals(&size_at, 2, 1e-6, 1e6, "m", size);
    if (status == PDYN_OK && json_array_size(vertices_at.value) != 2)
        status = json_expected(&vertices_at, "an array of 2 whole numbers");
    for (size_t k = 0; k < 2 && status == PDYN_OK; k++) {
        struct json_at element = json_element(&vertices_at, k);
        status = params_int(&element, 2, MAX_PARTICLES, &vertices[k]);
    }
    if (status == PDYN_OK)
        status = fill_count(&vertices_at, (double)vertices[0] * vertices[1], &r->particles);
    if (status == PDYN_OK && sag_at.value) status = params_real(&sag_at, -1e6, 1e6, "m", &sag);
    if (status != PDYN_OK) return status;
    return json_wrap(at, mesh_grid(r->context, size, vertices, sag, mesh));
}

static const pdyn_param surface_params[] = {
    {"area_density", PDYN_REAL, offsetof(struct scene_body, area_density), true, 0, 1e-6, 1e6,
     "kg/m^2", ""},
    {"fluid_friction", PDYN_REAL, offsetof(struct scene_body, fluid_friction), false, 0, 0, 1e9,
     "Pa s/m", ""},
    {"permeability", PDYN_REAL, offsetof(struct scene_body, permeability), false, 0, 0, 1e6,
     "m/(Pa s)", ""},
    {0}};

static pdyn_status read_surface(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"grid", "mesh", "scale", "rotate", "translate", NULL};
    struct scene_body *body = r->body;
    struct json_at grid = json_member(at, "grid"), mesh = json_member(at, "mesh");
    static const char *const shapes[] = {"grid", "mesh"};
    struct transform transform;
    int shape;
    body->has_mesh = true;
    pdyn_status status = params_check_keys(at, surface_params, others);
    if (status == PDYN_OK) status = reader_one_of(at, shapes, 2, &shape);
    if (status == PDYN_OK) status = params_read(at, surface_params, NULL, body);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, &transform);
    if (status != PDYN_OK) return status;
    if (grid.value) status = read_grid(r, &grid, &body->mesh);
    else status = file_ref_mesh(&mesh, &body->mesh, &body->obj);
    if (status == PDYN_OK && mesh.value)
        status = fill_count(&mesh, body->mesh.vertices, &r->particles);
    if (status != PDYN_OK) return status;
    transform_points(&transform, body->mesh.vertex, body->mesh.vertices);
    status = mesh_check(r->context, &body->mesh, "as placed");
    if (status == PDYN_OK) status = mesh_check_cloth(r->context, &body->mesh, "as placed");
    return json_wrap(grid.value ? &grid : &mesh, status);
}

static const pdyn_param volume_params[] = {
    {"density", PDYN_REAL, offsetof(struct scene_body, density), true, 0, 1e-6, 1e6, "kg/m^3", ""},
    {"fluid_friction", PDYN_REAL, offsetof(struct scene_body, fluid_friction), false, 0, 0, 1e9,
     "Pa s/m", ""},
    {0}};

static pdyn_status read_tet_grid(struct reader *r, const struct json_at *at) {
    static const char *const keys[] = {"size", "cells", NULL};
    struct json_at size_at = json_member(at, "size"), cells_at = json_member(at, "cells");
    double size[3], vertices = 1.0;
    int cells[3];
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = params_reals(&size_at, 3, 1e-6, 1e6, "m", size);
    if (status == PDYN_OK && json_array_size(cells_at.value) != 3)
        status = json_expected(&cells_at, "an array of 3 whole numbers");
    for (size_t k = 0; k < 3 && status == PDYN_OK; k++) {
        struct json_at element = json_element(&cells_at, k);
        status = params_int(&element, 1, MAX_PARTICLES, &cells[k]);
        vertices *= 1.0 + cells[k];
    }
    if (status == PDYN_OK) status = fill_count(&cells_at, vertices, &r->particles);
    if (status == PDYN_OK && vertices > MAX_PARTICLES / 16)
        status = json_fail(&cells_at, "more than %d vertices", MAX_PARTICLES / 16);
    if (status != PDYN_OK) return status;
    return json_wrap(at, tets_grid(r->context, size, cells, &r->body->mesh, &r->body->tets));
}

static pdyn_status read_tet_mesh(struct reader *r, const struct json_at *at) {
    pdyn_status status = file_ref_tets(at, &r->body->mesh, &r->body->tets);
    return status == PDYN_OK ? fill_count(at, r->body->mesh.vertices, &r->particles) : status;
}

/* Places tetrahedra. */
static pdyn_status place_tets(struct reader *r, const struct json_at *at,
                              const struct transform *transform) {
    struct scene_body *body = r->body;
    transform_points(transform, body->mesh.vertex, body->mesh.vertices);
    return json_wrap(at, tets_finish(r->context, "as placed", &body->mesh, &body->tets));
}

static pdyn_status read_volume(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"grid",   "mesh",      "cell", "scale",
                                         "rotate", "translate", NULL};
    struct scene_body *body = r->body;
    struct json_at grid = json_member(at, "grid"), mesh = json_member(at, "mesh");
    struct json_at cell = json_member(at, "cell");
    struct transform transform;
    int shape;
    body->has_mesh = true;
    pdyn_status status = params_check_keys(at, volume_params, others);
    if (status == PDYN_OK) status = reader_one_of(at, others, 2, &shape);
    if (status == PDYN_OK) status = params_read(at, volume_params, NULL, body);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, &transform);
    if (status == PDYN_OK && cell.value && grid.value)
        status = json_fail_at_key(&cell, "\"cell\" needs a \"mesh\"");
    if (status != PDYN_OK) return status;
    if (cell.value) {
        status = filled_mesh_read(&mesh, &cell, &transform, body);
        return status == PDYN_OK ? fill_count(&mesh, body->mesh.vertices, &r->particles) : status;
    }
    status = grid.value ? read_tet_grid(r, &grid) : read_tet_mesh(r, &mesh);
    return status == PDYN_OK ? place_tets(r, grid.value ? &grid : &mesh, &transform) : status;
}

/* ---- constraints ----------------------------------------------------------------------------- */

static pdyn_status find_type(const struct json_at *at, const pdyn_constraint_type **out) {
    const pdyn_context *context = at->file->context;
    const char *names[READER_NAMES];
    int count = 0;
    for (int k = 0; registry_constraint_at(context, k) && count < READER_NAMES; k++)
        names[count++] = registry_constraint_at(context, k)->name;
    if (!json_is_string(at->value)) return json_expected(at, "the name of a constraint");
    *out = registry_constraint(context, json_string_value(at->value));
    return *out ? PDYN_OK : reader_fail_word(at, "constraint", names, count);
}

/* Checks a surface that encloses a volume; turns its triangles and pieces to face the same way. */
static pdyn_status check_enclosing(struct reader *r, const struct json_at *at, const char *type) {
    const struct mesh *mesh = &r->body->mesh;
    char name[64];
    snprintf(name, sizeof name, "\"%.40s\"", type);
    pdyn_status status = mesh_check_closed(r->context, mesh, name);
    if (status == PDYN_OK) status = reader_orient_pieces(r);
    if (status == PDYN_OK) status = mesh_check_encloses(r->context, mesh, name);
    return status == PDYN_OK ? PDYN_OK : json_wrap(at, status);
}

/* Checks that a constraint of this type is allowed on the body. */
static pdyn_status check_type(struct reader *r, const struct json_at *at,
                              const struct scene_body *body, int index) {
    const pdyn_constraint_type *type = body->constraint[index].type;
    for (int k = 0; k < index; k++)
        if (body->constraint[k].type == type && !(type->flags & PDYN_SEVERAL))
            return json_fail(at, "a second \"%s\" constraint on body \"%s\"", type->name,
                             body->name);
    if (type->flags & PDYN_ON_SURFACE && !body->has_mesh)
        return json_fail(at, "\"%s\" works on a surface, found a body of particles", type->name);
    if (type->flags & PDYN_ON_CLOSED) {
        pdyn_status status = check_enclosing(r, at, type->name);
        if (status != PDYN_OK) return status;
    }
    if (type->flags & PDYN_ON_VOLUME && !body->tets.count)
        return json_fail(at, "\"%s\" works on a volume, found %s", type->name,
                         body->has_mesh ? "a surface" : "a body of particles");
    if (type->flags & PDYN_ON_PARTICLES && body->has_mesh)
        return json_fail(at, "\"%s\" works on a body of particles, found a surface", type->name);
    if (needs_neighbour_lists(type) && body->start.count > MAX_FLUID_PARTICLES - body->budget)
        return json_fail(at,
                         "\"%s\" works on at most %d particles, budgets of inlets included, found "
                         "%.0f",
                         type->name, MAX_FLUID_PARTICLES, (double)body->start.count + body->budget);
    if (needs_neighbour_lists(type) && r->listed && r->listed->radius != body->radius)
        return json_fail(at,
                         "all fluids need the same particle radius: that of body \"%s\" is %g m, "
                         "that of body \"%s\" %g m",
                         r->listed->name, r->listed->radius, body->name, body->radius);
    return PDYN_OK;
}

const pdyn_param scene_constraint_times[] = {
    {"from", PDYN_REAL, offsetof(struct scene_constraint, from), false, 0, 0, 1e9, "s", ""},
    {"until", PDYN_REAL, offsetof(struct scene_constraint, until), false, HUGE_VAL, 0, 1e9, "s",
     ""},
    {0}};

static pdyn_status read_times(const struct json_at *at, struct scene_constraint *constraint) {
    struct json_at from = json_member(at, "from"), until = json_member(at, "until");
    const pdyn_constraint_type *type = constraint->type;
    if (type->matrix_free && (from.value || until.value))
        return json_fail_at_key(from.value ? &from : &until,
                                "\"%s\" is matrix-free and acts all the time", type->name);
    pdyn_status status = params_read(at, scene_constraint_times, NULL, constraint);
    if (status == PDYN_OK && !(constraint->until > constraint->from))
        return json_fail(&until, "expected a time after %.10g s, found %.10g s", constraint->from,
                         constraint->until);
    return status;
}

static pdyn_status read_constraint(struct reader *r, const struct json_at *at, int index) {
    struct scene_body *body = r->body;
    struct scene_constraint *constraint = &body->constraint[index];
    struct json_at name = json_member(at, "type");
    const pdyn_constraint_type *type = NULL;
    if (!json_is_object(at->value)) return json_expected(at, "an object with a \"type\"");
    pdyn_status status = find_type(&name, &type);
    if (status != PDYN_OK) return status;
    constraint->type = type;
    status = check_type(r, &name, body, index);
    if (status == PDYN_OK) status = params_check_keys(at, type->params, registry_common_keys);
    if (status == PDYN_OK) status = params_check_alternatives(at, type->alternatives);
    if (status == PDYN_OK) status = read_times(at, constraint);
    if (status != PDYN_OK) return status;
    if (needs_neighbour_lists(type) && !r->listed) r->listed = body;
    constraint->params = context_array(r->context, type->params_size, 1);
    if (type->params_size && !constraint->params) return PDYN_NO_MEMORY;
    return keyed_read_params(at, body, constraint);
}

static pdyn_status read_constraints(struct reader *r, const struct json_at *array) {
    struct scene_body *body = r->body;
    return reader_array(r, array, "an array of constraints", read_constraint,
                        sizeof *body->constraint, &body->constraint, &body->constraints);
}

/* ---- a body ---------------------------------------------------------------------------------- */

static const pdyn_param body_params[] = {{"velocity", PDYN_VECTOR,
                                          offsetof(struct scene_body, velocity), false, 0, -1e6,
                                          1e6, "m/s", ""},
                                         {0}};

typedef pdyn_status read_kind_fn(struct reader *r, const struct json_at *at);

pdyn_status scene_read_body(struct reader *r, const struct json_at *at, int index) {
    static const char *const others[] = {"name",   "color", "particles",   "surface",
                                         "volume", "rigid", "constraints", NULL};
    static const char *const kinds[] = {"particles", "surface", "volume", "rigid"};
    static read_kind_fn *const readers[] = {read_particles, read_surface, read_volume,
                                            scene_read_rigid};
    int kind;
    struct scene_body *body = r->body = &r->scene->body[index];
    struct json_at constraints = json_member(at, "constraints");
    pdyn_status status = params_check_keys(at, body_params, others);
    if (status == PDYN_OK) status = reader_name(r, at, "body", index, &body->name);
    if (status == PDYN_OK) status = reader_color(at, body->color);
    if (status == PDYN_OK) status = reader_one_of(at, kinds, 4, &kind);
    if (status == PDYN_OK) status = params_read(at, body_params, NULL, body);
    if (status != PDYN_OK) return status;
    struct json_at body_at = json_member(at, kinds[kind]);
    status = readers[kind](r, &body_at);
    return status == PDYN_OK ? read_constraints(r, &constraints) : status;
}
