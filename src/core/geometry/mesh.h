/* Triangle meshes: reading OBJ and PLY, and the neighbourhood that constraints need. Points without
 * triangles, from PLY and VTK. */
#ifndef PDYN_MESH_H
#define PDYN_MESH_H

#include "base/context.h"
#include "projdyn/module.h"

struct mesh {
    int vertices;
    double *vertex; /* vertices x 3, m */
    int triangles;
    int *triangle; /* triangles x 3 */
};

/* Reads a mesh by the ending of its name, .obj or .ply (ASCII, binary little or big endian).
 * Polygons become triangle fans. Every coordinate is finite and at most 1e12 m, every index in
 * range, no face uses a vertex twice, there is at least one triangle; anything else fails with file
 * and line (or byte) and what was expected: PDYN_BAD_INPUT, or PDYN_IO_FAILED where the file cannot
 * be read. On failure *out is empty. What only cloth asks for is left to mesh_check_cloth. */
pdyn_status mesh_read(pdyn_context *context, const char *path, struct mesh *out);

/* A rectangular sheet in the x-z plane, centred at the origin: size[0] along x, size[1] along z,
 * vertices[0] x vertices[1] points (each at least 2), diagonals alternating. Its middle hangs `sag`
 * below its border, parabolic along both sides. */
pdyn_status mesh_grid(pdyn_context *context, const double size[2], const int vertices[2],
                      double sag, struct mesh *out);

/* The checks of mesh_read on a mesh from elsewhere; `name` stands for the mesh in the message,
 * which counts vertices and triangles from 0. */
pdyn_status mesh_check(pdyn_context *context, const struct mesh *mesh, const char *name);

/* What a sheet needs on top of mesh_check: every vertex is used by a triangle (it would have no
 * mass), every triangle has an area (more than 1e-12 of its longest edge squared), no edge has more
 * than two triangles, no two triangles have the same vertices. A solid, whose surface is only
 * sampled, does without. */
pdyn_status mesh_check_cloth(pdyn_context *context, const struct mesh *mesh, const char *name);

/* The part of it about edges. */
pdyn_status mesh_check_edges(pdyn_context *context, const struct mesh *mesh, const char *name);

/* How many vertices lie where another one does already. */
pdyn_status mesh_count_duplicates(pdyn_context *context, const struct mesh *mesh, int *count);

/* What a volume needs on top of mesh_check: no edge has an odd number of triangles, so that there
 * is an inside. */
pdyn_status mesh_check_closed(pdyn_context *context, const struct mesh *mesh, const char *name);

void mesh_free(pdyn_context *context, struct mesh *mesh);

struct particles {
    int count;
    double *x; /* count x 3, m */
    double *v; /* count x 3, m/s; NULL: the file gives none */
};

/* Reads points by the ending of the file's name, .ply (vx, vy, vz are their velocities) or .vtk
 * (legacy, before version 5; vectors named "velocity"). Coordinates are as those of mesh_read,
 * velocities finite and at most 1e6 m/s. Fails as mesh_read does. */
pdyn_status particles_read(pdyn_context *context, const char *path, struct particles *out);
void particles_free(pdyn_context *context, struct particles *particles);

/* Edges, areas, borders and neighbouring triangles of a mesh that passed
 * mesh_check_cloth, as pdyn_body wants them (see module.h). Fails only without memory; *out is then
 * empty. */
struct topology {
    int vertices, edges;
    double *vertex_area;
    int *edge;
    double *edge_share;
    bool *on_border;
    int triangles;
    int *across;
    double *triangle_area;
};
pdyn_status topology_build(pdyn_context *context, const struct mesh *mesh, struct topology *out);
void topology_free(pdyn_context *context, struct topology *topology);

#endif
