/* What the readers of a scene's parts share. scene.c reads the scene, settings.c how it is solved,
 * scene_body.c a body with its constraints, scene_solid.c a solid. */
#ifndef PDYN_READER_H
#define PDYN_READER_H

#include "json_file.h"
#include "scene.h"

enum { READER_NAMES = 64 }; /* of one kind, at most; and characters of a name */

/* What is known while a scene is read. */
struct reader {
    pdyn_context *context;
    struct scene *scene;
    double particles;          /* so far, in all bodies */
    struct scene_body *listed; /* the body whose constraints are operators on neighbour lists, or
                                  NULL: lists are made of one body of particles */
    struct scene_body *body;   /* being read */
    struct scene_solid *solid; /* being read */
};

typedef pdyn_status read_fn(struct reader *r, const struct json_at *at, int index);

/* ---- the parts: of a whole scene, and elements of its arrays --------------------------------- */

pdyn_status settings_read(struct reader *r, const struct json_at *root);
read_fn scene_read_body, scene_read_solid;

/* ---- words and arrays ------------------------------------------------------------------------ */

pdyn_status reader_copy_text(pdyn_context *context, const char *text, char **out);

/* Fails with what is known instead of the word at `at`. */
pdyn_status reader_fail_word(const struct json_at *at, const char *what, const char *const *names,
                             int count);
/* The index of the word among `names`; a missing word is the first. */
pdyn_status reader_choice(const struct json_at *at, const char *what, const char *const *names,
                          int count, int *out);
/* Exactly one of these keys: its index. */
pdyn_status reader_one_of(const struct json_at *at, const char *const *names, int count, int *out);
/* The name of a body or solid; without one, its kind and index. */
pdyn_status reader_name(struct reader *r, const struct json_at *owner, const char *kind, int index,
                        char **out);

/* The length of an array that may be missing. */
pdyn_status reader_count(const struct json_at *array, const char *what, int *out);
/* Calls `read` for every element of an array; a missing array has none. */
pdyn_status reader_each(struct reader *r, const struct json_at *array, read_fn *read);

#endif
