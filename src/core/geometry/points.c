#include "points.h"

#include <string.h>

pdyn_status points_too_many(pdyn_context *context) {
    return context_fail(context, PDYN_BAD_INPUT,
                        "more than %d points: the particle radius is too small "
                        "for the size of the scene",
                        POINTS_MOST);
}

pdyn_status points_add(pdyn_context *context, struct points *points, const double x[3]) {
    size_t need = 3 * ((size_t)points->count + 1);
    if (points->count == POINTS_MOST) return points_too_many(context);
    if (need > points->capacity) {
        size_t capacity = 2 * need + 3 * 1024;
        double *x_new = context_resize(context, points->x, points->capacity * sizeof *x_new,
                                       capacity * sizeof *x_new);
        if (!x_new) return context_no_memory(context);
        points->x = x_new, points->capacity = capacity;
    }
    memcpy(points->x + 3 * (size_t)points->count++, x, 3 * sizeof *x);
    return PDYN_OK;
}

pdyn_status points_add_all(pdyn_context *context, struct points *points, const double *x,
                           int count) {
    pdyn_status status = PDYN_OK;
    for (int i = 0; status == PDYN_OK && i < count; i++)
        status = points_add(context, points, x + 3 * (size_t)i);
    return status;
}

void points_free(pdyn_context *context, struct points *points) {
    FREE_ARRAY(context, points->x, points->capacity);
    *points = (struct points){0};
}
