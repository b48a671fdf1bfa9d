/* projdyn: scenes made by a program. A pdyn_scene is a scene file in memory: the values of its JSON
 * text (docs/guide/scene.md), set one by one, and arrays that stand for the mesh files it names.
 * pdyn_load does the same with a file: it reads it, sets the overrides, and loads.
 *
 *     pdyn_scene *scene = NULL;
 *     pdyn_sim *sim = NULL;
 *     pdyn_scene_create(context, "sheet", &scene);
 *     pdyn_scene_mesh(scene, "sheet.ply", vertices, vertex, triangles, triangle);
 *     pdyn_scene_set(scene, "duration", "2");
 *     pdyn_scene_set(scene, "bodies.sheet.surface.mesh", "sheet.ply");
 *     pdyn_scene_set(scene, "bodies.sheet.surface.area_density", "%.17g", density);
 *     pdyn_scene_set(scene, "bodies.sheet.constraints.spring.stretching_stiffness", "1000");
 *     if (pdyn_scene_load(scene, &sim) != PDYN_OK)
 *         fprintf(stderr, "%s\n", pdyn_last_error(context));
 *     pdyn_scene_free(scene);
 *
 * A scene belongs to one thread at a time. NULL: as in projdyn.h. */
#ifndef PROJDYN_SCENE_H
#define PROJDYN_SCENE_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pdyn_scene pdyn_scene;

/* An empty scene. `name` stands for the file in messages; relative names of mesh files are resolved
 * from the current directory. PDYN_NO_MEMORY. On failure of this and the next two *out is NULL. */
PDYN_API pdyn_status pdyn_scene_create(pdyn_context *context, const char *name, pdyn_scene **out);
/* A scene from a file, to be changed. Checks JSON syntax only. PDYN_BAD_INPUT, PDYN_IO_FAILED,
 * PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_scene_open(pdyn_context *context, const char *path, pdyn_scene **out);
/* A scene from a JSON text. Checks its syntax only. `name` stands for the file in messages;
 * relative names of mesh files are resolved from the current directory. PDYN_BAD_INPUT,
 * PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_scene_parse(pdyn_context *context, const char *text, const char *name,
                                      pdyn_scene **out);
PDYN_API void pdyn_scene_free(pdyn_scene *scene); /* NULL: does nothing */

/* Sets a value. path: keys with dots between them; an element of an array by its name, its type or
 * its index, [0] or .0. What is missing is made: an object of a key, and of an element of "bodies",
 * "solids", "probes" or "constraints" with this name or type; an index as large as the array
 * appends to it, and the index 0 makes the array. The value is printed like printf: a JSON value;
 * or, if the text is no JSON, a string; null removes the value or element. Checks are made by
 * pdyn_scene_load. PDYN_BAD_INPUT: a key leads into a number or string, an index is beyond the
 * array, or there is nothing to remove. */
PDYN_API pdyn_status pdyn_scene_set(pdyn_scene *scene, const char *path, const char *value, ...)
    PDYN_PRINTF(3, 4);
/* Applies `count` overrides "path=value" as pdyn_load does: an element of an array must exist.
 * PDYN_BAD_INPUT: the first override that fails; those before it are applied. */
PDYN_API pdyn_status pdyn_scene_override(pdyn_scene *scene, const char *const *set, int count);

/* Arrays that stand for a file: wherever the scene names `file`, these are taken and no file is
 * read. The arrays are copied. Given again: replaced. `file` is a plain name that ends with .ply,
 * for tetrahedra with .msh. PDYN_BAD_INPUT: another ending, no element, an index out of range or
 * twice in an element, a number that is not finite or larger than a file may have. */

/* A surface. vertex: vertices x 3, m; triangle: triangles x 3, from 0. */
PDYN_API pdyn_status pdyn_scene_mesh(pdyn_scene *scene, const char *file, int vertices,
                                     const double *vertex, int triangles, const int *triangle);
/* A soft solid. tet: tets x 4, from 0. */
PDYN_API pdyn_status pdyn_scene_tets(pdyn_scene *scene, const char *file, int vertices,
                                     const double *vertex, int tets, const int *tet);
/* Particles. x: count x 3, m; v: count x 3, m/s, or NULL: at rest, or as the scene says. */
PDYN_API pdyn_status pdyn_scene_particles(pdyn_scene *scene, const char *file, int count,
                                          const double *x, const double *v);

/* Makes a simulation; the scene can be changed and loaded again. On failure (PDYN_BAD_INPUT,
 * PDYN_IO_FAILED, PDYN_NO_MEMORY) *out is NULL, and pdyn_last_error gives name and JSON path, for a
 * scene with a text also line and column. */
PDYN_API pdyn_status pdyn_scene_load(pdyn_scene *scene, pdyn_sim **out);

/* Passes the JSON text of the scene to `write`; it is valid during the call. PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_scene_text(pdyn_scene *scene, void (*write)(void *user, const char *text),
                                     void *user);
/* Writes the scene to the file `path`, and its arrays to files of their names beside it: loaded
 * from there it has the same bits. Relative names of other files are not changed. Files appear
 * complete or not at all. PDYN_BAD_INPUT: `path` is a file of arrays. PDYN_IO_FAILED. */
PDYN_API pdyn_status pdyn_scene_write(pdyn_scene *scene, const char *path);

#ifdef __cplusplus
}
#endif
#endif
