/* Queries of points against a triangle mesh: is a point close to it, is it inside? */
#ifndef PDYN_MESH_QUERY_H
#define PDYN_MESH_QUERY_H

#include "bvh.h"
#include "mesh.h"

struct mesh_query {
    const struct mesh *mesh; /* not copied; its vertices must stay where they are */
    struct box bounds;
    struct box *box; /* triangles: bounding boxes */
    struct bvh tree; /* of these */
};

/* PDYN_NO_MEMORY: nothing is left to free. */
pdyn_status mesh_query_create(pdyn_context *context, const struct mesh *mesh,
                              struct mesh_query *out);
void mesh_query_free(pdyn_context *context, struct mesh_query *query);

/* Whether the mesh is closer to x than a distance, m. */
bool mesh_query_is_close(const struct mesh_query *query, const double x[3], double distance);

/* Whether x is inside a closed mesh: a ray from x along +x crosses it an odd number of times.
 * Whether an edge counts for two triangles depends on its two ends alone, so no ray slips through.
 */
bool mesh_query_contains(const struct mesh_query *query, const double x[3]);

/* The same for the mesh without the triangles t with of[t] == own. */
bool mesh_query_contains_others(const struct mesh_query *query, const double x[3], const int *of,
                                int own);

#endif
