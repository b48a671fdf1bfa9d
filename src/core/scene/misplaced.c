/* Keys at a wrong place: those of a body in its shape, those of a shape in its body, that of a
 * motion in its keys, and those of the scene or of a constraint anywhere else. */
#include "misplaced.h"

#include "base/text.h"
#include "params.h"
#include "scene_body.h"

#include <string.h>

enum where { ANYWHERE, IN_FLUID, NOT_IN_FLUID, IN_BODY }; /* objects in which a key is unknown */
static const struct {
    const char *key, *place;
    enum where where;
} elsewhere[] = {
    {"friction", "\"contact.friction\" of the scene", NOT_IN_FLUID},
    {"thickness", "\"contact.thickness\" of the scene", ANYWHERE},
    {"restitution", "\"contact.damping_ratio\" of the scene", NOT_IN_FLUID},
    {"contact", "\"contact\" of the scene", ANYWHERE},
    {"gravity", "\"gravity\" of the scene", ANYWHERE},
    {"kernel", "\"kernel\" of the scene", ANYWHERE},
    {"boundary", "\"boundary\" of the scene", ANYWHERE},
    {"outlets", "\"outlets\" of the scene", ANYWHERE},
    {"time_step", "\"time_step\" of the scene", ANYWHERE},
    {"static", "\"solids\" of the scene", IN_BODY},
    {"kinematic", "\"solids\" of the scene", IN_BODY},
    {"isDynamic", "\"solids\" of the scene", IN_BODY},
    {"rest_density", "\"particles.rest_density\" of the body", IN_FLUID},
    {"viscosity", "\"viscosity\" in the \"constraints\" of a fluid", ANYWHERE},
    {"surface_tension", "\"surface_tension\" in the \"constraints\" of a fluid", ANYWHERE},
};

/* Whether the key is that of a kind of bodies. */
static bool is_kind(const char *key) {
    for (int k = 0; key && k < SCENE_KINDS; k++)
        if (!strcmp(key, scene_kinds[k]->name)) return true;
    return false;
}

static bool hint_body(char *hint, size_t size, const struct json_at *at) {
    if (!is_kind(at->parent->key) || is_kind(at->key) ||
        !params_has_key(scene_body_params, scene_body_others, at->key))
        return false;
    text_append(hint, size, "; it is a key of the body, beside \"%s\"", at->parent->key);
    return true;
}

static bool hint_shape(char *hint, size_t size, const struct json_at *at) {
    for (int k = 0; k < SCENE_KINDS; k++) {
        const struct scene_kind *kind = scene_kinds[k];
        if (!json_is_object(json_object_get(at->parent->value, kind->name)) ||
            !params_has_key(kind->params, kind->others, at->key))
            continue;
        text_append(hint, size, "; did you mean \"%s.%s\"?", kind->name, at->key);
        return true;
    }
    return false;
}

static bool hint_motion(char *hint, size_t size, const struct json_at *at) {
    const struct json_at *keys = at->parent->parent;
    if (strcmp(at->key, "pivot") || !keys || !keys->key || strcmp(keys->key, "motion"))
        return false;
    text_append(hint, size, "; it is one for all keys, beside \"motion\"");
    return true;
}

/* Whether the object is a body of particles, or a part of one. */
static bool is_in_fluid(const struct json_at *object) {
    for (; object; object = object->parent)
        if (json_object_get(object->value, "particles")) return true;
    return false;
}

/* Whether the object is a body, or a part of one. */
static bool is_in_body(const struct json_at *object) {
    for (; object; object = object->parent)
        if (object->key && !strcmp(object->key, "bodies")) return true;
    return false;
}

/* Whether a key of this kind may be meant in the object. */
static bool fits(enum where where, const struct json_at *object) {
    if (where == IN_BODY) return is_in_body(object);
    return where == ANYWHERE || is_in_fluid(object) == (where == IN_FLUID);
}

/* Whether the object is a constraint of this type, which has a parameter of another name. */
static bool is_constraint(const struct json_at *object, const char *type) {
    const char *found = json_string_value(json_object_get(object->value, "type"));
    return found && !strcmp(found, type);
}

/* Whether the object chooses vertices: no key of the scene or of a fluid is meant there. */
static bool chooses_vertices(const struct json_at *object) {
    if (!object->key) object = object->parent; /* an element of an array */
    return object->key && !strcmp(object->key, "vertices");
}

static bool hint_elsewhere(char *hint, size_t size, const struct json_at *at) {
    if (!at->parent->parent || is_constraint(at->parent, at->key) || chooses_vertices(at->parent))
        return false;
    for (size_t k = 0; k < sizeof elsewhere / sizeof *elsewhere; k++)
        if (!strcmp(at->key, elsewhere[k].key) && fits(elsewhere[k].where, at->parent)) {
            text_append(hint, size, "; did you mean %s?", elsewhere[k].place);
            return true;
        }
    return false;
}

bool misplaced_hint(char *hint, size_t size, const struct json_at *at) {
    return hint_body(hint, size, at) || hint_shape(hint, size, at) || hint_motion(hint, size, at) ||
           hint_elsewhere(hint, size, at);
}
