/* A list of points that grows. */
#ifndef PDYN_POINT_LIST_H
#define PDYN_POINT_LIST_H

#include "base/context.h"

enum { POINT_LIST_MOST = INT32_MAX / 4 };

struct point_list {
    int count;
    size_t capacity;
    double *x; /* count x 3, m */
};

/* Adds one point, or points as they are. PDYN_BAD_INPUT: there are POINT_LIST_MOST already. */
pdyn_status point_list_add(pdyn_context *context, struct point_list *points, const double x[3]);
pdyn_status point_list_add_all(pdyn_context *context, struct point_list *points, const double *x,
                               int count);
void point_list_free(pdyn_context *context, struct point_list *points);

/* The error of a list that would grow too long. */
pdyn_status point_list_too_many(pdyn_context *context);

#endif
