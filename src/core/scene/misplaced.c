/* Keys at a wrong place: those of a body in its shape, those of a shape in its body, and those of
 * the scene's contact in a body or a solid. */
#include "misplaced.h"

#include "base/text.h"

#include <string.h>

static const char *const shapes[] = {"particles", "surface", "volume", "rigid"};
static const char *const of_body[] = {"name", "color", "velocity", "constraints"};
static const char *const of_shape[][2] = {{"particles", "fill"},
                                          {"particles", "inlets"},
                                          {"particles", "radius"},
                                          {"particles", "budget"},
                                          {"particles", "rest_density"},
                                          {"surface", "grid"},
                                          {"surface", "mesh"},
                                          {"surface", "area_density"},
                                          {"surface", "permeability"},
                                          {"surface", "scale"},
                                          {"surface", "rotate"},
                                          {"surface", "translate"},
                                          {"volume", "grid"},
                                          {"volume", "mesh"},
                                          {"volume", "cell"},
                                          {"volume", "density"},
                                          {"volume", "scale"},
                                          {"volume", "rotate"},
                                          {"volume", "translate"},
                                          {"rigid", "mesh"},
                                          {"rigid", "cell"},
                                          {"rigid", "box"},
                                          {"rigid", "sphere"},
                                          {"rigid", "capsule"},
                                          {"rigid", "density"},
                                          {"rigid", "mass"},
                                          {"rigid", "center_of_mass"},
                                          {"rigid", "scale"},
                                          {"rigid", "rotate"},
                                          {"rigid", "translate"},
                                          {"rigid", "angular_velocity"}};
static const char *const of_contact[][2] = {
    {"friction", "friction"}, {"thickness", "thickness"}, {"restitution", "damping_ratio"}};

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Whether the object is a shape, whose name is then its key. */
static bool is_shape(const struct json_at *object) {
    for (size_t k = 0; object->key && k < COUNT(shapes); k++)
        if (!strcmp(object->key, shapes[k])) return true;
    return false;
}

static bool hint_body(const struct json_at *at, char *hint, size_t size) {
    for (size_t k = 0; is_shape(at->parent) && k < COUNT(of_body); k++)
        if (!strcmp(at->key, of_body[k])) {
            text_append(hint, size, "; it is a key of the body, beside \"%s\"", at->parent->key);
            return true;
        }
    return false;
}

static bool hint_shape(const struct json_at *at, char *hint, size_t size) {
    for (size_t k = 0; k < COUNT(of_shape); k++)
        if (!strcmp(at->key, of_shape[k][1]) &&
            json_is_object(json_object_get(at->parent->value, of_shape[k][0]))) {
            text_append(hint, size, "; did you mean \"%s.%s\"?", of_shape[k][0], at->key);
            return true;
        }
    return false;
}

static bool hint_contact(const struct json_at *at, char *hint, size_t size) {
    for (size_t k = 0; at->parent->parent && k < COUNT(of_contact); k++)
        if (!strcmp(at->key, of_contact[k][0])) {
            text_append(hint, size, "; did you mean \"contact.%s\" of the scene?",
                        of_contact[k][1]);
            return true;
        }
    return false;
}

bool misplaced_hint(const struct json_at *at, char *hint, size_t size) {
    return hint_body(at, hint, size) || hint_shape(at, hint, size) || hint_contact(at, hint, size);
}
