/* A scene as JSON, for code that derives overrides from values of the scene. */
#ifndef SCENE_JSON_H
#define SCENE_JSON_H

#include "scene_options.h"

#include <jansson.h>

/* Loads the scene file with its overrides applied. The caller releases *json. Returns an exit
 * code. */
int scene_json(const struct scene_options *scene, json_t **json);

/* Number under a key; `fallback` if the object is NULL or has no number under this key. */
double scene_number(const json_t *object, const char *key, double fallback);

/* The fluid constraint of a body, at bodies.BODY.constraints.CONSTRAINT; NULL if there is none. */
const json_t *scene_fluid(const json_t *scene, size_t body, size_t *constraint);
/* Viscosity of a fluid, or its default (docs/guide/scene.md). */
double scene_viscosity(const json_t *fluid);

#endif
