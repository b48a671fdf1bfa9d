/* What a saved state belongs to: hashes of a scene. */
#ifndef PDYN_FINGERPRINT_H
#define PDYN_FINGERPRINT_H

#include "scene.h"

#include <jansson.h>

/* The key of the scene that a fingerprint is of, 0 <= k < FINGERPRINTS. */
const char *fingerprint_key(int k);

/* Sets the fingerprints of `scene`, which has been read, from the values of the file. */
pdyn_status fingerprint_compute(pdyn_context *context, const json_t *root, struct scene *scene);

/* Hash of the triangles and tetrahedra of bodies, whose vertices are the positions at rest of a
 * saved state, and of the vertices and triangles of solids. */
uint64_t fingerprint_of_meshes(const struct scene *scene);

#endif
