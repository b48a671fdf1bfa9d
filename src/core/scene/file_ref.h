/* Files that a scene names: meshes, particles, plug-ins. */
#ifndef PDYN_FILE_REF_H
#define PDYN_FILE_REF_H

#include "json_file.h"
#include "scene.h"

/* Reads the file whose name is the value at `at`, or copies the arrays that stand for it. Errors:
 * as mesh_read, tets_read and particles_read, with the place in the scene. obj: gets the path of an
 * OBJ file, which the caller frees with context_free_text; NULL: not wanted. */
pdyn_status file_ref_mesh(const struct json_at *at, struct mesh *mesh, char **obj);
pdyn_status file_ref_tets(const struct json_at *at, struct mesh *mesh, struct tets *tets);
pdyn_status file_ref_particles(const struct json_at *at, struct particles *particles);

/* Computes the path of the file whose name is the value at `at`: a relative name is resolved from
 * the folder of the scene file, or from the current directory for a scene given as text. *path:
 * the caller frees it with context_free_text, after a failure, too. It is noted as a source.
 * PDYN_BAD_INPUT: the value is no string; `what` was expected. */
pdyn_status file_ref_path(const struct json_at *at, const char *what, char **path);

#endif
