/* A list of points that grows. */
#ifndef PDYN_POINTS_H
#define PDYN_POINTS_H

#include "base/context.h"

enum { POINTS_MOST = INT32_MAX / 4 };

struct points {
    int count;
    size_t capacity;
    double *x; /* count x 3, m */
};

/* Adds one point, or points as they are. PDYN_BAD_INPUT: there are POINTS_MOST already. */
pdyn_status points_add(pdyn_context *context, struct points *points, const double x[3]);
pdyn_status points_add_all(pdyn_context *context, struct points *points, const double *x,
                           int count);
void points_free(pdyn_context *context, struct points *points);

/* The error of a list that would grow too long. */
pdyn_status points_too_many(pdyn_context *context);

#endif
