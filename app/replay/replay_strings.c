#include "replay_strings.h"

#include <math.h>
#include <string.h>

enum { ENTRIES = 4 }; /* of a spring: a vertex, and three corners of a triangle of the other body */

static const struct part *find_skinned(const struct run *run, const json_t *name) {
    for (int p = 0; p < run->parts && json_is_string(name); p++)
        if (run->part[p].kind == BODY && run->part[p].skin.count &&
            !strcmp(run->part[p].name, json_string_value(name)))
            return &run->part[p];
    return NULL;
}

static int closest_point(const struct vtk_frame *skin, const float *x) {
    double least = INFINITY;
    int closest = 0;
    for (int i = 0; i < skin->count; i++) {
        double sum = 0.0;
        for (int a = 0; a < 3; a++) {
            double d = (double)skin->x[3 * (size_t)i + (size_t)a] - x[a];
            sum += d * d;
        }
        if (sum < least) least = sum, closest = i;
    }
    return closest;
}

/* Replaces the vertices of the body in the entries first to last - 1 of each spring by the closest
 * points of its skin. Entries that are no vertex of the body stay. */
static int replace_vertices(json_t *springs, size_t first, size_t last, const struct part *part,
                            const struct vtk_frame *body) {
    int failed = 0;
    for (size_t s = 0; s < json_array_size(springs); s++)
        for (size_t k = first; k < last; k++) {
            json_t *spring = json_array_get(springs, s);
            json_int_t vertex = json_integer_value(json_array_get(spring, k));
            if (vertex < 0 || vertex >= body->count) continue;
            int point = closest_point(&part->skin, body->x + 3 * (size_t)vertex);
            failed |= json_array_set_new(spring, k, json_integer(point));
        }
    return failed;
}

/* The same for one side of an entry of "strings", "body" or "to". */
static int replace_side(const struct run *run, json_t *entry, const char *side, size_t first,
                        size_t last) {
    char path[RUN_PATH];
    struct vtk_frame body;
    const struct part *part = find_skinned(run, json_object_get(entry, side));
    if (!part) return 0;
    struct part bare = *part;
    bare.skin = (struct vtk_frame){0};
    if (part_read_frame(run, &bare, 0, path, &body) != EXIT_GOOD) return 1;
    int failed = replace_vertices(json_object_get(entry, "ends"), first, last, part, &body);
    vtk_frame_free(&body);
    return failed;
}

json_t *replay_strings(const struct run *run) {
    const json_t *given = json_object_get(run->report, "strings");
    json_t *list = given ? json_deep_copy(given) : json_array(), *entry;
    size_t k;
    int failed = !list;
    json_array_foreach(list, k, entry) {
        failed |= replace_side(run, entry, "body", 0, 1);
        failed |= replace_side(run, entry, "to", 1, ENTRIES);
    }
    if (!failed) return list;
    json_decref(list);
    return NULL;
}
