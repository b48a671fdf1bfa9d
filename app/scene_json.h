/* A scene as JSON, for commands that change its settings. */
#ifndef SCENE_JSON_H
#define SCENE_JSON_H

#include "app.h"

#include <jansson.h>

/* The scene with its overrides done. An exit code. */
int scene_text(const struct scene_options *scene, json_t **text);

/* A number of an object that may be missing, as either may. */
double scene_number(const json_t *object, const char *key, double otherwise);

/* The fluid's constraint, and where it is: in bodies.BODY.constraints.CONSTRAINT; NULL: there is no
 * fluid. */
const json_t *scene_fluid(const json_t *scene, size_t *body, size_t *constraint);
/* What docs/scene.md has for a fluid that does not say it. */
double scene_viscosity(const json_t *fluid);
double scene_stiffness(const json_t *fluid);

#endif
