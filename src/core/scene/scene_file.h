/* The scene of a program (projdyn/scene.h): a scene file in memory. */
#ifndef PDYN_SCENE_FILE_H
#define PDYN_SCENE_FILE_H

#include "json_file.h"
#include "projdyn/scene.h"

struct pdyn_scene {
    struct json_file json; /* with the arrays that stand for files */
};

#endif
