/* JSON texts with overrides: parsing, positions of values, error messages. */
#include "json_file.h"

#include "base/file_in.h"
#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLACE = 1400, VALUE = 64, KEYS = 32 };

/* ---- jansson and memory ---------------------------------------------------------------------- */

json_t *json_parse(const char *text, size_t size, size_t flags, json_error_t *error) {
    errno = 0;
    json_t *value = json_loadb(text, size, flags, error);
    if (errno != ENOMEM) return value;
    json_decref(value);
    errno = ENOMEM;
    return NULL;
}

char *json_compose(const json_t *value, size_t flags) {
    errno = 0;
    char *text = json_dumps(value, flags);
    if (errno != ENOMEM) return text;
    free(text);
    errno = ENOMEM;
    return NULL;
}

/* ---- position of a value in the text --------------------------------------------------------- */

/* These functions assume valid JSON: jansson has parsed the text. */

static const char *skip_space(const char *p) { return p + strspn(p, " \t\r\n"); }

static const char *skip_string(const char *p) {
    for (p++; *p != '"'; p++)
        if (*p == '\\') p++;
    return p + 1;
}

static const char *skip_value(const char *p) {
    int depth = 0;
    do {
        if (*p == '"') p = skip_string(p);
        else if (strchr("{}[]", *p)) {
            depth += *p == '{' || *p == '[' ? 1 : -1;
            p++;
        } else if (strchr(",: \t\r\n", *p)) p++;
        else p += strcspn(p, ",:]} \t\r\n");
    } while (depth);
    return p;
}

/* Compares a key in the text, which may contain escapes, with `key`. */
static bool key_equals(const char *p, const char *key) {
    json_t *read = json_loadb(p, (size_t)(skip_string(p) - p), JSON_DECODE_ANY, NULL);
    bool same = read && !strcmp(json_string_value(read), key);
    json_decref(read);
    return same;
}

/* Position of the value or of its key; of the parent if the value is missing. */
static const char *find_position(const struct json_at *at, bool at_key) {
    if (!at->parent) return skip_space(at->file->text);
    const char *around = find_position(at->parent, false), *p = skip_space(around + 1);
    if (*around != (at->key ? '{' : '[')) return around;
    for (size_t i = 0; *p != '}' && *p != ']'; i++) {
        const char *start = p;
        bool here = at->key ? key_equals(p, at->key) : i == at->index;
        if (at->key) p = skip_space(skip_space(skip_string(p)) + 1);
        if (here) return at_key ? start : p;
        p = skip_space(skip_value(p));
        if (*p == ',') p = skip_space(p + 1);
    }
    return around;
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* Index of the override from which the value or one of its parents comes; -1: none. */
static int override_of(const struct json_at *at) {
    for (; at->parent; at = at->parent)
        for (int i = at->file->overrides - 1; i >= 0; i--) {
            const struct json_override *o = &at->file->override[i];
            if (o->container != at->parent->value || !o->key != !at->key) continue;
            if (at->key ? !strcmp(o->key, at->key) : o->index == at->index) return i;
        }
    return -1;
}

static void append_override(const struct json_file *file, int i, char *text, size_t size) {
    char clipped[256];
    text_clip(clipped, sizeof clipped, file->set[i]);
    text_append(text, size, "--set %s: ", clipped);
}

static void append_place(const struct json_at *at, bool at_key, char *text, size_t size) {
    int from = override_of(at);
    if (from >= 0) {
        append_override(at->file, from, text, size);
        return;
    }
    const char *end = find_position(at, at_key);
    int line = 1, column = 1;
    for (const char *p = at->file->text; p < end; p++)
        if (*p == '\n') line++, column = 1;
        else column += ((unsigned char)*p & 0xC0) != 0x80; /* counts characters, not bytes */
    text_append(text, size, "%.1024s:%d:%d: ", at->file->name, line, column);
}

static void append_path(const struct json_at *at, char *text, size_t size) {
    char key[VALUE];
    if (!at->parent) return;
    append_path(at->parent, text, size);
    if (at->key) {
        text_clip(key, sizeof key, at->key);
        text_append(text, size, "%s%s", at->parent->parent ? "." : "", key);
    } else text_append(text, size, "[%zu]", at->index);
}

static pdyn_status fail(const struct json_at *at, bool at_key, const char *format, va_list args) {
    char place[PLACE] = "", path[256] = "", message[1024];
    append_place(at, at_key, place, sizeof place);
    /* for an unknown key, the path ends at the object: the message has the key */
    append_path(at_key ? at->parent : at, path, sizeof path);
    vsnprintf(message, sizeof message, format, args);
    return context_fail(at->file->context, PDYN_BAD_INPUT, "%s%s%s%s", place, path,
                        *path ? ": " : "", message);
}

pdyn_status json_fail(const struct json_at *at, const char *format, ...) {
    va_list args;
    va_start(args, format);
    pdyn_status status = fail(at, false, format, args);
    va_end(args);
    return status;
}

pdyn_status json_fail_at_key(const struct json_at *at, const char *format, ...) {
    va_list args;
    va_start(args, format);
    pdyn_status status = fail(at, true, format, args);
    va_end(args);
    return status;
}

pdyn_status json_expected(const struct json_at *at, const char *what) {
    char found[VALUE];
    if (!at->value) return json_fail(at, "missing, expected %s", what);
    if (json_is_object(at->value)) return json_fail(at, "expected %s, found an object", what);
    if (json_is_array(at->value))
        return json_fail(at, "expected %s, found an array of %zu", what,
                         json_array_size(at->value));
    char *dump = json_dumps(at->value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(15));
    text_clip(found, sizeof found, dump ? dump : "?");
    free(dump);
    return json_fail(at, "expected %s, found %s", what, found);
}

pdyn_status json_wrap(const struct json_at *at, pdyn_status status) {
    char text[sizeof at->file->context->error];
    if (status == PDYN_OK || status == PDYN_NO_MEMORY) return status;
    text_clip(text, sizeof text, at->file->context->error);
    json_fail(at, "%s", text);
    return status;
}

/* ---- locations ------------------------------------------------------------------------------- */

struct json_at json_root(const struct json_file *file) {
    return (struct json_at){.file = file, .value = file->root};
}

struct json_at json_member(const struct json_at *object, const char *key) {
    return (struct json_at){object->file, object, key, 0, json_object_get(object->value, key)};
}

struct json_at json_element(const struct json_at *array, size_t index) {
    return (struct json_at){array->file, array, NULL, index, json_array_get(array->value, index)};
}

/* ---- overrides ------------------------------------------------------------------------------- */

static pdyn_status fail_override(const struct json_file *file, int i, const char *format, ...)
    PDYN_PRINTF(3, 4);
static pdyn_status fail_override(const struct json_file *file, int i, const char *format, ...) {
    char place[512] = "", message[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    append_override(file, i, place, sizeof place);
    return context_fail(file->context, PDYN_BAD_INPUT, "%s%s", place, message);
}

/* Name by which an override can refer to an array element; NULL: only by its index. */
static const char *element_name(const json_t *element) {
    const char *name = json_string_value(json_object_get(element, "name"));
    return name ? name : json_string_value(json_object_get(element, "type"));
}

static bool element_is(const json_t *element, size_t index, const char *key) {
    static const char *const by[] = {"name", "type"};
    char number[24];
    snprintf(number, sizeof number, "%zu", index);
    for (int k = 0; k < 2; k++) {
        const char *called = json_string_value(json_object_get(element, by[k]));
        if (called && !strcmp(called, key)) return true;
    }
    return !strcmp(number, key);
}

static pdyn_status fail_element(const struct json_file *file, int i, const json_t *array,
                                const char *key) {
    char hint[512] = "", clipped[VALUE];
    const char *names[KEYS];
    int count = 0;
    for (size_t k = 0; k < json_array_size(array); k++) {
        const char *name = element_name(json_array_get(array, k));
        text_append(hint, sizeof hint, "%s%zu", k ? ", " : "; there are ", k);
        if (!name) continue;
        text_clip(clipped, sizeof clipped, name);
        text_append(hint, sizeof hint, " (%s)", clipped);
        if (count < KEYS) names[count++] = name;
    }
    const char *nearest = text_closest(key, names, count);
    text_clip(clipped, sizeof clipped, key);
    if (!nearest)
        return fail_override(file, i, "no element \"%s\"%s", clipped,
                             *hint ? hint : "; the array is empty");
    char near[VALUE + 1]; /* longer names get no suggestion */
    text_clip(near, sizeof near, nearest);
    return fail_override(file, i, "no element \"%s\"; did you mean \"%s\"?%s", clipped, near, hint);
}

/* Sets a value of an object or array; records the outermost place that the override changes. */
static pdyn_status set_value(struct json_file *file, json_t *container, const char *key,
                             size_t index, json_t *value) {
    struct json_override *o = &file->override[file->overrides - 1];
    if (!o->container) {
        o->container =
            json_incref(container); /* keeps the address from being used by another value */
        o->key = json_is_object(container) ? key : NULL, o->index = index;
    }
    int failed = json_is_object(container) ? json_object_set_new(container, key, value)
                                           : json_array_set_new(container, index, value);
    return failed ? context_no_memory(file->context) : PDYN_OK;
}

/* One key of a path: *at becomes the value at `key`; the last key gets `value`. */
static pdyn_status override_step(struct json_file *file, json_t **at, const char *key,
                                 json_t *value) {
    json_t *container = *at;
    size_t index = 0;
    if (json_is_array(container)) {
        while (index < json_array_size(container) &&
               !element_is(json_array_get(container, index), index, key))
            index++;
        *at = json_array_get(container, index);
        if (!*at) return fail_element(file, file->overrides - 1, container, key);
    } else if (json_is_object(container)) {
        *at = json_object_get(container, key);
    } else {
        char clipped[VALUE];
        text_clip(clipped, sizeof clipped, key);
        return fail_override(file, file->overrides - 1,
                             "\"%s\" is a key of a value that is neither an object nor an array",
                             clipped);
    }
    if (value) return set_value(file, container, key, index, json_incref(value));
    if (*at) return PDYN_OK;
    *at = json_object();
    return set_value(file, container, key, index, *at);
}

static pdyn_status override_path(struct json_file *file, char *path, json_t *value) {
    json_t *at = file->root;
    pdyn_status status = PDYN_OK;
    char *next = path;
    for (int keys = 0; next && status == PDYN_OK; keys++) {
        char *key = next;
        next = strchr(key, '.');
        if (next) *next++ = '\0';
        if (keys == KEYS || !*key)
            return fail_override(file, file->overrides - 1, "expected PATH=VALUE, found %s",
                                 *key ? "more than 32 keys" : "an empty key");
        status = override_step(file, &at, key, next ? NULL : value);
    }
    return status;
}

static pdyn_status override_apply(struct json_file *file, const char *text) {
    struct json_override *o = &file->override[file->overrides++];
    errno = 0;
    json_t *whole = json_string(text); /* NULL: not UTF-8, or no memory */
    json_decref(whole);
    if (!whole && errno == ENOMEM) return context_no_memory(file->context);
    const char *equals = strchr(text, '=');
    if (!whole || !equals)
        return fail_override(file, file->overrides - 1, "expected PATH=VALUE%s",
                             whole ? ", found no '='" : " in UTF-8");
    o->path = NEW_ARRAY(file->context, o->size = strlen(text) + 1, char);
    if (!o->path) return PDYN_NO_MEMORY;
    memcpy(o->path, text, o->size);
    char *words = o->path + (equals - text);
    *words++ = '\0';
    json_t *value =
        json_parse(words, strlen(words), JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL);
    if (!value && errno != ENOMEM) value = json_string(words);
    if (!value) return context_no_memory(file->context);
    pdyn_status status = override_path(file, o->path, value);
    json_decref(value);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

static pdyn_status load(struct json_file *file) {
    pdyn_status status = file_load(file->context, file->name, &file->loaded, &file->size);
    file->text = file->loaded;
    return status;
}

static pdyn_status parse(struct json_file *file) {
    json_error_t error = {.text = ""};
    char text[JSON_ERROR_TEXT_LENGTH];
    file->root = json_parse(file->text, file->size, JSON_REJECT_DUPLICATES, &error);
    if (file->root) return PDYN_OK;
    if (errno == ENOMEM) return context_no_memory(file->context);
    text_clip(text, sizeof text, error.text);
    return context_fail(file->context, PDYN_BAD_INPUT, "%.1024s:%d:%d: not valid JSON: %s",
                        file->name, error.line < 1 ? 1 : error.line,
                        error.column < 1 ? 1 : error.column, text);
}

pdyn_status json_file_open(pdyn_context *context, const char *name, const char *text,
                           const char *const *set, int sets, struct json_file *file) {
    *file = (struct json_file){.context = context, .name = name, .text = text, .set = set};
    for (int i = 0; i < sets; i++)
        if (!set[i]) return PDYN_BAD_CALL;
    if (text) file->size = strlen(text);
    pdyn_status status = text ? PDYN_OK : load(file);
    if (status == PDYN_OK) status = parse(file);
    struct json_at root = json_root(file);
    if (status == PDYN_OK && !json_is_object(root.value))
        status = json_expected(&root, "an object");
    if (status == PDYN_OK && sets) {
        file->override = NEW_ARRAY(context, sets, struct json_override);
        if (file->override) file->capacity = sets;
        else status = PDYN_NO_MEMORY;
    }
    for (int i = 0; i < sets && status == PDYN_OK; i++) status = override_apply(file, set[i]);
    if (status != PDYN_OK) json_file_close(file);
    return status;
}

void json_file_close(struct json_file *file) {
    for (int i = 0; i < file->overrides; i++) {
        json_decref((json_t *)file->override[i].container);
        FREE_ARRAY(file->context, file->override[i].path, file->override[i].size);
    }
    FREE_ARRAY(file->context, file->override, file->capacity);
    json_decref(file->root);
    if (file->loaded) FREE_ARRAY(file->context, file->loaded, file->size + 1);
    *file = (struct json_file){0};
}
