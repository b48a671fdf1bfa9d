/* Reading a scene: its parts, references between bodies, derived parameters; freeing it. */
#include "base/text.h"
#include "contact_stiffness.h"
#include "derived.h"
#include "file_ref.h"
#include "fingerprint.h"
#include "inlet.h"
#include "inlet_cover.h"
#include "keyed.h"
#include "motion.h"
#include "overlap.h"
#include "params.h"
#include "reader.h"
#include "vessel.h"

#include <string.h>

/* ---- references to other bodies -------------------------------------------------------------- */

/* Checks that `name` is another body with a surface. */
static pdyn_status check_other(const struct reader *r, const struct json_at *at, int self,
                               const char *name) {
    const char *names[READER_NAMES];
    int count = 0;
    for (int b = 0; b < r->scene->bodies; b++) {
        const struct scene_body *body = &r->scene->body[b];
        bool fits = b != self && body->has_mesh;
        if (fits && !strcmp(body->name, name)) return PDYN_OK;
        if (!strcmp(body->name, name))
            return json_fail(at, "expected another body that has a surface, found %s",
                             b == self ? "this body" : "a body of particles");
        if (fits && count < READER_NAMES) names[count++] = body->name;
    }
    for (int k = 0; k < r->scene->solids; k++)
        if (!strcmp(r->scene->solid[k].name, name))
            return json_fail(at, "expected another body that has a surface, found a solid; take "
                                 "a rigid body whose \"pin\" moves all vertices by \"path\" and "
                                 "\"turn\" as the \"motion\" does, or hold points at the solid by "
                                 "such a \"pin\"");
    return reader_fail_word(at, "body", names, count);
}

static pdyn_status check_others(struct reader *r, const struct json_at *at, int self) {
    const struct scene_body *body = &r->scene->body[self];
    struct json_at array = json_member(at, "constraints");
    for (int k = 0; k < body->constraints; k++) {
        const struct scene_constraint *c = &body->constraint[k];
        struct json_at constraint = json_element(&array, (size_t)k);
        for (const pdyn_param *p = c->type->params; p->name; p++) {
            struct json_at name = json_member(&constraint, p->name);
            if (p->kind != PDYN_OTHER || !name.value) continue;
            pdyn_status status = check_other(r, &name, self, json_string_value(name.value));
            if (status != PDYN_OK) return status;
        }
    }
    return PDYN_OK;
}

/* ---- derived parameters ---------------------------------------------------------------------- */

/* Lets a constraint compute parameters from the scene, e.g. a stiffness from the head. */
static pdyn_status resolve(const struct reader *r, const struct json_at *at,
                           const struct scene_body *body, struct scene_constraint *c) {
    pdyn_status status = derived_create(r->context, r->scene, body, c);
    if (status != PDYN_OK) return status;
    pdyn_param_fault fault = derived_compute(c);
    if (!fault.message) return PDYN_OK;
    struct json_at param = json_member(at, fault.param ? fault.param : "");
    return json_fail(fault.param ? &param : at, "%s", fault.message);
}

static pdyn_status resolve_all(struct reader *r, const struct json_at *at, int index) {
    const struct scene_body *body = &r->scene->body[index];
    struct json_at array = json_member(at, "constraints");
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < body->constraints && status == PDYN_OK; k++) {
        struct json_at constraint = json_element(&array, (size_t)k);
        status = resolve(r, &constraint, body, &body->constraint[k]);
    }
    return status;
}

static pdyn_status resolve_overlap(struct reader *r, const struct json_at *at, int index) {
    struct json_at particles = json_member(at, "particles");
    struct scene_body *body = &r->scene->body[index];
    pdyn_status status = overlap_resolve(&particles, r->scene, body);
    return status == PDYN_OK ? inlet_cover_resolve(&particles, r->scene, body) : status;
}

/* ---- parts of a scene ------------------------------------------------------------------------ */

static pdyn_status read_bodies(struct reader *r, const struct json_at *array) {
    struct scene *scene = r->scene;
    pdyn_status status = reader_array(r, array, "an array of bodies", scene_read_body,
                                      sizeof *scene->body, &scene->body, &scene->bodies);
    if (status == PDYN_OK && !scene->bodies) status = json_expected(array, "at least one body");
    return status;
}

static pdyn_status read_solids(struct reader *r, const struct json_at *array) {
    struct scene *scene = r->scene;
    return reader_array(r, array, "an array of solids", scene_read_solid, sizeof *scene->solid,
                        &scene->solid, &scene->solids);
}

static pdyn_status read_outlet(struct reader *r, const struct json_at *at, int index) {
    return outlet_read(at, &r->scene->outlet[index]);
}

static pdyn_status read_outlets(struct reader *r, const struct json_at *array) {
    struct scene *scene = r->scene;
    return reader_array(r, array, "an array of outlets", read_outlet, sizeof *scene->outlet,
                        &scene->outlet, &scene->outlets);
}

static pdyn_status read_probes(struct reader *r, const struct json_at *array) {
    struct scene *scene = r->scene;
    return reader_array(r, array, "an array of probes", scene_read_probe, sizeof *scene->probe,
                        &scene->probe, &scene->probes);
}

const pdyn_param scene_contact_params[] = {
    {"thickness", PDYN_REAL, offsetof(struct scene_contact, thickness), true, 0, 1e-9, 1e3, "m",
     ""},
    {"friction", PDYN_REAL, offsetof(struct scene_contact, friction), false, 0.3, 0, 100, "1", ""},
    {"stiffness", PDYN_REAL, offsetof(struct scene_contact, stiffness), false, 0, 1e-9, 1e15, "N/m",
     ""},
    {"damping_ratio", PDYN_REAL, offsetof(struct scene_contact, damping), false, 0.3, 0, 100, "1",
     ""},
    {"self", PDYN_BOOL, offsetof(struct scene_contact, self), false, 1, 0, 0, "", ""},
    {0}};

/* Before the bodies and solids, whose meshes depend on the thickness. */
static pdyn_status read_contact(struct reader *r, const struct json_at *at) {
    if (!at->value) return PDYN_OK;
    r->scene->has_contact = true;
    return params_read_object(at, scene_contact_params, &r->scene->contact);
}

/* Without a surface there is no contact. */
static void resolve_contact(struct scene *scene) {
    bool surface = false;
    for (int b = 0; b < scene->bodies; b++) surface |= scene->body[b].has_mesh;
    scene->has_contact &= surface;
    if (scene->has_contact && scene->contact.stiffness == 0.0)
        scene->contact.stiffness = scene_contact_stiffness(scene);
}

static pdyn_status read_plugin(struct reader *r, const struct json_at *at, int index) {
    char *path = NULL;
    (void)index;
    pdyn_status status = file_ref_path(at, "the name of a plug-in's shared object", &path);
    if (status == PDYN_OK) status = json_wrap(at, pdyn_load_plugin(r->context, path));
    context_free_text(r->context, path);
    return status;
}

static pdyn_status read_plugins(struct reader *r, const struct json_at *array) {
    int count;
    pdyn_status status = reader_count(array, "an array of plug-ins", &count);
    if (status == PDYN_OK && count && r->context->options.refuse_scene_plugins)
        return json_fail(array, "plug-ins run code and are loaded from a scene only with "
                                "permission: the option --allow-plugins of projdyn, "
                                "PROJDYN_ALLOW_PLUGINS=1 in its environment, or "
                                "allow_plugins=True in Python");
    return status == PDYN_OK ? reader_each(r, array, read_plugin) : status;
}

static pdyn_status read_parts(struct reader *r, const struct json_at *root) {
    static const char *const others[] = {"$schema",  "name",   "gravity", "time_step", "solver",
                                         "bodies",   "solids", "outlets", "contact",   "plugins",
                                         "boundary", "kernel", "probes",  NULL};
    struct json_at bodies = json_member(root, "bodies"), solids = json_member(root, "solids");
    struct json_at outlets = json_member(root, "outlets"), contact = json_member(root, "contact");
    struct json_at plugins = json_member(root, "plugins"), probes = json_member(root, "probes");
    struct json_at foreign = json_member(root, "Configuration");
    if (foreign.value)
        return json_fail_at_key(&foreign, "this is a scene of SPlisHSPlasH; \"python3 -m "
                                          "projdyn.splishsplash FILE\" converts it");
    pdyn_status status = params_check_keys(root, settings_general_params, others);
    if (status == PDYN_OK) status = read_plugins(r, &plugins);
    if (status == PDYN_OK) status = settings_read(r, root);
    if (status == PDYN_OK) status = read_contact(r, &contact);
    if (status == PDYN_OK) status = read_bodies(r, &bodies);
    if (status == PDYN_OK) status = read_solids(r, &solids);
    if (status == PDYN_OK) status = reader_each(r, &bodies, check_others);
    if (status == PDYN_OK) status = read_outlets(r, &outlets);
    if (status == PDYN_OK) resolve_contact(r->scene);
    if (status == PDYN_OK) status = read_probes(r, &probes);
    if (status == PDYN_OK) vessel_find_all(r->scene);
    if (status == PDYN_OK) status = reader_each(r, &bodies, resolve_overlap);
    return status == PDYN_OK ? reader_each(r, &bodies, resolve_all) : status;
}

static pdyn_status read_file(struct reader *r, const struct json_file *file) {
    struct json_file noting = *file;
    noting.sources = &r->scene->sources;
    struct json_at root = json_root(&noting);
    r->scene->file = context_copy_text(r->context, file->name);
    if (!r->scene->file) return PDYN_NO_MEMORY;
    pdyn_status status =
        file->on_disk ? sources_add(r->context, noting.sources, file->name) : PDYN_OK;
    if (status == PDYN_OK) status = read_parts(r, &root);
    return status == PDYN_OK ? fingerprint_compute(r->context, root.value, r->scene) : status;
}

pdyn_status scene_read(const struct json_file *file, struct scene *out) {
    struct reader reader = {.context = file->context, .scene = out};
    struct text_locale locale;
    *out = (struct scene){0};
    if (!text_begin(&locale)) return context_no_memory(file->context);
    pdyn_status status = read_file(&reader, file);
    if (status != PDYN_OK) scene_free(file->context, out);
    text_end(&locale);
    return status;
}

static void free_body(pdyn_context *context, struct scene_body *body) {
    for (int k = 0; k < body->constraints; k++) {
        struct scene_constraint *constraint = &body->constraint[k];
        keyed_free(context, constraint);
        if (!constraint->params) continue;
        params_free(context, constraint->type->params, derived_given(constraint));
        derived_free(context, constraint);
        context_resize(context, constraint->params, constraint->type->params_size, 0);
    }
    FREE_ARRAY(context, body->constraint, body->constraints);
    for (int k = 0; k < body->inlets; k++) inlet_free(context, &body->inlet[k]);
    FREE_ARRAY(context, body->inlet, body->inlets);
    FREE_ARRAY(context, body->fill, body->fills);
    point_list_free(context, &body->start);
    point_list_free(context, &body->start_v);
    mesh_free(context, &body->mesh);
    mesh_free(context, &body->skin);
    tets_free(context, &body->tets);
    context_free_text(context, body->obj);
    context_free_text(context, body->name);
}

void scene_free(pdyn_context *context, struct scene *scene) {
    for (int b = 0; b < scene->bodies; b++) free_body(context, &scene->body[b]);
    for (int s = 0; s < scene->solids; s++) {
        mesh_free(context, &scene->solid[s].mesh);
        motion_free(context, &scene->solid[s].motion);
        context_free_text(context, scene->solid[s].name);
    }
    FREE_ARRAY(context, scene->body, scene->bodies);
    FREE_ARRAY(context, scene->solid, scene->solids);
    FREE_ARRAY(context, scene->outlet, scene->outlets);
    for (int k = 0; k < scene->probes; k++) {
        point_list_free(context, &scene->probe[k].at);
        context_free_text(context, scene->probe[k].name);
    }
    FREE_ARRAY(context, scene->probe, scene->probes);
    keyed_free_path(context, &scene->settings.gravity_keys.path);
    sources_free(context, &scene->sources);
    context_free_text(context, scene->file);
    context_free_text(context, scene->name);
    *scene = (struct scene){0};
}
