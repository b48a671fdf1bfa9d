/* Filling a struct from a JSON object by a table of parameters, and the values that are read alike
 * everywhere. Errors say where and what was expected. */
#ifndef PDYN_PARAMS_H
#define PDYN_PARAMS_H

#include "base/registry.h"
#include "json_file.h"
#include "scene.h"

/* Checks that `object` is an object whose keys are all in the table (NULL: none) or in `others`,
 * which ends with NULL. */
pdyn_status params_check_keys(const struct json_at *object, const pdyn_param *table,
                              const char *const *others);

/* Checks that `object` has at most one of the keys in `names`, which ends with NULL; NULL: none. */
pdyn_status params_check_alternatives(const struct json_at *object, const char *const *names);

/* Fills `params` by the table. A missing object gives all defaults. Chosen vertices, paths and
 * names are allocated: params_free gives them back, after a failure too. surface: the rest shape in
 * which vertices are chosen, NULL for a body of particles. */
pdyn_status params_read(const struct json_at *object, const pdyn_param *table,
                        const struct mesh *surface, void *params);
void params_free(pdyn_context *context, const pdyn_param *table, void *params);

/* "a number from 1 to 2 m" */
void params_describe_bounds(char *text, size_t size, const char *what, double min, double max,
                            const char *unit);

pdyn_status params_real(const struct json_at *at, double min, double max, const char *unit,
                        double *out);
pdyn_status params_int(const struct json_at *at, double min, double max, int *out);
/* An array of exactly `count` numbers. */
pdyn_status params_reals(const struct json_at *at, int count, double min, double max,
                         const char *unit, double *out);
/* {"minimum": [..], "maximum": [..]} with an extent in every direction */
pdyn_status params_box(const struct json_at *at, struct scene_box *box);
/* {"center": [..], "radius": r} */
pdyn_status params_sphere(const struct json_at *at, struct scene_sphere *sphere);

#endif
