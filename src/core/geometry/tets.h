/* Meshes of tetrahedra: what a volume is made of. The vertices and the triangles of the surface are
 * in a mesh, so that a volume is a surface, too. */
#ifndef PDYN_TETS_H
#define PDYN_TETS_H

#include "mesh.h"

struct tets {
    int count;
    int *corner;    /* count x 4: vertices of the mesh, such that (b - a) x (c - a) . (d - a) > 0 */
    double *volume; /* count, m^3 */
};

/* Reads a mesh: NAME.node and NAME.ele of TetGen, by either name; or .msh of Gmsh, version 2.2 or
 * 4.1, ASCII, its linear tetrahedra. Fails as mesh_read does; no triangles and volumes yet. */
pdyn_status tets_read(pdyn_context *context, const char *path, struct mesh *mesh,
                      struct tets *tets);

/* A block around the origin of so many cells, six tetrahedra each (Kuhn 1960). */
pdyn_status tets_grid(pdyn_context *context, const double size[3], const int cells[3],
                      struct mesh *mesh, struct tets *tets);

/* Turns all tetrahedra the same way, and finds volumes and the triangles of the surface, outward.
 * Every vertex is used, every tetrahedron has a volume (more than 1e-9 of its longest edge cubed),
 * no face has more than two, and no edge of the surface has more than two triangles; otherwise
 * PDYN_BAD_INPUT. `name` stands for the mesh in messages, which count from 0. */
pdyn_status tets_finish(pdyn_context *context, const char *name, struct mesh *mesh,
                        struct tets *tets);

void tets_free(pdyn_context *context, struct tets *tets);

#endif
