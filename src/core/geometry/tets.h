/* Tetrahedral meshes of soft solids. A struct mesh holds the vertices and the triangles of the
 * surface; struct tets holds the tetrahedra. */
#ifndef PDYN_TETS_H
#define PDYN_TETS_H

#include "mesh.h"

struct tets {
    int count;
    int *corner;    /* count x 4, vertices a, b, c, d with (b - a) x (c - a) . (d - a) > 0 */
    double *volume; /* count, m^3 */
};

/* Reads vertices and tetrahedra: TetGen (NAME.node and NAME.ele, either name is accepted) or Gmsh
 * (.msh, version 2.2 or 4.1, ASCII, linear tetrahedra). Errors as in mesh_read. Triangles and
 * volumes are left to tets_finish. */
pdyn_status tets_read(pdyn_context *context, const char *path, struct mesh *mesh,
                      struct tets *tets);

/* Makes a block of cells[0] x cells[1] x cells[2] cells centred at the origin, size in m, with six
 * tetrahedra per cell (Kuhn 1960). */
pdyn_status tets_grid(pdyn_context *context, const double size[3], const int cells[3],
                      struct mesh *mesh, struct tets *tets);

enum { TETS_MAX_POINTS = 1 << 24 }; /* of the lattice of tets_fill: 200 MB */

/* Fills a mesh that passed mesh_check_closed with tetrahedra by isosurface stuffing (Labelle and
 * Shewchuk 2007): equal ones from a lattice of cubes with edge `cell`, m, inside, and fitted ones
 * along the surface, of which nothing thinner than a cell is kept. PDYN_BAD_INPUT: no tetrahedron
 * is inside, or the lattice has too many points. */
pdyn_status tets_fill(pdyn_context *context, const struct mesh *surface, double cell,
                      struct mesh *mesh, struct tets *tets);

/* Orients all tetrahedra, computes their volumes and the triangles of the surface, which face
 * outward. PDYN_BAD_INPUT: a vertex is unused, a tetrahedron has a volume below 1e-9 of its longest
 * edge cubed, a face has more than two tetrahedra, or an edge of the surface more than two
 * triangles. The error text begins with `name` and counts from 0. */
pdyn_status tets_finish(pdyn_context *context, const char *name, struct mesh *mesh,
                        struct tets *tets);

/* Computes the triangles of the surface, the faces of a single tetrahedron; positions are not used.
 * The mesh has none before. PDYN_BAD_INPUT: a face has more than two tetrahedra. */
pdyn_status tets_find_surface(pdyn_context *context, const char *name, struct mesh *mesh,
                              const struct tets *tets);

/* Counts the pieces that share no vertex with the others and are smaller than `volume`, m^3, except
 * the largest piece, of tetrahedra that passed tets_finish. */
pdyn_status tets_count_small(pdyn_context *context, const struct mesh *mesh,
                             const struct tets *tets, double volume, int *count);

void tets_free(pdyn_context *context, struct tets *tets);

#endif
