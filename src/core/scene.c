#include "scene.h"

#include "accelerate.h"
#include "archive.h"
#include "fill.h"
#include "inlet.h"
#include "near.h"
#include "params.h"
#include "placed.h"
#include "registry.h"
#include "shape.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES = 64, HINT = 768 };

/* What is known while a scene is read. */
struct reader {
    pdyn_context *context;
    struct scene *scene;
    double particles;          /* so far, in all bodies */
    bool operator_used;        /* a body has a constraint with an operator of its own */
    struct scene_body *body;   /* being read */
    struct scene_solid *solid; /* being read */
};

typedef pdyn_status read_fn(struct reader *r, const struct json_at *at, int index);

/* ---- words ----------------------------------------------------------------------------------- */

static pdyn_status copy_text(pdyn_context *context, const char *text, char **out) {
    *out = NEW_ARRAY(context, strlen(text) + 1, char);
    if (!*out) return PDYN_NO_MEMORY;
    strcpy(*out, text);
    return PDYN_OK;
}

static void free_text(pdyn_context *context, char **text) {
    if (*text) FREE_ARRAY(context, *text, strlen(*text) + 1);
}

/* Fails with what is known instead of the word at `at`. */
static pdyn_status fail_word(const struct json_at *at, const char *what, const char *const *names,
                             int count) {
    char word[NAMES], hint[HINT] = "";
    text_clip(word, sizeof word, json_string_value(at->value));
    text_hint(hint, sizeof hint, word, names, count);
    return json_fail(at, "unknown %s \"%s\"%s", what, word, hint);
}

/* The index of the word among `names`; a missing word is the first. */
static pdyn_status read_choice(const struct json_at *at, const char *what, const char *const *names,
                               int count, int *out) {
    char expected[NAMES];
    *out = 0;
    if (!at->value) return PDYN_OK;
    snprintf(expected, sizeof expected, "the name of a %s", what);
    if (!json_is_string(at->value)) return json_expected(at, expected);
    for (int k = 0; k < count; k++)
        if (!strcmp(json_string_value(at->value), names[k])) return *out = k, PDYN_OK;
    return fail_word(at, what, names, count);
}

static bool is_name(const char *text) {
    size_t length = strlen(text);
    return length >= 1 && length <= 64 &&
           length ==
               strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-");
}

static bool is_taken(const struct scene *scene, const char *name) {
    for (int b = 0; b < scene->bodies; b++)
        if (scene->body[b].name && !strcmp(scene->body[b].name, name)) return true;
    for (int s = 0; s < scene->solids; s++)
        if (scene->solid[s].name && !strcmp(scene->solid[s].name, name)) return true;
    return false;
}

/* The name of a body or solid; without one, its kind and index. */
static pdyn_status read_name(struct reader *r, const struct json_at *owner, const char *kind,
                             int index, char **out) {
    char number[NAMES];
    struct json_at at = json_member(owner, "name");
    const char *name = json_string_value(at.value);
    snprintf(number, sizeof number, "%s%d", kind, index);
    if (!at.value) name = number;
    else if (!name || !is_name(name))
        return json_expected(&at, "a name of 1 to 64 letters, digits, '_' and '-'");
    if (!strcmp(name, "boundary"))
        return json_fail(&at, "the name \"boundary\" is reserved for the files of the solids");
    if (is_taken(r->scene, name))
        return json_fail(&at, "the name \"%s\" is already taken by another body or solid", name);
    return copy_text(r->context, name, out);
}

/* Exactly one of these keys: its index. */
static pdyn_status read_one_of(const struct json_at *at, const char *const *names, int count,
                               int *out) {
    char list[HINT] = "";
    int found = 0;
    for (int k = 0; k < count; k++) {
        size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s\"%s\"",
                 k == 0           ? ""
                 : k + 1 == count ? " and "
                                  : ", ",
                 names[k]);
        if (json_object_get(at->value, names[k])) *out = k, found++;
    }
    if (found == 1) return PDYN_OK;
    const char *none = count == 2 ? "neither" : "none", *more = count == 2 ? "both" : "more";
    return json_fail(at, "expected exactly one of %s, found %s", list, found ? more : none);
}

/* Calls `read` for every element of an array; a missing array has none. */
static pdyn_status read_each(struct reader *r, const struct json_at *array, read_fn *read) {
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < json_array_size(array->value) && status == PDYN_OK; k++) {
        struct json_at element = json_element(array, k);
        status = read(r, &element, (int)k);
    }
    return status;
}

/* The length of an array that may be missing. */
static pdyn_status read_count(const struct json_at *array, const char *what, int *out) {
    *out = 0;
    if (array->value && !json_is_array(array->value)) return json_expected(array, what);
    if (json_array_size(array->value) > MOST_PARTICLES)
        return json_fail(array, "more than %d elements", MOST_PARTICLES);
    *out = (int)json_array_size(array->value);
    return PDYN_OK;
}

/* ---- settings -------------------------------------------------------------------------------- */

static pdyn_status read_general(struct reader *r, const struct json_at *root) {
    struct scene_settings *set = &r->scene->settings;
    struct json_at name = json_member(root, "name"), gravity = json_member(root, "gravity");
    struct json_at schema = json_member(root, "$schema");
    if (name.value && !json_is_string(name.value)) return json_expected(&name, "a text");
    if (schema.value && !json_is_string(schema.value)) return json_expected(&schema, "a text");
    pdyn_status status =
        copy_text(r->context, name.value ? json_string_value(name.value) : "", &r->scene->name);
    if (status == PDYN_OK) status = params_read(root, settings_general_params, NULL, set);
    set->gravity[1] = -9.81;
    if (status == PDYN_OK && gravity.value)
        status = params_reals(&gravity, 3, -1e6, 1e6, "m/s^2", set->gravity);
    return status;
}

static pdyn_status read_time_step(struct reader *r, const struct json_at *at) {
    static const char *const none[] = {NULL}, *const excluded[] = {"maximum", "minimum", "cfl"};
    struct scene_settings *set = &r->scene->settings;
    pdyn_status status =
        at->value ? params_check_keys(at, settings_time_step_params, none) : PDYN_OK;
    if (status == PDYN_OK) status = params_read(at, settings_time_step_params, NULL, set);
    if (status != PDYN_OK) return status;
    for (int k = 0; set->h_fixed > 0.0 && k < 3; k++) {
        struct json_at other = json_member(at, excluded[k]);
        if (other.value)
            return json_fail_at_key(&other, "\"%s\" has no meaning beside \"fixed\"", excluded[k]);
    }
    if (set->h_fixed > 0.0 || set->h_min <= set->h_max) return PDYN_OK;
    return json_fail(at, "expected a minimum of at most the maximum, found %.10g and %.10g s",
                     set->h_min, set->h_max);
}

static pdyn_status read_acceleration(const struct json_at *solver, struct scene_settings *set) {
    const char *names[NAMES];
    struct json_at at = json_member(solver, "acceleration");
    int chosen = 0;
    for (int k = 0; k < acceleration_count; k++) names[k] = accelerations[k].name;
    pdyn_status status = read_choice(&at, "acceleration", names, acceleration_count, &chosen);
    set->acceleration = &accelerations[chosen];
    if (status == PDYN_OK && chosen && set->newton)
        return json_fail(&at, "only \"step\": \"projective\" is accelerated, found \"newton\"");
    return status;
}

static pdyn_status read_solver(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"type", "step", "acceleration", NULL}, *const steps[] = {
                                                                                    "newton",
                                                                                    "projective"};
    const char *types[NAMES] = {"auto"};
    struct json_at type = json_member(at, "type"), step = json_member(at, "step");
    struct scene_settings *set = &r->scene->settings;
    int count = 1, chosen_type = 0, chosen_step = 0;
    for (int k = 0; registry_solver_at(r->context, k) && count < NAMES; k++)
        types[count++] = registry_solver_at(r->context, k)->name;
    pdyn_status status =
        at->value ? params_check_keys(at, settings_solver_params, others) : PDYN_OK;
    if (status == PDYN_OK) status = params_read(at, settings_solver_params, NULL, set);
    if (status == PDYN_OK) status = read_choice(&type, "solver", types, count, &chosen_type);
    if (status == PDYN_OK) status = read_choice(&step, "step", steps, 2, &chosen_step);
    set->newton = chosen_step == 0;
    snprintf(set->solver_type, sizeof set->solver_type, "%s", types[chosen_type]);
    return status == PDYN_OK ? read_acceleration(at, set) : status;
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static const pdyn_param body_params[] = {{"velocity", PDYN_VECTOR,
                                          offsetof(struct scene_body, velocity), false, 0, -1e6,
                                          1e6, "m/s", ""},
                                         {0}};

static const pdyn_param particles_params[] = {
    {"radius", PDYN_REAL, offsetof(struct scene_body, radius), true, 0, 1e-6, 1e3, "m", ""},
    {"rest_density", PDYN_REAL, offsetof(struct scene_body, rest_density), false, 1000, 1e-3, 1e6,
     "kg/m^3", ""},
    {"budget", PDYN_INT, offsetof(struct scene_body, budget), false, 0, 1, MOST_PARTICLES, "", ""},
    {0}};

static const pdyn_param surface_params[] = {
    {"area_density", PDYN_REAL, offsetof(struct scene_body, area_density), true, 0, 1e-6, 1e6,
     "kg/m^2", ""},
    {"fluid_friction", PDYN_REAL, offsetof(struct scene_body, fluid_friction), false, 0, 0, 1e9,
     "Pa s/m", ""},
    {0}};

static pdyn_status read_fill(struct reader *r, const struct json_at *at, int index) {
    (void)index;
    return fill_read(at, r->body, &r->particles);
}

static pdyn_status read_inlet(struct reader *r, const struct json_at *at, int index) {
    return inlet_read(at, r->body->radius, r->scene->settings.duration, &r->body->inlet[index]);
}

/* Without a budget there is room for all that the inlets emit; for one particle at least, as the
 * scene may end before. */
static pdyn_status read_budget(struct reader *r, const struct json_at *owner,
                               const struct json_at *inlets) {
    struct scene_body *body = r->body;
    struct json_at at = json_member(owner, "budget");
    double total = 0.0;
    for (int k = 0; k < body->inlets; k++) total += inlet_total(&body->inlet[k]);
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
    int count;
    pdyn_status status = read_count(&array, "an array of inlets", &count);
    if (status == PDYN_OK && count) {
        body->inlet = NEW_ARRAY(r->context, count, struct scene_inlet);
        if (!body->inlet) return PDYN_NO_MEMORY;
        body->inlets = count;
        status = read_each(r, &array, read_inlet);
    }
    return status == PDYN_OK ? read_budget(r, owner, &array) : status;
}

static pdyn_status read_particles(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"fill", "inlets", NULL};
    struct scene_body *body = r->body;
    struct json_at fill = json_member(at, "fill"), inlets = json_member(at, "inlets");
    int fills = 0;
    pdyn_status status = params_check_keys(at, particles_params, others);
    if (status == PDYN_OK) status = params_read(at, particles_params, NULL, body);
    if (status == PDYN_OK) status = read_count(&fill, "an array of volumes to fill", &fills);
    if (status == PDYN_OK && !fills && !json_array_size(inlets.value))
        status = json_expected(&fill, "at least one volume to fill, or \"inlets\"");
    if (status == PDYN_OK) status = read_each(r, &fill, read_fill);
    return status == PDYN_OK ? read_inlets(r, at) : status;
}

static pdyn_status read_grid(struct reader *r, const struct json_at *at, struct mesh *mesh) {
    static const char *const keys[] = {"size", "vertices", "sag", NULL};
    struct json_at size_at = json_member(at, "size"), vertices_at = json_member(at, "vertices");
    struct json_at sag_at = json_member(at, "sag");
    double size[2], sag = 0.0;
    int vertices[2];
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = params_reals(&size_at, 2, 1e-6, 1e6, "m", size);
    if (status == PDYN_OK && json_array_size(vertices_at.value) != 2)
        status = json_expected(&vertices_at, "an array of 2 whole numbers");
    for (size_t k = 0; k < 2 && status == PDYN_OK; k++) {
        struct json_at element = json_element(&vertices_at, k);
        status = params_int(&element, 2, MOST_PARTICLES, &vertices[k]);
    }
    if (status == PDYN_OK)
        status = fill_count(&vertices_at, (double)vertices[0] * vertices[1], &r->particles);
    if (status == PDYN_OK && sag_at.value) status = params_real(&sag_at, -1e6, 1e6, "m", &sag);
    if (status != PDYN_OK) return status;
    return json_wrap(at, mesh_grid(r->context, size, vertices, sag, mesh));
}

static pdyn_status read_surface(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"grid", "mesh", "scale", "rotate", "translate", NULL};
    struct scene_body *body = r->body;
    struct json_at grid = json_member(at, "grid"), mesh = json_member(at, "mesh");
    static const char *const shapes[] = {"grid", "mesh"};
    struct transform transform;
    int shape;
    body->is_surface = true;
    pdyn_status status = params_check_keys(at, surface_params, others);
    if (status == PDYN_OK) status = read_one_of(at, shapes, 2, &shape);
    if (status == PDYN_OK) status = params_read(at, surface_params, NULL, body);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, &transform);
    if (status != PDYN_OK) return status;
    if (grid.value) status = read_grid(r, &grid, &body->mesh);
    else status = placed_mesh(&mesh, &body->mesh);
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
        status = params_int(&element, 1, MOST_PARTICLES, &cells[k]);
        vertices *= 1.0 + cells[k];
    }
    if (status == PDYN_OK) status = fill_count(&cells_at, vertices, &r->particles);
    if (status == PDYN_OK && vertices > MOST_PARTICLES / 16)
        status = json_fail(&cells_at, "more than %d vertices", MOST_PARTICLES / 16);
    if (status != PDYN_OK) return status;
    return json_wrap(at, tets_grid(r->context, size, cells, &r->body->mesh, &r->body->tets));
}

static pdyn_status read_tet_mesh(struct reader *r, const struct json_at *at) {
    char *path = NULL;
    size_t size = 0;
    pdyn_status status =
        placed_path(at, "the name of a mesh of tetrahedra, .node, .ele or .msh", &path, &size);
    if (status != PDYN_OK) return status;
    status = json_wrap(at, tets_read(r->context, path, &r->body->mesh, &r->body->tets));
    FREE_ARRAY(r->context, path, size);
    return status == PDYN_OK ? fill_count(at, r->body->mesh.vertices, &r->particles) : status;
}

static pdyn_status read_volume(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"grid", "mesh", "scale", "rotate", "translate", NULL};
    struct scene_body *body = r->body;
    struct json_at grid = json_member(at, "grid"), mesh = json_member(at, "mesh");
    struct transform transform;
    int shape;
    body->is_surface = true;
    pdyn_status status = params_check_keys(at, volume_params, others);
    if (status == PDYN_OK) status = read_one_of(at, others, 2, &shape);
    if (status == PDYN_OK) status = params_read(at, volume_params, NULL, body);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, &transform);
    if (status == PDYN_OK) status = grid.value ? read_tet_grid(r, &grid) : read_tet_mesh(r, &mesh);
    if (status != PDYN_OK) return status;
    transform_points(&transform, body->mesh.vertex, body->mesh.vertices);
    return json_wrap(grid.value ? &grid : &mesh,
                     tets_finish(r->context, "as placed", &body->mesh, &body->tets));
}

/* ---- constraints ----------------------------------------------------------------------------- */

static pdyn_status find_type(const struct json_at *at, const pdyn_constraint_type **out) {
    const pdyn_context *context = at->file->context;
    const char *names[NAMES];
    int count = 0;
    for (int k = 0; registry_constraint_at(context, k) && count < NAMES; k++)
        names[count++] = registry_constraint_at(context, k)->name;
    if (!json_is_string(at->value)) return json_expected(at, "the name of a constraint");
    *out = registry_constraint(context, json_string_value(at->value));
    return *out ? PDYN_OK : fail_word(at, "constraint", names, count);
}

/* Whether this body may have a constraint of this type. */
static pdyn_status check_type(const struct reader *r, const struct json_at *at,
                              const struct scene_body *body, int index) {
    const pdyn_constraint_type *type = body->constraint[index].type;
    for (int k = 0; k < index; k++)
        if (body->constraint[k].type == type && !(type->flags & PDYN_SEVERAL))
            return json_fail(at, "a second \"%s\" constraint on body \"%s\"", type->name,
                             body->name);
    if (type->flags & PDYN_ON_SURFACE && !body->is_surface)
        return json_fail(at, "\"%s\" works on a surface, found a body of particles", type->name);
    if (type->flags & PDYN_ON_VOLUME && !body->tets.count)
        return json_fail(at, "\"%s\" works on a volume, found %s", type->name,
                         body->is_surface ? "a surface" : "a body of particles");
    if (type->flags & PDYN_ON_PARTICLES && body->is_surface)
        return json_fail(at, "\"%s\" works on a body of particles, found a surface", type->name);
    if (type->op && r->operator_used)
        return json_fail(
            at, "only one body may have a \"%s\" constraint; put all volumes into its \"fill\"",
            type->name);
    return PDYN_OK;
}

static pdyn_status read_constraint(struct reader *r, const struct json_at *at, int index) {
    static const char *const others[] = {"type", NULL};
    struct scene_body *body = r->body;
    struct scene_constraint *constraint = &body->constraint[index];
    struct json_at name = json_member(at, "type");
    const pdyn_constraint_type *type = NULL;
    if (!json_is_object(at->value)) return json_expected(at, "an object");
    pdyn_status status = find_type(&name, &type);
    if (status != PDYN_OK) return status;
    constraint->type = type;
    status = check_type(r, &name, body, index);
    if (status == PDYN_OK) status = params_check_keys(at, type->params, others);
    if (status != PDYN_OK) return status;
    r->operator_used |= type->op != NULL;
    constraint->params = context_array(r->context, type->params_size, 1);
    if (type->params_size && !constraint->params) return PDYN_NO_MEMORY;
    return params_read(at, type->params, body->is_surface ? &body->mesh : NULL, constraint->params);
}

static pdyn_status read_constraints(struct reader *r, const struct json_at *array) {
    struct scene_body *body = r->body;
    int count;
    pdyn_status status = read_count(array, "an array of constraints", &count);
    if (status != PDYN_OK || !count) return status;
    body->constraint = NEW_ARRAY(r->context, count, struct scene_constraint);
    if (!body->constraint) return PDYN_NO_MEMORY;
    body->constraints = count;
    return read_each(r, array, read_constraint);
}

typedef pdyn_status read_kind_fn(struct reader *r, const struct json_at *at);

static pdyn_status read_body(struct reader *r, const struct json_at *at, int index) {
    static const char *const others[] = {"name",   "particles",   "surface",
                                         "volume", "constraints", NULL};
    static const char *const kinds[] = {"particles", "surface", "volume"};
    static read_kind_fn *const readers[] = {read_particles, read_surface, read_volume};
    int kind;
    struct scene_body *body = r->body = &r->scene->body[index];
    struct json_at constraints = json_member(at, "constraints");
    pdyn_status status = params_check_keys(at, body_params, others);
    if (status == PDYN_OK) status = read_name(r, at, "body", index, &body->name);
    if (status == PDYN_OK) status = read_one_of(at, kinds, 3, &kind);
    if (status == PDYN_OK) status = params_read(at, body_params, NULL, body);
    if (status != PDYN_OK) return status;
    struct json_at body_at = json_member(at, kinds[kind]);
    status = readers[kind](r, &body_at);
    return status == PDYN_OK ? read_constraints(r, &constraints) : status;
}

/* ---- solids ---------------------------------------------------------------------------------- */

static pdyn_status read_open_side(struct reader *r, const struct json_at *at, int index) {
    static const char *const sides[] = {"-x", "+x", "-y", "+y", "-z", "+z"};
    struct scene_solid *solid = r->solid;
    int side;
    (void)index;
    pdyn_status status = read_choice(at, "side", sides, 6, &side);
    if (status == PDYN_OK && solid->open >> side & 1u)
        status = json_fail(at, "the side \"%s\" stands here twice", sides[side]);
    if (status == PDYN_OK) solid->open |= 1u << side;
    return status;
}

static pdyn_status read_walls(struct reader *r, const struct json_at *owner,
                              const struct json_at *box) {
    struct json_at open = json_member(owner, "open");
    int sides;
    struct scene_box *walls = &r->solid->box;
    r->solid->is_box = true;
    pdyn_status status = params_box(box, walls);
    for (int a = 0; a < 3; a++) r->solid->pivot[a] = 0.5 * (walls->min[a] + walls->max[a]);
    if (status == PDYN_OK) status = read_count(&open, "an array of sides like \"+y\"", &sides);
    if (status == PDYN_OK) status = read_each(r, &open, read_open_side);
    if (status == PDYN_OK && r->solid->open == 0x3F)
        status = json_fail(&open, "all six sides are open: no wall is left");
    if (status != PDYN_OK) return status;
    return shape_box(r->context, walls, r->solid->open, &r->solid->mesh);
}

static pdyn_status read_placed(struct reader *r, const struct json_at *owner,
                               const struct json_at *mesh) {
    struct transform transform;
    pdyn_status status = transform_read(owner, -1e6, &transform);
    if (status == PDYN_OK) status = placed_mesh(mesh, &r->solid->mesh);
    if (status != PDYN_OK) return status;
    transform_points(&transform, r->solid->mesh.vertex, r->solid->mesh.vertices);
    memcpy(r->solid->pivot, transform.translate, sizeof transform.translate);
    return json_wrap(mesh, mesh_check(r->context, &r->solid->mesh, "as placed"));
}

static pdyn_status read_sphere(struct reader *r, const struct json_at *owner,
                               const struct json_at *sphere) {
    (void)owner;
    return shape_read_sphere(sphere, &r->solid->mesh, r->solid->pivot);
}

static pdyn_status read_capsule(struct reader *r, const struct json_at *owner,
                                const struct json_at *capsule) {
    (void)owner;
    return shape_read_capsule(capsule, &r->solid->mesh, r->solid->pivot);
}

static pdyn_status read_plane(struct reader *r, const struct json_at *owner,
                              const struct json_at *plane) {
    (void)owner;
    return shape_read_plane(plane, &r->solid->mesh, r->solid->pivot);
}

enum { SHAPES = 5, BOX = 0, MESH = 1 };
static const char *const shape_names[SHAPES] = {"box", "mesh", "sphere", "capsule", "plane"};
static pdyn_status (*const shape_readers[SHAPES])(struct reader *r, const struct json_at *owner,
                                                  const struct json_at *shape) = {
    read_walls, read_placed, read_sphere, read_capsule, read_plane};

static pdyn_status read_shape(struct reader *r, const struct json_at *owner) {
    struct json_at open = json_member(owner, "open");
    int kind;
    pdyn_status status = read_one_of(owner, shape_names, SHAPES, &kind);
    if (status == PDYN_OK && kind != BOX && open.value)
        status = json_fail_at_key(&open, "\"open\" needs a \"box\"");
    if (status == PDYN_OK && kind != MESH) status = transform_refuse(owner, "a \"mesh\"");
    if (status != PDYN_OK) return status;
    struct json_at shape = json_member(owner, shape_names[kind]);
    return shape_readers[kind](r, owner, &shape);
}

const pdyn_param scene_key_params[] = {
    {"time", PDYN_REAL, offsetof(struct scene_key, time), true, 0, -1e6, 1e6, "s", ""},
    {"translate", PDYN_VECTOR, offsetof(struct scene_key, translate), false, 0, -1e6, 1e6, "m", ""},
    {"rotate", PDYN_VECTOR, offsetof(struct scene_key, rotate), false, 0, -1e6, 1e6, "degrees", ""},
    {0}};

static pdyn_status read_key(struct reader *r, const struct json_at *at, int index) {
    static const char *const none[] = {NULL};
    struct scene_key *key = &r->solid->key[index];
    struct json_at time = json_member(at, "time");
    pdyn_status status = params_check_keys(at, scene_key_params, none);
    if (status == PDYN_OK) status = params_read(at, scene_key_params, NULL, key);
    if (status != PDYN_OK || !index || key->time > key[-1].time) return status;
    return json_fail(&time, "expected a time after %.10g s, found %.10g s", key[-1].time,
                     key->time);
}

static pdyn_status read_motion(struct reader *r, const struct json_at *owner) {
    struct scene_solid *solid = r->solid;
    struct json_at motion = json_member(owner, "motion"), pivot = json_member(owner, "pivot");
    int count;
    if (!motion.value && pivot.value)
        return json_fail_at_key(&pivot, "\"pivot\" needs a \"motion\"");
    pdyn_status status = read_count(&motion, "an array of keys", &count);
    if (status != PDYN_OK || !motion.value) return status;
    if (!count) return json_expected(&motion, "at least one key");
    if (pivot.value) status = params_reals(&pivot, 3, -1e6, 1e6, "m", solid->pivot);
    if (status != PDYN_OK) return status;
    solid->key = NEW_ARRAY(r->context, count, struct scene_key);
    if (!solid->key) return PDYN_NO_MEMORY;
    solid->keys = count;
    return read_each(r, &motion, read_key);
}

static pdyn_status read_solid(struct reader *r, const struct json_at *at, int index) {
    static const char *const keys[] = {"name",   "box",   "mesh",  "sphere", "capsule",
                                       "plane",  "open",  "scale", "rotate", "translate",
                                       "motion", "pivot", NULL};
    r->solid = &r->scene->solid[index];
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = read_name(r, at, "solid", index, &r->solid->name);
    if (status == PDYN_OK) status = read_shape(r, at);
    return status == PDYN_OK ? read_motion(r, at) : status;
}

/* ---- the scene ------------------------------------------------------------------------------- */

static pdyn_status read_bodies(struct reader *r, const struct json_at *array) {
    int count;
    pdyn_status status = read_count(array, "an array of bodies", &count);
    if (status == PDYN_OK && !count) status = json_expected(array, "at least one body");
    if (status != PDYN_OK) return status;
    r->scene->body = NEW_ARRAY(r->context, count, struct scene_body);
    if (!r->scene->body) return PDYN_NO_MEMORY;
    r->scene->bodies = count;
    return read_each(r, array, read_body);
}

static pdyn_status read_solids(struct reader *r, const struct json_at *array) {
    int count;
    pdyn_status status = read_count(array, "an array of solids", &count);
    if (status != PDYN_OK || !count) return status;
    r->scene->solid = NEW_ARRAY(r->context, count, struct scene_solid);
    if (!r->scene->solid) return PDYN_NO_MEMORY;
    r->scene->solids = count;
    return read_each(r, array, read_solid);
}

static pdyn_status read_outlet(struct reader *r, const struct json_at *at, int index) {
    return outlet_read(at, &r->scene->outlet[index]);
}

static pdyn_status read_outlets(struct reader *r, const struct json_at *array) {
    int count;
    pdyn_status status = read_count(array, "an array of outlets", &count);
    if (status != PDYN_OK || !count) return status;
    r->scene->outlet = NEW_ARRAY(r->context, count, struct scene_outlet);
    if (!r->scene->outlet) return PDYN_NO_MEMORY;
    r->scene->outlets = count;
    return read_each(r, array, read_outlet);
}

const pdyn_param scene_contact_params[] = {
    {"thickness", PDYN_REAL, offsetof(struct scene_contact, thickness), true, 0, 1e-9, 1e3, "m",
     ""},
    {"friction", PDYN_REAL, offsetof(struct scene_contact, friction), false, 0.3, 0, 100, "1", ""},
    {"stiffness", PDYN_REAL, offsetof(struct scene_contact, stiffness), false, 1000, 1e-9, 1e15,
     "N/m", ""},
    {"self", PDYN_BOOL, offsetof(struct scene_contact, self), false, 1, 0, 0, "", ""},
    {0}};

static pdyn_status read_contact(struct reader *r, const struct json_at *at) {
    static const char *const none[] = {NULL};
    bool surface = false;
    if (!at->value) return PDYN_OK;
    for (int b = 0; b < r->scene->bodies; b++) surface |= r->scene->body[b].is_surface;
    if (!surface) return json_fail_at_key(at, "\"contact\" needs a body with a surface");
    r->scene->has_contact = true;
    pdyn_status status = params_check_keys(at, scene_contact_params, none);
    return status == PDYN_OK ? params_read(at, scene_contact_params, NULL, &r->scene->contact)
                             : status;
}

static pdyn_status read_plugin(struct reader *r, const struct json_at *at, int index) {
    char *path = NULL;
    size_t size = 0;
    (void)index;
    pdyn_status status = placed_path(at, "the name of a plug-in's shared object", &path, &size);
    if (status != PDYN_OK) return status;
    status = json_wrap(at, pdyn_load_plugin(r->context, path));
    FREE_ARRAY(r->context, path, size);
    return status;
}

static pdyn_status read_plugins(struct reader *r, const struct json_at *array) {
    int count;
    pdyn_status status = read_count(array, "an array of plug-ins", &count);
    return status == PDYN_OK ? read_each(r, array, read_plugin) : status;
}

static pdyn_status read_all(struct reader *r, const struct json_at *root) {
    static const char *const others[] = {"$schema", "name",    "gravity", "time_step",
                                         "solver",  "bodies",  "solids",  "outlets",
                                         "contact", "plugins", NULL};
    struct json_at time_step = json_member(root, "time_step"), solver = json_member(root, "solver");
    struct json_at bodies = json_member(root, "bodies"), solids = json_member(root, "solids");
    struct json_at outlets = json_member(root, "outlets"), contact = json_member(root, "contact");
    struct json_at plugins = json_member(root, "plugins");
    pdyn_status status = params_check_keys(root, settings_general_params, others);
    if (status == PDYN_OK) status = read_general(r, root);
    if (status == PDYN_OK) status = read_plugins(r, &plugins);
    if (status == PDYN_OK) status = read_time_step(r, &time_step);
    if (status == PDYN_OK) status = read_solver(r, &solver);
    if (status == PDYN_OK) status = read_bodies(r, &bodies);
    if (status == PDYN_OK) status = read_solids(r, &solids);
    if (status == PDYN_OK) status = read_outlets(r, &outlets);
    if (status == PDYN_OK) status = read_contact(r, &contact);
    return status;
}

static pdyn_status take_fingerprint(struct reader *r, const json_t *root) {
    static const char *const free_keys[] = {"$schema", "name", "duration"};
    json_t *values = json_copy((json_t *)root);
    for (size_t k = 0; values && k < sizeof free_keys / sizeof *free_keys; k++)
        json_object_del(values, free_keys[k]);
    char *dump = values ? json_dumps(values, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
    json_decref(values);
    if (!dump) return context_no_memory(r->context);
    r->scene->fingerprint = hash_bytes(HASH_BEGIN, dump, strlen(dump));
    free(dump);
    return PDYN_OK;
}

static pdyn_status read_file(struct reader *r, const char *text, const char *const *set, int sets) {
    struct json_file file;
    pdyn_status status = json_file_open(r->context, r->scene->file, text, set, sets, &file);
    if (status != PDYN_OK) return status;
    struct json_at root = json_root(&file);
    status = read_all(r, &root);
    if (status == PDYN_OK) status = take_fingerprint(r, root.value);
    json_file_close(&file);
    return status;
}

pdyn_status scene_read(pdyn_context *context, const char *path, const char *text,
                       const char *const *set, int sets, struct scene *out) {
    struct reader reader = {.context = context, .scene = out};
    struct text_locale locale;
    *out = (struct scene){0};
    if (!text_begin(&locale)) return context_no_memory(context);
    pdyn_status status = copy_text(context, path, &out->file);
    if (status == PDYN_OK) status = read_file(&reader, text, set, sets);
    if (status != PDYN_OK) scene_free(context, out);
    text_end(&locale);
    return status;
}

static void free_body(pdyn_context *context, struct scene_body *body) {
    for (int k = 0; k < body->constraints; k++) {
        struct scene_constraint *constraint = &body->constraint[k];
        if (!constraint->params) continue;
        params_free(context, constraint->type->params, constraint->params);
        context_resize(context, constraint->params, constraint->type->params_size, 0);
    }
    FREE_ARRAY(context, body->constraint, body->constraints);
    for (int k = 0; k < body->inlets; k++) points_free(context, &body->inlet[k].layer);
    FREE_ARRAY(context, body->inlet, body->inlets);
    points_free(context, &body->start);
    points_free(context, &body->start_v);
    mesh_free(context, &body->mesh);
    tets_free(context, &body->tets);
    free_text(context, &body->name);
}

void scene_free(pdyn_context *context, struct scene *scene) {
    for (int b = 0; b < scene->bodies; b++) free_body(context, &scene->body[b]);
    for (int s = 0; s < scene->solids; s++) {
        mesh_free(context, &scene->solid[s].mesh);
        FREE_ARRAY(context, scene->solid[s].key, scene->solid[s].keys);
        free_text(context, &scene->solid[s].name);
    }
    FREE_ARRAY(context, scene->body, scene->bodies);
    FREE_ARRAY(context, scene->solid, scene->solids);
    FREE_ARRAY(context, scene->outlet, scene->outlets);
    free_text(context, &scene->file);
    free_text(context, &scene->name);
    *scene = (struct scene){0};
}
