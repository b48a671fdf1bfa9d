/* Axis-aligned boxes. Points have 3 coordinates, m. */
#ifndef PROJDYN_BOX_H
#define PROJDYN_BOX_H

#include <math.h>
#include <stddef.h>

struct box {
    double min[3], max[3];
};

/* Contains no point: min > max. */
static const struct box box_empty = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

/* The box around the ball of a radius, m, around a centre. */
static inline struct box box_of_ball(const double centre[3], double radius) {
    struct box box;
    for (int a = 0; a < 3; a++) box.min[a] = centre[a] - radius, box.max[a] = centre[a] + radius;
    return box;
}

/* Extends the box to contain x. */
static inline void box_add(struct box *box, const double x[3]) {
    for (int a = 0; a < 3; a++) {
        if (x[a] < box->min[a]) box->min[a] = x[a];
        if (x[a] > box->max[a]) box->max[a] = x[a];
    }
}

/* The box around `count` points; empty where there are none. */
static inline struct box box_around(const double *x, int count) {
    struct box box = box_empty;
    for (int i = 0; i < count; i++) box_add(&box, x + 3 * (size_t)i);
    return box;
}

/* Whether x is inside, or on a face: 0 or 1. */
static inline int box_contains(const struct box *box, const double x[3]) {
    int inside = 1;
    for (int a = 0; a < 3; a++) inside &= x[a] >= box->min[a] && x[a] <= box->max[a];
    return inside;
}

/* Moves every face out by a distance, m. */
static inline void box_grow(struct box *box, double distance) {
    for (int a = 0; a < 3; a++) box->min[a] -= distance, box->max[a] += distance;
}

/* The longest side, m; 0 for a box that contains no point. */
static inline double box_extent(const struct box *box) {
    double extent = 0.0;
    for (int a = 0; a < 3; a++) extent = fmax(extent, box->max[a] - box->min[a]);
    return extent;
}

#endif
