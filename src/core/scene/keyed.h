/* Parameters that a scene gives over time: an array of keys in the place of the value, such as
 * [{"time": 0, "overpressure": 0}, {"time": 2, "overpressure": 500}]. */
#ifndef PDYN_KEYED_H
#define PDYN_KEYED_H

#include "base/snapshot_file.h"
#include "json_file.h"
#include "scene.h"

extern const pdyn_param keyed_time_param; /* of a key: "time", s */

/* Checks that the time of a key, s, is after that of the key before. at: the time. */
pdyn_status keyed_check_time(const struct json_at *at, double before, double time);

/* Whether a parameter of a constraint may have keys: numbers and vectors that can change, and
 * tables with up to three numbers for each part of the body. */
bool keyed_allowed(const pdyn_constraint_type *type, const pdyn_param *param);

/* Whether there are keys at `at`. */
bool keyed_given(const struct json_at *at);
/* Refuses rows of a time and the numbers of the parameter, [[0, 500], [1, 800]]: they have the form
 * of a path of pins, but are meant as keys. */
pdyn_status keyed_refuse_rows(const struct json_at *at, const pdyn_param *param);
/* Reads keys of the parameter, of 1 to 3 numbers each. The caller frees the path, after a failure,
 * too. */
pdyn_status keyed_read_path(const struct json_at *at, const pdyn_param *param, pdyn_path *out);
/* Replaces the keys of a path by others: count x 4. */
pdyn_status keyed_set_path(pdyn_context *context, pdyn_path *path, const double *key, int count);
/* Writes a path into a state, or reads it and checks order and size of its numbers. */
void keyed_persist_path(pdyn_context *context, pdyn_path *path, struct snapshot_file *snapshot);
void keyed_free_path(pdyn_context *context, pdyn_path *path);

/* Reads the parameters of a constraint, with keys or without. keyed_free frees the keys, after a
 * failure, too. */
pdyn_status keyed_read_params(const struct json_at *object, const struct scene_body *body,
                              struct scene_constraint *constraint);
void keyed_free(pdyn_context *context, struct scene_constraint *constraint);

#endif
