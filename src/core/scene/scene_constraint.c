/* Reading the constraints of a body. */
#include "base/registry.h"
#include "keyed.h"
#include "params.h"
#include "scene_body.h"

#include <math.h>
#include <stdio.h>

pdyn_status reader_constraint_type(const struct json_at *at, const pdyn_constraint_type **out) {
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

static const char *kind_of(const struct scene_body *body) {
    if (body->is_rigid) return "a rigid body";
    return body->has_mesh ? "a surface" : "a body of particles";
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
        return json_fail(at, "\"%s\" works on a surface, found %s", type->name, kind_of(body));
    if (type->flags & PDYN_ON_CLOSED) {
        pdyn_status status = check_enclosing(r, at, type->name);
        if (status != PDYN_OK) return status;
    }
    if (type->flags & PDYN_ON_VOLUME && !body->tets.count)
        return json_fail(at, "\"%s\" works on a volume, found %s", type->name, kind_of(body));
    if (type->flags & PDYN_ON_PARTICLES && body->has_mesh)
        return json_fail(at, "\"%s\" works on a body of particles, found %s", type->name,
                         body->tets.count ? "a volume" : kind_of(body));
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
    pdyn_status status = reader_constraint_type(&name, &type);
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

pdyn_status scene_read_constraints(struct reader *r, const struct json_at *array) {
    struct scene_body *body = r->body;
    return reader_array(r, array, "an array of constraints", read_constraint,
                        sizeof *body->constraint, &body->constraint, &body->constraints);
}
