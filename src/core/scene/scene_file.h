/* The scene of a program (projdyn/scene.h): a scene file in memory. */
#ifndef PDYN_SCENE_FILE_H
#define PDYN_SCENE_FILE_H

#include "json_file.h"
#include "projdyn/scene.h"

struct pdyn_scene {
    struct json_file json; /* with the arrays that stand for files */
};

/* Whether an override or the array is NULL, or count < 0: a bad call of the function. */
bool scene_bad_overrides(const char *function, const char *const *set, int count);

#endif
