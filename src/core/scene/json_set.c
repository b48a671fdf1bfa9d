/* Changing values of a JSON text by their path: keys with dots between them; [k] stands for .k as
 * in other languages. The keys of a path that exist are followed; the values of the others are
 * built on their own and attached last, with one call, so that a failure changes nothing. The value
 * null removes what the path leads to, as in a JSON merge patch (RFC 7386), but a path that leads
 * to nothing is an error. */
#include "base/text.h"
#include "hint.h"
#include "json_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { PLACE = 1400, VALUE = 64, KEYS = 32 };

struct edit {
    struct json_file *file;
    const char *place; /* beginning of messages */
    const char *label; /* of the change (json_change) */
    bool make;         /* elements that are missing are made */
    const char *key[KEYS];
    int keys;
};

static pdyn_status fail(const struct edit *e, const char *format, ...) PDYN_PRINTF(2, 3);
static pdyn_status fail(const struct edit *e, const char *format, ...) {
    char message[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    return set_error(PDYN_BAD_INPUT, "%s %s", e->place, message);
}

static pdyn_status check_utf8(const struct edit *e, const char *text, const char *what) {
    errno = 0;
    json_t *copy = json_string(text); /* NULL: not UTF-8, or no memory */
    json_decref(copy);
    if (copy) return PDYN_OK;
    if (errno == ENOMEM) return context_no_memory(e->file->context);
    return fail(e, "expected %s in UTF-8", what);
}

/* ---- elements of arrays ---------------------------------------------------------------------- */

/* Name by which a path can refer to an array element; NULL: only by its index. */
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

/* advice: the end of the message where no element has a similar name, or "". */
static pdyn_status fail_element(const struct edit *e, const json_t *array, const char *key,
                                const char *advice) {
    char hint[512] = "", clipped[VALUE];
    const char *names[KEYS];
    int count = 0;
    for (size_t k = 0; k < json_array_size(array); k++) {
        const char *name = element_name(json_array_get(array, k));
        text_append(hint, sizeof hint, "%s%zu", k ? ", " : "; known: ", k);
        if (!name) continue;
        text_clip(clipped, sizeof clipped, name);
        text_append(hint, sizeof hint, " (%s)", clipped);
        if (count < KEYS) names[count++] = name;
    }
    const char *nearest = hint_closest(key, names, count);
    text_clip(clipped, sizeof clipped, key);
    if (!nearest)
        return fail(e, "no element \"%s\"%s%s", clipped, *hint ? hint : "; the array is empty",
                    advice);
    char near[VALUE + 1]; /* longer names get no suggestion */
    text_clip(near, sizeof near, nearest);
    return fail(e, "no element \"%s\"; did you mean \"%s\"?%s", clipped, near, hint);
}

static bool is_index(const char *key) { return strspn(key, "0123456789") == strlen(key); }

/* The key that names the elements of the array with key k - 1; NULL: they have an index alone. */
static const char *naming_key(const struct edit *e, int k) {
    static const char *const named[] = {"bodies", "solids", "probes"};
    const char *array = k ? e->key[k - 1] : "";
    for (size_t i = 0; i < sizeof named / sizeof *named; i++)
        if (!strcmp(array, named[i])) return "name";
    return !strcmp(array, "constraints") ? "type" : NULL;
}

/* Whether key k may be that of a new last element of the array; NULL: of an array not yet made. */
static bool may_append(const struct edit *e, int k, const json_t *array) {
    if (!e->make) return false;
    return is_index(e->key[k]) ? element_is(NULL, json_array_size(array), e->key[k])
                               : naming_key(e, k) != NULL;
}

/* ---- values to attach: functions take the value, and return NULL without memory -------------- */

/* Gives a new element of an array the name by which key k calls it. */
static json_t *name_element(const struct edit *e, int k, json_t *value) {
    const char *by = naming_key(e, k);
    if (!by || is_index(e->key[k]) || !json_is_object(value)) return value;
    json_t *named = json_object();
    bool good = named && !json_object_set_new(named, by, json_string(e->key[k])) &&
                !json_object_update(named, value);
    json_decref(value);
    if (good) return named;
    json_decref(named);
    return NULL;
}

/* Makes an array or object that has the value at key k. */
static json_t *wrap(const struct edit *e, int k, json_t *value) {
    bool array = e->make && (is_index(e->key[k]) || naming_key(e, k));
    if (array) value = name_element(e, k, value);
    json_t *around = array ? json_array() : json_object();
    int failed = array ? json_array_append_new(around, value)
                       : json_object_set_new(around, e->key[k], value);
    if (!failed) return around;
    json_decref(around);
    return NULL;
}

/* ---- changes --------------------------------------------------------------------------------- */

static void change_free(pdyn_context *context, struct json_change *change) {
    if (!change) return;
    json_decref(change->container);
    context_free_text(context, change->label);
    FREE_ARRAY(context, change, 1);
}

void json_changes_free(struct json_file *file) {
    for (struct json_change *next; file->change; file->change = next) {
        next = file->change->next;
        change_free(file->context, file->change);
    }
}

static struct json_change *change_new(const struct edit *e, json_t *container, size_t index) {
    struct json_change *change = NEW_ARRAY(e->file->context, 1, struct json_change);
    if (!change) return NULL;
    /* keeps the address from being used by another value */
    change->container = json_incref(container), change->index = index;
    if (!e->label) return change;
    change->label = context_copy_text(e->file->context, e->label);
    if (change->label) return change;
    change_free(e->file->context, change);
    return NULL;
}

/* Sets the value of an object or array, or appends it to an array, and records the place. */
static pdyn_status attach(const struct edit *e, json_t *container, const char *key, size_t index,
                          json_t *value) {
    struct json_change *change = change_new(e, container, index);
    if (!change) return json_decref(value), PDYN_NO_MEMORY;
    int failed = json_is_object(container)            ? json_object_set_new(container, key, value)
                 : index < json_array_size(container) ? json_array_set_new(container, index, value)
                                                      : json_array_append_new(container, value);
    if (failed) return change_free(e->file->context, change), context_no_memory(e->file->context);
    if (json_is_object(container)) /* its own copy of the key */
        change->key = json_object_iter_key(json_object_iter_at(container, key));
    change->next = e->file->change, e->file->change = change;
    return PDYN_OK;
}

/* The value at a key, or NULL; *index: of the element, or the length of the array. */
static json_t *find(json_t *container, const char *key, size_t *index) {
    if (!json_is_array(container)) return json_object_get(container, key);
    size_t k = 0;
    while (k < json_array_size(container) && !element_is(json_array_get(container, k), k, key)) k++;
    return json_array_get(container, *index = k);
}

/* Sets the value, which is taken, at the path of keys. */
static pdyn_status put(const struct edit *e, json_t *value) {
    json_t *at = e->file->root, *next;
    int k = 0, last = e->keys - 1;
    size_t index = 0;
    char clipped[VALUE];
    pdyn_status status = PDYN_OK;
    for (; (next = find(at, e->key[k], &index)) && k < last; k++) at = next;
    bool append = json_is_array(at) && !next;
    if (append && !may_append(e, k, at))
        status = fail_element(e, at, e->key[k], e->make ? "" : "; to add one, set the whole array");
    if (!json_is_object(at) && !json_is_array(at)) {
        text_clip(clipped, sizeof clipped, e->key[k]);
        status =
            fail(e, "\"%s\" is a key of a value that is neither an object nor an array", clipped);
    }
    for (int j = last; j > k && status == PDYN_OK && value; j--)
        if (e->make && is_index(e->key[j]) && !may_append(e, j, NULL))
            status = fail_element(e, NULL, e->key[j], "");
        else value = wrap(e, j, value);
    if (status == PDYN_OK && append && value) value = name_element(e, k, value);
    if (status != PDYN_OK) return json_decref(value), status;
    return value ? attach(e, at, e->key[k], index, value) : context_no_memory(e->file->context);
}

/* ---- removals -------------------------------------------------------------------------------- */

static pdyn_status fail_missing(const struct edit *e, json_t *container, const char *key) {
    const char *names[KEYS], *name;
    char clipped[VALUE], hint[512] = "";
    json_t *value;
    int count = 0;
    if (json_is_array(container)) return fail_element(e, container, key, "");
    text_clip(clipped, sizeof clipped, key);
    json_object_foreach(container, name, value) if (count < KEYS) names[count++] = name;
    if (count) hint_append(hint, sizeof hint, clipped, names, count);
    return fail(e, "no key \"%s\" to remove%s", clipped, hint);
}

/* Drops the changes of a value that is removed, and moves those of later elements. */
static void drop_changes(const struct edit *e, const json_t *container, const char *key,
                         size_t index) {
    for (struct json_change **at = &e->file->change, *c; (c = *at);) {
        bool here = c->container == container && !c->removed;
        if (here && (c->key ? key && !strcmp(c->key, key) : c->index == index)) {
            *at = c->next;
            change_free(e->file->context, c);
            continue;
        }
        if (here && !c->key && c->index > index) c->index--;
        at = &c->next;
    }
}

static pdyn_status detach(const struct edit *e, json_t *container, const char *key, size_t index) {
    bool array = json_is_array(container);
    struct json_change *change = NULL;
    if (array) {
        change = change_new(e, container, json_text_index(e->file, container, index));
        if (!change) return PDYN_NO_MEMORY;
        change->removed = true;
    }
    drop_changes(e, container, array ? NULL : key, index);
    if (!array) return json_object_del(container, key), PDYN_OK;
    change->next = e->file->change, e->file->change = change;
    json_array_remove(container, index);
    return PDYN_OK;
}

/* Removes the value at the path of keys. */
static pdyn_status take_out(const struct edit *e) {
    json_t *at = e->file->root, *next;
    size_t index = 0;
    int k = 0, last = e->keys - 1;
    for (; (next = find(at, e->key[k], &index)) && k < last; k++) at = next;
    return next ? detach(e, at, e->key[k], index) : fail_missing(e, at, e->key[k]);
}

static void replace_brackets(char *path) {
    char *to = path;
    for (char *from = path; *from; from++)
        if (*from != ']') *to++ = *from == '[' ? '.' : *from;
    *to = '\0';
}

/* Splits the path and sets the value, a JSON text or else a string; null removes it. */
static pdyn_status put_text(struct edit *e, char *path, const char *text) {
    replace_brackets(path);
    for (char *next = path; next;) {
        char *key = next;
        next = strchr(key, '.');
        if (next) *next++ = '\0';
        if (e->keys == KEYS || !*key)
            return fail(e, "expected %s, found %s", e->make ? "a path of keys" : "PATH=VALUE",
                        *key ? "more than 32 keys" : "an empty key");
        e->key[e->keys++] = key;
    }
    json_t *value = json_parse(text, strlen(text), JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL);
    if (!value && errno != ENOMEM) value = json_string(text);
    if (json_is_null(value)) return take_out(e); /* a value that is not counted */
    return value ? put(e, value) : context_no_memory(e->file->context);
}

static pdyn_status put_copied(struct edit *e, const char *path, size_t length, const char *text) {
    char *copy = NEW_ARRAY(e->file->context, length + 1, char);
    if (!copy) return PDYN_NO_MEMORY;
    memcpy(copy, path, length);
    pdyn_status status = put_text(e, copy, text);
    FREE_ARRAY(e->file->context, copy, length + 1);
    return status;
}

pdyn_status json_override(struct json_file *file, const char *text) {
    char place[PLACE] = "", clipped[256];
    text_clip(clipped, sizeof clipped, text);
    text_append(place, sizeof place, "--set %s:", clipped);
    struct edit e = {.file = file, .place = place, .label = place};
    const char *equals = strchr(text, '=');
    pdyn_status status = check_utf8(&e, text, "PATH=VALUE");
    if (status != PDYN_OK) return status;
    if (!equals) return fail(&e, "expected PATH=VALUE, found no '='");
    return put_copied(&e, text, (size_t)(equals - text), equals + 1);
}

pdyn_status json_set(struct json_file *file, const char *path, const char *value) {
    char place[PLACE] = "", clipped[256];
    text_clip(clipped, sizeof clipped, path);
    text_append(place, sizeof place, "%.1024s: %s:", file->name, clipped);
    struct edit e = {.file = file, .place = place, .make = true};
    pdyn_status status = check_utf8(&e, path, "a path");
    if (status == PDYN_OK) status = check_utf8(&e, value, "a value");
    return status == PDYN_OK ? put_copied(&e, path, strlen(path), value) : status;
}
