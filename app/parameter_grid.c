/* Cartesian grid of scene parameters for `projdyn sweep`, parsed from --set PATH=V,V,... */
#include "parameter_grid.h"
#include "app.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* End of the first value: the first comma outside of brackets, braces and quotes, or the NUL. */
static const char *find_value_end(const char *text) {
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

static bool add_value(struct grid_axis *axis, const char *text, size_t length) {
    char **value = realloc(axis->value, (size_t)(axis->count + 1) * sizeof *value);
    if (!value) return report_no_memory(), false;
    axis->value = value;
    value[axis->count] = strndup(text, length);
    return value[axis->count++] || (report_no_memory(), false);
}

/* Parses VALUE,VALUE,... into an axis; false with a message on failure. */
static bool add_values(struct grid_axis *axis, const char *text) {
    for (;; text++) {
        const char *end = find_value_end(text);
        if (end == text) {
            fprintf(stderr,
                    "projdyn: --set: %s: found an empty value, expected PATH=VALUE,VALUE,...\n",
                    axis->path);
            return false;
        }
        if (!add_value(axis, text, (size_t)(end - text))) return false;
        if (!*end) return true;
        text = end;
    }
}

bool parameter_grid_add(struct parameter_grid *grid, const char *text) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text) {
        fprintf(stderr, "projdyn: --set: found \"%s\", expected PATH=VALUE,VALUE,...\n", text);
        return false;
    }
    struct grid_axis *axis = realloc(grid->axis, (size_t)(grid->axes + 1) * sizeof *axis);
    if (!axis) return report_no_memory(), false;
    grid->axis = axis;
    axis += grid->axes;
    *axis = (struct grid_axis){.path = strndup(text, (size_t)(equals - text))};
    if (!axis->path) return report_no_memory(), false;
    grid->axes++;
    for (int a = 0; a + 1 < grid->axes; a++)
        if (!strcmp(grid->axis[a].path, axis->path)) {
            fprintf(stderr,
                    "projdyn: --set: \"%s\" is given twice; expected all values of a path in "
                    "one --set\n",
                    axis->path);
            return false;
        }
    return add_values(axis, equals + 1);
}

void parameter_grid_free(struct parameter_grid *grid) {
    for (int a = 0; a < grid->axes; a++) {
        free(grid->axis[a].path);
        overrides_free(grid->axis[a].value, grid->axis[a].count);
    }
    free(grid->axis);
    *grid = (struct parameter_grid){0};
}

long parameter_grid_count(const struct parameter_grid *grid) {
    long count = 1;
    for (int a = 0; a < grid->axes && count <= GRID_MAX_POINTS; a++) count *= grid->axis[a].count;
    return count <= GRID_MAX_POINTS ? count : GRID_MAX_POINTS + 1;
}

const char *parameter_grid_value(const struct parameter_grid *grid, long point, int axis) {
    for (int a = grid->axes - 1; a > axis; a--) point /= grid->axis[a].count;
    return grid->axis[axis].value[point % grid->axis[axis].count];
}

char **parameter_grid_overrides(const struct parameter_grid *grid, long point) {
    char **set = calloc((size_t)grid->axes + 1, sizeof *set);
    for (int a = 0; set && a < grid->axes; a++)
        if (asprintf(&set[a], "%s=%s", grid->axis[a].path, parameter_grid_value(grid, point, a)) <
            0) {
            set[a] = NULL;
            overrides_free(set, a);
            return NULL;
        }
    return set;
}

void overrides_free(char **set, int count) {
    for (int k = 0; set && k < count; k++) free(set[k]);
    free(set);
}
