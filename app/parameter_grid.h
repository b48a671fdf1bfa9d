/* Cartesian grid of scene parameters: one axis per path with a list of values. A grid point is
 * one choice of a value on each axis; points are numbered with the last axis fastest. */
#ifndef PARAMETER_GRID_H
#define PARAMETER_GRID_H

#include <stdbool.h>

struct grid_axis {
    char *path; /* path of a scene value, as in --set */
    int count;
    char **value; /* count: JSON or plain texts, as in --set */
};

struct parameter_grid {
    int axes;
    struct grid_axis *axis;
};

/* Adds the axis PATH=VALUE,VALUE,...; a comma within brackets, braces or quotes belongs to a
 * value. false with a message if the text is malformed, the path has an axis already, or memory
 * ran out. */
bool parameter_grid_add(struct parameter_grid *grid, const char *text);
void parameter_grid_free(struct parameter_grid *grid);

enum { GRID_MAX_POINTS = 1000000 };
/* Number of points; GRID_MAX_POINTS + 1 if there are more than GRID_MAX_POINTS. */
long parameter_grid_count(const struct parameter_grid *grid);

/* Value of an axis at a point. */
const char *parameter_grid_value(const struct parameter_grid *grid, long point, int axis);

/* Overrides PATH=VALUE of a point, one per axis. The caller frees them with overrides_free().
 * NULL if memory ran out. */
char **parameter_grid_overrides(const struct parameter_grid *grid, long point);
void overrides_free(char **set, int count);

#endif
