/* The keys that an object may have, and errors about others. */
#include "base/text.h"
#include "hint.h"
#include "misplaced.h"
#include "params.h"

#include <string.h>

enum { KEYS = 64 };

bool params_has_key(const pdyn_param *table, const char *const *others, const char *key) {
    for (; table && table->name; table++)
        if (!strcmp(table->name, key)) return true;
    for (; *others; others++)
        if (!strcmp(*others, key)) return true;
    return false;
}

/* Collects the keys that an object may have. Returns their number. */
static int list_keys(const pdyn_param *table, const char *const *others, const char *names[KEYS]) {
    int count = 0;
    for (; *others && count < KEYS; others++) names[count++] = *others;
    for (; table && table->name && count < KEYS; table++) names[count++] = table->name;
    return count;
}

static bool has_text(const json_t *object, const char *key, const char *text) {
    const char *found = json_string_value(json_object_get(object, key));
    return found && !strcmp(found, text);
}

/* The key of an array of the object, one of whose elements has this name or type; NULL: none. */
static const char *array_of(json_t *object, const char *name) {
    const char *key;
    json_t *array, *element;
    size_t k;
    json_object_foreach(object, key, array) json_array_foreach(array, k, element) {
        if (has_text(element, "name", name) || has_text(element, "type", name)) return key;
    }
    return NULL;
}

static pdyn_status fail_unknown(const struct json_at *at, const pdyn_param *table,
                                const char *const *others) {
    const char *names[KEYS], *array = array_of(at->parent->value, at->key);
    char hint[768] = "", key[64];
    int count = list_keys(table, others, names);
    text_clip(key, sizeof key, at->key);
    if (array && params_has_key(table, others, array))
        text_append(hint, sizeof hint, "; did you mean \"%s.%s\"?", array, key);
    else if (!misplaced_hint(hint, sizeof hint, at))
        hint_append(hint, sizeof hint, at->key, names, count);
    return json_fail_at_key(at, "unknown key \"%s\"%s", key, hint);
}

static pdyn_status fail_no_object(const struct json_at *at, const pdyn_param *table,
                                  const char *const *others) {
    const char *names[KEYS];
    char what[768] = "an object {";
    int count = list_keys(table, others, names);
    for (int k = 0; k < count; k++)
        text_append(what, sizeof what, "%s%s", names[k], k + 1 < count ? ", " : "}");
    return json_expected(at, what);
}

pdyn_status params_check_keys(const struct json_at *object, const pdyn_param *table,
                              const char *const *others) {
    const char *key;
    json_t *value;
    if (!json_is_object(object->value)) return fail_no_object(object, table, others);
    json_object_foreach(object->value, key, value) {
        struct json_at at = json_member(object, key);
        if (!params_has_key(table, others, key)) return fail_unknown(&at, table, others);
    }
    return PDYN_OK;
}

pdyn_status params_check_alternatives(const struct json_at *object, const char *const *names) {
    const char *given = NULL;
    for (; names && *names; names++) {
        struct json_at at = json_member(object, *names);
        if (at.value && given)
            return json_fail_at_key(&at, "\"%s\" has no meaning beside \"%s\"", *names, given);
        if (at.value) given = *names;
    }
    return PDYN_OK;
}
