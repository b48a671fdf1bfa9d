/* The value of a parameter over time: interpolates a pdyn_path of module.h. */
#ifndef PROJDYN_PATH_H
#define PROJDYN_PATH_H

#include "module.h"

/* The three numbers of `path` at a time in s: linear between two keys, constant before the first
 * and after the last key, 0 for a path without keys. */
static inline void path_at(const pdyn_path *path, double time, double value[3]) {
    int next = 0; /* the first key after `time` */
    while (next < path->count && path->key[4 * next] <= time) next++;
    for (int a = 0; a < 3; a++) {
        value[a] = 0.0;
        if (!path->count) continue;
        const double *left = path->key + 4 * (next ? next - 1 : 0);
        const double *right = path->key + 4 * (next < path->count ? next : next - 1);
        double t = right[0] > left[0] ? (time - left[0]) / (right[0] - left[0]) : 0.0;
        value[a] = left[1 + a] + t * (right[1 + a] - left[1 + a]);
    }
}

#endif
