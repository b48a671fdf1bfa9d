/* Reading a body: one file for each kind, and one for constraints. */
#ifndef PDYN_SCENE_BODY_H
#define PDYN_SCENE_BODY_H

#include "reader.h"

struct scene_kind {            /* a kind of bodies */
    const char *name;          /* the key of a body whose value, an object, has the keys below */
    const pdyn_param *params;  /* keys of numbers: read first, into the scene_body */
    const char *const *others; /* the other keys; ends with NULL */
    pdyn_status (*read)(struct reader *r, const struct json_at *at); /* reads the other keys */
};
enum { SCENE_KINDS = 4 };
extern const struct scene_kind scene_particles, scene_surface, scene_volume, scene_rigid;
extern const struct scene_kind *const scene_kinds[SCENE_KINDS];

/* Keys of a body: its velocity; the others, names of kinds included. */
extern const pdyn_param scene_body_params[];
extern const char *const scene_body_others[];

/* Reads the array "constraints" of the current body, which may be missing. */
pdyn_status scene_read_constraints(struct reader *r, const struct json_at *array);

#endif
