/* A growing array of points. */
#ifndef PDYN_POINT_LIST_H
#define PDYN_POINT_LIST_H

#include "base/context.h"

enum { POINT_LIST_MAX = INT32_MAX / 4 };

struct point_list {
    int count;
    size_t capacity;
    double *x; /* count x 3, m */
};

/* Appends one point, or `count` points. PDYN_BAD_INPUT: the list would exceed POINT_LIST_MAX. */
pdyn_status point_list_add(pdyn_context *context, struct point_list *points, const double x[3]);
pdyn_status point_list_append(pdyn_context *context, struct point_list *points, const double *x,
                              int count);
void point_list_free(pdyn_context *context, struct point_list *points);

/* Sets the error text for a list that would exceed POINT_LIST_MAX; returns PDYN_BAD_INPUT. */
pdyn_status point_list_too_many(void);

#endif
