/* Reading a struct from a JSON object by a table of parameters (pdyn_param), and values that occur
 * in many places. Errors are PDYN_BAD_INPUT with position, path, and what was expected. */
#ifndef PDYN_PARAMS_H
#define PDYN_PARAMS_H

#include "base/param_kind.h"
#include "json_file.h"
#include "scene.h"

struct sphere;

/* ---- keys: param_keys.c ---------------------------------------------------------------------- */

/* Whether a key is in `table` (NULL: no table) or in `others`, which ends with NULL. */
bool params_has_key(const pdyn_param *table, const char *const *others, const char *key);
/* Checks that `object` is an object and each key is in `table` or in `others`. */
pdyn_status params_check_keys(const struct json_at *object, const pdyn_param *table,
                              const char *const *others);

/* Checks that `object` has at most one of the keys in `names`, which ends with NULL (names NULL: no
 * check). */
pdyn_status params_check_alternatives(const struct json_at *object, const char *const *names);

/* ---- by tables: params.c --------------------------------------------------------------------- */

/* Fills `params` by the table; a missing object gives all defaults. Vertex selections, paths,
 * tables and names are zeroed before, and are allocated: params_free frees them, after a failure,
 * too. body: the one whose vertices are selected and whose parts have rows in tables; NULL: these
 * kinds do not occur. */
pdyn_status params_read(const struct json_at *object, const pdyn_param *table,
                        const struct scene_body *body, void *params);
/* Checks that `object` is an object with keys of the table only, and reads it. */
pdyn_status params_read_object(const struct json_at *object, const pdyn_param *table, void *params);
void params_free(pdyn_context *context, const pdyn_param *table, void *params);

/* ---- numbers: param_numbers.c ---------------------------------------------------------------- */

/* Appends e.g. "WHAT from 1 to 2 m". */
void params_describe_bounds(char *text, size_t size, const char *what, double min, double max,
                            const char *unit);

pdyn_status params_real(const struct json_at *at, double min, double max, const char *unit,
                        double *out);
pdyn_status params_int(const struct json_at *at, double min, double max, int *out);
/* Reads an array of exactly `count` whole numbers from `min` to MAX_PARTICLES. */
pdyn_status params_counts(const struct json_at *at, int count, double min, int *out);
/* Reads an array of exactly `count` numbers. */
pdyn_status params_reals(const struct json_at *at, int count, double min, double max,
                         const char *unit, double *out);
/* Reads {"minimum": [..], "maximum": [..]}, m, with minimum < maximum along every axis. */
pdyn_status params_box(const struct json_at *at, struct box *box);
/* Reads {"center": [..], "radius": r}, m. */
pdyn_status params_sphere(const struct json_at *at, struct sphere *sphere);

#endif
