/* JSON texts: parsing, positions of values, error messages. */
#include "json_file.h"

#include "base/file_in.h"
#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { PLACE = 1400, VALUE = 64 };

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

static size_t removed_up_to(const struct json_file *file, const json_t *array, size_t index) {
    size_t count = 0;
    for (const struct json_change *c = file->change; c; c = c->next)
        count += c->removed && c->container == array && c->index <= index;
    return count;
}

size_t json_text_index(const struct json_file *file, const json_t *array, size_t index) {
    for (size_t skipped = 0, removed;; skipped = removed) {
        removed = removed_up_to(file, array, index + skipped);
        if (removed == skipped) return index + skipped;
    }
}

/* Position of the value or of its key; of the parent if the value is missing. */
static const char *find_position(const struct json_at *at, bool at_key) {
    if (!at->parent) return skip_space(at->file->text);
    const char *around = find_position(at->parent, false), *p = skip_space(around + 1);
    if (*around != (at->key ? '{' : '[')) return around;
    size_t index = at->key ? 0 : json_text_index(at->file, at->parent->value, at->index);
    for (size_t i = 0; *p != '}' && *p != ']'; i++) {
        const char *start = p;
        bool here = at->key ? key_equals(p, at->key) : i == index;
        if (at->key) p = skip_space(skip_space(skip_string(p)) + 1);
        if (here) return at_key ? start : p;
        p = skip_space(skip_value(p));
        if (*p == ',') p = skip_space(p + 1);
    }
    return around;
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* The change from which the value or one of its parents comes; NULL: none. */
static const struct json_change *change_of(const struct json_at *at) {
    for (; at->parent; at = at->parent)
        for (const struct json_change *c = at->file->change; c; c = c->next) {
            if (c->removed || c->container != at->parent->value || !c->key != !at->key) continue;
            if (at->key ? !strcmp(c->key, at->key) : c->index == at->index) return c;
        }
    return NULL;
}

static void append_place(char *text, size_t size, const struct json_at *at, bool at_key) {
    const struct json_change *from = change_of(at);
    if (from && from->label) text_append(text, size, "%s", from->label);
    else text_append(text, size, "%.1024s:", at->file->name);
    if (!from && at->file->text) {
        const char *end = find_position(at, at_key);
        int line = 1, column = 1;
        for (const char *p = at->file->text; p < end; p++)
            if (*p == '\n') line++, column = 1;
            else column += ((unsigned char)*p & 0xC0) != 0x80; /* counts characters, not bytes */
        text_append(text, size, "%d:%d:", line, column);
    }
    text_append(text, size, " ");
}

static void append_path(char *text, size_t size, const struct json_at *at) {
    char key[VALUE];
    if (!at->parent) return;
    append_path(text, size, at->parent);
    if (at->key) {
        text_clip(key, sizeof key, at->key);
        text_append(text, size, "%s%s", at->parent->parent ? "." : "", key);
    } else text_append(text, size, "[%zu]", at->index);
}

static pdyn_status fail(const struct json_at *at, bool at_key, const char *format, va_list args) {
    char place[PLACE] = "", path[256] = "", message[1024];
    append_place(place, sizeof place, at, at_key);
    /* for an unknown key, the path ends at the object: the message has the key */
    append_path(path, sizeof path, at_key ? at->parent : at);
    vsnprintf(message, sizeof message, format, args);
    return set_error(PDYN_BAD_INPUT, "%s%s%s%s", place, path, *path ? ": " : "", message);
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
    char text[ERROR_LENGTH];
    if (status == PDYN_OK || status == PDYN_NO_MEMORY) return status;
    text_clip(text, sizeof text, pdyn_last_error(NULL));
    json_fail(at, "%s", text);
    return status;
}

void json_note(const struct json_at *at, const char *format, ...) {
    char place[PLACE] = "", path[256] = "", message[256];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    append_place(place, sizeof place, at, false);
    append_path(path, sizeof path, at);
    context_log(at->file->context, PDYN_LOG_INFO, "%s%s: %s", place, path, message);
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

/* ---- reading --------------------------------------------------------------------------------- */

/* What a text that is no JSON may be. */
static const char *syntax_hint(const struct json_file *file, const char *error) {
    const char *end = strrchr(file->name, '.');
    bool is_mesh =
        end && (!strcasecmp(end, ".obj") || !strcasecmp(end, ".ply") || !strcasecmp(end, ".stl"));
    if (is_mesh) return "; a scene is JSON and names mesh files by the key \"mesh\"";
    return strstr(error, "near '/'") ? "; JSON has no comments" : "";
}

static pdyn_status parse(struct json_file *file) {
    json_error_t error = {.text = ""};
    char text[JSON_ERROR_TEXT_LENGTH];
    if (!strncmp(file->text, "\177ELF", 4))
        return set_error(
            PDYN_BAD_INPUT,
            "%.1024s: a program or a shared library, expected a scene; a plug-in is loaded by "
            "--plugin FILE and checked by projdyn check --conformance FILE",
            file->name);
    if (!strncmp(file->text, "\xEF\xBB\xBF", 3)) memset(file->text, ' ', 3); /* byte order mark */
    file->root = json_parse(file->text, file->size, JSON_REJECT_DUPLICATES, &error);
    if (!file->root && errno == ENOMEM) return context_no_memory(file->context);
    struct json_at root = json_root(file);
    if (file->root) return json_is_object(file->root) ? PDYN_OK : json_expected(&root, "an object");
    text_clip(text, sizeof text, error.text);
    return set_error(PDYN_BAD_INPUT, "%.1024s:%d:%d: not valid JSON: %s%s", file->name,
                     error.line < 1 ? 1 : error.line, error.column < 1 ? 1 : error.column, text,
                     syntax_hint(file, text));
}

pdyn_status json_file_open(pdyn_context *context, const char *name, bool on_disk, const char *text,
                           struct json_file *file) {
    *file = (struct json_file){.context = context, .on_disk = on_disk};
    file->name = context_copy_text(context, name);
    if (!file->name) return PDYN_NO_MEMORY;
    if (!on_disk && !text) {
        file->root = json_object();
        return file->root ? PDYN_OK : context_no_memory(context);
    }
    pdyn_status status = PDYN_OK;
    if (on_disk) status = file_load(context, name, &file->text, &file->size);
    else if ((file->text = context_copy_text(context, text))) file->size = strlen(text);
    else status = PDYN_NO_MEMORY;
    return status == PDYN_OK ? parse(file) : status;
}

void json_file_close(struct json_file *file) {
    json_changes_free(file);
    json_decref(file->root);
    FREE_ARRAY(file->context, file->text, file->size + 1);
    context_free_text(file->context, file->name);
    *file = (struct json_file){0};
}
