/* Shared by the readers of a scene: scene.c (whole scene), settings.c ("solver", "time_step"),
 * scene_body.c (bodies), scene_solid.c (solids) and scene_probe.c (probes). */
#ifndef PDYN_READER_H
#define PDYN_READER_H

#include "json_file.h"
#include "scene.h"

enum { READER_NAMES = 64 }; /* largest number of names in a list */

/* state while a scene is read */
struct reader {
    pdyn_context *context;
    struct scene *scene;
    double particles;          /* number in all bodies so far */
    struct scene_body *listed; /* the first body with an operator on neighbour lists; NULL: none */
    struct scene_body *body;   /* the current one */
    struct scene_solid *solid; /* the current one */
};

typedef pdyn_status read_fn(struct reader *r, const struct json_at *at, int index);

/* ---- parts of a scene, and elements of its arrays -------------------------------------------- */

pdyn_status settings_read(struct reader *r, const struct json_at *root);
read_fn scene_read_body, scene_read_solid, scene_read_probe;

/* Turns the pieces of the current body's closed mesh that face another way than the rest
 * (mesh_orient_pieces), with a message. */
pdyn_status reader_orient_pieces(struct reader *r);

/* Adds to the number of particles in the scene so far. PDYN_BAD_INPUT: more than MAX_PARTICLES. */
pdyn_status reader_add_particles(struct reader *r, const struct json_at *at, double count);

/* How far the vertices of a round shape may be outside of its triangles, m: what contact does not
 * feel. 0: there is no contact. */
double reader_bump(const struct reader *r);

/* ---- names and arrays ------------------------------------------------------------------------ */

/* Fails with "unknown WHAT "word"", a suggestion and the known names. */
pdyn_status reader_fail_word(const struct json_at *at, const char *what, const char *const *names,
                             int count);
/* Index of the name at `at` in `names`; 0 if it is missing. */
pdyn_status reader_choice(const struct json_at *at, const char *what, const char *const *names,
                          int count, int *out);
/* The constraint type of this name, built-in or of a plug-in. */
pdyn_status reader_constraint_type(const struct json_at *at, const pdyn_constraint_type **out);
/* Index of the key in `names` that the object has; out NULL: checks alone. PDYN_BAD_INPUT: it has
 * none or several. */
pdyn_status reader_one_of(const struct json_at *at, const char *const *names, int count, int *out);
/* The name of a body, a solid or a probe, allocated; default: kind and index, e.g. "body0". */
pdyn_status reader_name(struct reader *r, const struct json_at *owner, const char *kind, int index,
                        char **out);

/* The "color" of a body or a solid; "" without one. */
pdyn_status reader_color(const struct json_at *owner, char out[8]);

/* Length of an array; 0 if it is missing. PDYN_BAD_INPUT: not an array; `what` was expected. */
pdyn_status reader_count(const struct json_at *array, const char *what, int *out);
/* Calls `read` for every element of an array; does nothing if it is missing. */
pdyn_status reader_each(struct reader *r, const struct json_at *array, read_fn *read);
/* Allocates *items, an array of elements of `size` bytes, one per element of a JSON array that may
 * be missing, sets *count and calls `read` for every element. items: address of the pointer to the
 * array. The caller frees it, after a failure, too. */
pdyn_status reader_array(struct reader *r, const struct json_at *array, const char *what,
                         read_fn *read, size_t size, void *items, int *count);

#endif
