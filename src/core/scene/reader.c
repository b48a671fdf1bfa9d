/* Names and arrays of a scene, and other details that its readers share. */
#include "reader.h"

#include "base/text.h"
#include "hint.h"

#include <stdio.h>
#include <string.h>

enum { WORD = 64, HINT = 768 };

pdyn_status reader_add_particles(struct reader *r, const struct json_at *at, double count) {
    r->particles += count;
    if (r->particles <= MAX_PARTICLES) return PDYN_OK;
    return json_fail(at, "expected at most %d particles in the scene, found %.10g so far",
                     MAX_PARTICLES, r->particles);
}

double reader_bump(const struct reader *r) { return 0.1 * r->scene->contact.thickness; }

/* Plug-ins have further constraints and solvers. */
static const char *plugin_hint(const struct json_at *at, const char *what) {
    bool extended = !strcmp(what, "constraint") || !strcmp(what, "solver");
    return extended && at->file->context->plugins == 1 /* the built-in types */
               ? "; those of a plug-in need --plugin FILE.so, or \"plugins\" in the scene"
               : "";
}

pdyn_status reader_fail_word(const struct json_at *at, const char *what, const char *const *names,
                             int count) {
    char word[WORD], hint[HINT] = "";
    text_clip(word, sizeof word, json_string_value(at->value));
    hint_append(hint, sizeof hint, word, names, count);
    return json_fail(at, "unknown %s \"%s\"%s%s", what, word, hint, plugin_hint(at, what));
}

pdyn_status reader_choice(const struct json_at *at, const char *what, const char *const *names,
                          int count, int *out) {
    char expected[WORD];
    *out = 0;
    if (!at->value) return PDYN_OK;
    snprintf(expected, sizeof expected, "the name of a %s", what);
    if (!json_is_string(at->value)) return json_expected(at, expected);
    for (int k = 0; k < count; k++)
        if (!strcmp(json_string_value(at->value), names[k])) return *out = k, PDYN_OK;
    return reader_fail_word(at, what, names, count);
}

static bool is_name(const char *text) {
    size_t length = strlen(text);
    return length >= 1 && length <= NAME_LENGTH &&
           length ==
               strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-");
}

static bool is_taken(const struct scene *scene, const char *name) {
    for (int b = 0; b < scene->bodies; b++)
        if (scene->body[b].name && !strcmp(scene->body[b].name, name)) return true;
    for (int s = 0; s < scene->solids; s++)
        if (scene->solid[s].name && !strcmp(scene->solid[s].name, name)) return true;
    for (int k = 0; k < scene->probes; k++)
        if (scene->probe[k].name && !strcmp(scene->probe[k].name, name)) return true;
    return false;
}

/* Whether a name ends as the frames of another one do: NAME_dddddd. */
static bool is_frame_of(const char *name) {
    size_t digits = 0, length = strlen(name);
    while (digits < length && strchr("0123456789", name[length - 1 - digits])) digits++;
    return digits >= 6 && digits < length && name[length - 1 - digits] == '_';
}

pdyn_status reader_name(struct reader *r, const struct json_at *owner, const char *kind, int index,
                        char **out) {
    char number[WORD];
    struct json_at at = json_member(owner, "name");
    const char *name = json_string_value(at.value);
    snprintf(number, sizeof number, "%s%d", kind, index);
    if (!at.value) name = number;
    else if (!name || !is_name(name))
        return json_expected(&at, "a name of 1 to 64 letters, digits, '_' and '-'");
    if (!strcmp(name, "boundary"))
        return json_fail(&at, "the name \"boundary\" is reserved for the files of the solids");
    if (is_frame_of(name))
        return json_fail(&at, "names like \"%s\" are those of frames: expected another ending",
                         name);
    if (is_taken(r->scene, name))
        return json_fail(&at, "the name \"%s\" is already taken by another body, solid or probe",
                         name);
    *out = context_copy_text(r->context, name);
    return *out ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status reader_color(const struct json_at *owner, char out[8]) {
    struct json_at at = json_member(owner, "color");
    const char *color = json_string_value(at.value);
    if (!at.value) return out[0] = '\0', PDYN_OK;
    if (!color || color[0] != '#' || strlen(color) != 7 ||
        strspn(color + 1, "0123456789abcdefABCDEF") != 6)
        return json_expected(&at, "a color \"#rrggbb\" of six hexadecimal digits");
    memcpy(out, color, 8);
    return PDYN_OK;
}

pdyn_status reader_one_of(const struct json_at *at, const char *const *names, int count, int *out) {
    char list[HINT] = "";
    int found = 0;
    for (int k = 0; k < count; k++) {
        size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s\"%s\"",
                 k == 0           ? ""
                 : k + 1 == count ? " and "
                                  : ", ",
                 names[k]);
        if (!json_object_get(at->value, names[k])) continue;
        found++;
        if (out) *out = k;
    }
    if (found == 1) return PDYN_OK;
    const char *none = count == 2 ? "neither" : "none", *more = count == 2 ? "both" : "more";
    return json_fail(at, "expected exactly one of %s, found %s", list, found ? more : none);
}

pdyn_status reader_each(struct reader *r, const struct json_at *array, read_fn *read) {
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < json_array_size(array->value) && status == PDYN_OK; k++) {
        struct json_at element = json_element(array, k);
        status = read(r, &element, (int)k);
    }
    return status;
}

pdyn_status reader_count(const struct json_at *array, const char *what, int *out) {
    *out = 0;
    if (array->value && !json_is_array(array->value)) return json_expected(array, what);
    if (json_array_size(array->value) > MAX_PARTICLES)
        return json_fail(array, "more than %d elements", MAX_PARTICLES);
    *out = (int)json_array_size(array->value);
    return PDYN_OK;
}

pdyn_status reader_array(struct reader *r, const struct json_at *array, const char *what,
                         read_fn *read, size_t size, void *items, int *count) {
    int length;
    pdyn_status status = reader_count(array, what, &length);
    if (status != PDYN_OK || !length) return status;
    void *elements = context_array(r->context, (size_t)length, size);
    if (!elements) return PDYN_NO_MEMORY;
    memcpy(items, &elements, sizeof elements); /* whatever the type of the pointer */
    *count = length;
    return reader_each(r, array, read);
}

static void log_turned(const struct reader *r, int count, const char *what) {
    if (count)
        context_log(r->context, PDYN_LOG_INFO,
                    "body \"%s\": %d %s%s of its mesh face%s another way than the rest, turned",
                    r->body->name, count, what, count == 1 ? "" : "s", count == 1 ? "s" : "");
}

pdyn_status reader_orient_pieces(struct reader *r) {
    struct mesh_turned turned;
    pdyn_status status = mesh_orient_pieces(r->context, &r->body->mesh, &turned);
    r->body->crossing = turned.crossing;
    if (status != PDYN_OK) return status;
    log_turned(r, turned.triangles, "triangle");
    log_turned(r, turned.pieces, "piece");
    return PDYN_OK;
}
