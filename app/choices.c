#include "choices.h"
#include "app.h"

#include <stdlib.h>
#include <string.h>

/* Where a value ends: at the first comma outside of brackets, braces and quotes. */
static const char *value_end(const char *text) {
    int depth = 0;
    bool quoted = false;
    for (; *text; text++) {
        if (quoted && *text == '\\' && text[1]) text++;
        else if (*text == '"') quoted = !quoted;
        else if (!quoted && strchr("[{", *text)) depth++;
        else if (!quoted && strchr("]}", *text)) depth--;
        else if (!quoted && depth == 0 && *text == ',') break;
    }
    return text;
}

static bool add_value(struct axis *axis, const char *text, size_t length) {
    char **value = realloc(axis->value, (size_t)(axis->count + 1) * sizeof *value);
    if (!value) return report_no_memory(), false;
    axis->value = value;
    value[axis->count] = strndup(text, length);
    return value[axis->count++] || (report_no_memory(), false);
}

static bool add_values(struct axis *axis, const char *text) {
    for (;; text++) {
        const char *end = value_end(text);
        if (end == text) {
            fprintf(stderr, "projdyn: --set: %s: found an empty value, expected VALUE,VALUE,...\n",
                    axis->path);
            return false;
        }
        if (!add_value(axis, text, (size_t)(end - text))) return false;
        if (!*end) return true;
        text = end;
    }
}

bool choices_add(struct choices *choices, const char *text) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text) {
        fprintf(stderr, "projdyn: --set: found \"%s\", expected PATH=VALUE,VALUE,...\n", text);
        return false;
    }
    struct axis *axis = realloc(choices->axis, (size_t)(choices->axes + 1) * sizeof *axis);
    if (!axis) return report_no_memory(), false;
    choices->axis = axis;
    axis += choices->axes;
    *axis = (struct axis){.path = strndup(text, (size_t)(equals - text))};
    if (!axis->path) return report_no_memory(), false;
    choices->axes++;
    for (int a = 0; a + 1 < choices->axes; a++)
        if (!strcmp(choices->axis[a].path, axis->path)) {
            fprintf(stderr,
                    "projdyn: --set: \"%s\" is given twice; expected all of its values in "
                    "one list\n",
                    axis->path);
            return false;
        }
    return add_values(axis, equals + 1);
}

void choices_free(struct choices *choices) {
    for (int a = 0; a < choices->axes; a++) {
        free(choices->axis[a].path);
        settings_free(choices->axis[a].value, choices->axis[a].count);
    }
    free(choices->axis);
    *choices = (struct choices){0};
}

long choices_count(const struct choices *choices) {
    long count = 1;
    for (int a = 0; a < choices->axes && count <= CHOICES_MOST; a++)
        count *= choices->axis[a].count;
    return count <= CHOICES_MOST ? count : CHOICES_MOST + 1;
}

const char *choices_value(const struct choices *choices, long point, int axis) {
    for (int a = choices->axes - 1; a > axis; a--) point /= choices->axis[a].count;
    return choices->axis[axis].value[point % choices->axis[axis].count];
}

char **choices_settings(const struct choices *choices, long point) {
    char **set = calloc((size_t)choices->axes + 1, sizeof *set);
    for (int a = 0; set && a < choices->axes; a++)
        if (asprintf(&set[a], "%s=%s", choices->axis[a].path, choices_value(choices, point, a)) <
            0) {
            set[a] = NULL;
            settings_free(set, a);
            return NULL;
        }
    return set;
}

void settings_free(char **set, int count) {
    for (int k = 0; set && k < count; k++) free(set[k]);
    free(set);
}
