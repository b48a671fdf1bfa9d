/* Vertices of a surface that a scene selects: {"all": true}, {"vertices": [..]}, {"box": ..},
 * {"sphere": ..} or {"border": true}, or an array of these. */
#ifndef PDYN_VERTEX_SELECTION_H
#define PDYN_VERTEX_SELECTION_H

#include "json_file.h"
#include "scene.h"

/* out->index is allocated; params_free frees it. surface NULL: a body of particles, of which
 * nothing can be selected. PDYN_BAD_INPUT: also where no vertex is selected. */
pdyn_status vertex_selection_read(const struct json_at *at, const struct mesh *surface,
                                  pdyn_vertices *out);

#endif
