/* What a saved state belongs to: hashes of a scene. */
#ifndef PDYN_FINGERPRINT_H
#define PDYN_FINGERPRINT_H

#include "scene.h"

#include <jansson.h>

/* Sets scene->fingerprint from the values of the file; `scene` has been read. */
pdyn_status fingerprint_compute(pdyn_context *context, const json_t *root, struct scene *scene);

/* Hash of the triangles and tetrahedra of bodies, whose vertices are the positions at rest of a
 * saved state, and of the vertices and triangles of solids. */
uint64_t fingerprint_of_meshes(const struct scene *scene);

#endif
