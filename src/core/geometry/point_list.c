/* A growing array of points. */
#include "point_list.h"

#include <string.h>

pdyn_status point_list_too_many(void) {
    return set_error(PDYN_BAD_INPUT,
                     "more than %d points: the particle radius is too small "
                     "for the size of the scene; \"scale\" changes the unit of a mesh",
                     POINT_LIST_MAX);
}

pdyn_status point_list_add(pdyn_context *context, struct point_list *points, const double x[3]) {
    size_t need = 3 * ((size_t)points->count + 1);
    if (points->count == POINT_LIST_MAX) return point_list_too_many();
    double *grown = context_grow(context, points->x, &points->capacity, need, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    points->x = grown;
    memcpy(points->x + 3 * (size_t)points->count++, x, 3 * sizeof *x);
    return PDYN_OK;
}

pdyn_status point_list_append(pdyn_context *context, struct point_list *points, const double *x,
                              int count) {
    pdyn_status status = PDYN_OK;
    for (int i = 0; status == PDYN_OK && i < count; i++)
        status = point_list_add(context, points, x + 3 * (size_t)i);
    return status;
}

void point_list_free(pdyn_context *context, struct point_list *points) {
    FREE_ARRAY(context, points->x, points->capacity);
    *points = (struct point_list){0};
}
