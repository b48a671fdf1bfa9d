/* Triangle meshes and particles: files, checks, orientation, sizes, and the topology that
 * constraints need. */
#ifndef PDYN_MESH_H
#define PDYN_MESH_H

#include "base/context.h"
#include "projdyn/module.h"

enum { MESH_MAX = INT32_MAX / 8 }; /* vertices or triangles: 6 x MESH_MAX fits int */
#define MESH_MAX_COORDINATE 1e12   /* m: squares and products stay finite */
#define MESH_MAX_SPEED      1e6    /* m/s, of particles in a file */

struct mesh {
    int vertices;
    double *vertex; /* vertices x 3, m */
    int triangles;
    int *triangle; /* triangles x 3, indices of vertices */
};

/* Allocates a mesh, zeroed. PDYN_NO_MEMORY: *out is empty. */
pdyn_status mesh_allocate(pdyn_context *context, int vertices, int triangles, struct mesh *out);
void mesh_free(pdyn_context *context, struct mesh *mesh);

/* The vertices of triangle t. */
static inline void mesh_corners(const struct mesh *mesh, int t, const double *corner[3]) {
    for (int c = 0; c < 3; c++)
        corner[c] = mesh->vertex + 3 * (size_t)mesh->triangle[3 * (size_t)t + (size_t)c];
}

/* ---- files (mesh_file.c, one file for each format) ------------------------------------------- */

/* Reads a triangle mesh; the ending of the name, .obj, .ply or .stl (ASCII, binary),
 * chooses the format. Polygons become triangle fans. Ensures: coordinates are finite and at most
 * 1e12 m, indices are in range, no face uses a vertex twice, there is at least one triangle.
 * PDYN_BAD_INPUT: the error text has file, line (or byte) and what was expected. PDYN_IO_FAILED:
 * the file cannot be read. On failure *out is empty. Cloth needs mesh_check_cloth in addition. */
pdyn_status mesh_read(pdyn_context *context, const char *path, struct mesh *out);

/* Prepares the text of an OBJ file for readers of single lines, in place. A byte order mark becomes
 * blanks. Lines that end with '\' are joined with the next one: "f 1 2 \", "3" become "f 1 2  3"
 * and an empty line, so that later lines keep their numbers. Comments end at their line. */
void mesh_obj_join_lines(char *text, size_t size);

struct particles {
    int count;
    double *x; /* count x 3, m */
    double *v; /* count x 3, m/s; NULL: the file has no velocities */
};

/* Reads particles; the ending of the name chooses the format: .ply (velocities vx, vy, vz) or .vtk
 * (legacy format before version 5; velocities are the vectors named "velocity"). Coordinates are
 * limited as in mesh_read, velocities are finite and at most 1e6 m/s. Errors as in mesh_read. */
pdyn_status particles_read(pdyn_context *context, const char *path, struct particles *out);
void particles_free(pdyn_context *context, struct particles *particles);

/* ---- grids and checks of any mesh (mesh.c) --------------------------------------------------- */

/* Makes a rectangular sheet in the x-z plane, centred at the origin: size[0] x size[1] m,
 * vertices[0] x vertices[1] points (each at least 2), alternating diagonals. The middle hangs
 * `sag`, m, below the border, with a parabolic profile along both sides. */
pdyn_status mesh_grid(pdyn_context *context, const double size[2], const int vertices[2],
                      double sag, struct mesh *out);

/* Applies the checks of mesh_read to a mesh from another source. The error text begins with `name`
 * and counts vertices and triangles from 0. */
pdyn_status mesh_check(const struct mesh *mesh, const char *name);

/* ---- checks of cloth and of closed meshes (mesh_checks.c) ------------------------------------ */

/* Checks what cloth needs in addition to mesh_check: every vertex belongs to a triangle (it would
 * have no mass), every triangle has an area of more than 1e-12 of its longest edge squared, no edge
 * has more than two triangles, no two triangles have the same vertices. Solids do not need this,
 * because their surface is only sampled. */
pdyn_status mesh_check_cloth(pdyn_context *context, const struct mesh *mesh, const char *name);

/* The checks of mesh_check_cloth for edges: at most two triangles, no duplicate triangles. */
pdyn_status mesh_check_edges(pdyn_context *context, const struct mesh *mesh, const char *name);

/* Calls visit(user, vertex) for both ends of every edge of more than two triangles. */
pdyn_status mesh_visit_crowded_edges(pdyn_context *context, const struct mesh *mesh,
                                     void (*visit)(void *user, int vertex), void *user);

/* Checks that each of `vertices` vertices is among `count` indices; `what` is what they form. */
pdyn_status mesh_check_used(pdyn_context *context, const char *name, int vertices, const int *index,
                            int count, const char *what);

/* Checks what a closed volume needs in addition to mesh_check: every edge has an even number of
 * triangles, so that inside and outside are defined. */
pdyn_status mesh_check_closed(pdyn_context *context, const struct mesh *mesh, const char *name);

/* Checks what a volume of gas needs in addition to mesh_check_closed: triangles all face outwards
 * or all inwards, and enclose a volume. */
pdyn_status mesh_check_encloses(pdyn_context *context, const struct mesh *mesh, const char *name);

/* Checks what a rigid body needs in addition to mesh_check_closed and mesh_check_cloth: the
 * triangles of every edge have the same orientation. */
pdyn_status mesh_check_oriented(pdyn_context *context, const struct mesh *mesh, const char *name);

/* ---- orientation (mesh_pieces.c) ------------------------------------------------------------- */

/* Turns triangles of a closed mesh that face another way than most of their piece, then pieces that
 * face another way than the rest: afterwards all pieces face outwards, except hollows, which lie
 * inside another piece and face inwards (mesh_pieces.c); or all the other way round, if no piece
 * was turned. A surface with one side, as a Klein bottle, stays without orientation
 * (mesh_check_oriented). */
struct mesh_turned {
    int triangles; /* turned, in their piece */
    int pieces;    /* turned */
    int crossing;  /* pieces that are partly inside another one */
};
pdyn_status mesh_orient_pieces(pdyn_context *context, struct mesh *mesh,
                               struct mesh_turned *turned);

/* Turns all triangles. */
void mesh_turn(struct mesh *mesh);

/* ---- sizes (mesh_sizes.c) -------------------------------------------------------------------- */

/* The area of triangle t, m^2. */
double mesh_triangle_area(const struct mesh *mesh, int t);
/* Sum of the areas of all triangles, m^2. */
double mesh_area(const struct mesh *mesh);

/* The volume that triangles (vertices of x) enclose, m^3; negative where they face inwards. */
double mesh_volume(int triangles, const int *triangle, const double *x);

/* Volume, m^3, centre, m, and second moments about the centre over the volume, m^2 (symmetric, row
 * by row), of the inside of a closed mesh whose triangles are oriented; the volume is negative
 * where they are so inwards. Sums over the tetrahedra between the triangles and a vertex. */
double mesh_moments(const struct mesh *mesh, double centre[3], double second[9]);

/* Intersects edge pq, whose ends lie on different sides of z, with that plane: (x, y) of the point,
 * with the same bits for qp. */
static inline void mesh_cut_edge(const double *p, const double *q, double z, double at[2]) {
    const double *low = p[2] < q[2] ? p : q, *high = p[2] < q[2] ? q : p;
    double t = (z - low[2]) / (high[2] - low[2]);
    for (int a = 0; a < 2; a++) at[a] = low[a] + t * (high[a] - low[a]);
}

/* ---- edges and neighbours (topology.c) ------------------------------------------------------- */

/* Edges, areas, borders and neighbouring triangles of a mesh that passed mesh_check_cloth. The
 * arrays have the meaning of the members of pdyn_body with the same names (module.h).
 * PDYN_NO_MEMORY: *out is empty. */
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

/* Counts the vertices that have the same position, but for rounding, as another one. */
pdyn_status mesh_count_duplicates(pdyn_context *context, const struct mesh *mesh, int *count);

/* Finds the border of any mesh, where vertices at the same place count as one. across: triangles x
 * 3, for each corner -1 if no other triangle has the side opposite to it, else 0. */
pdyn_status mesh_find_border(pdyn_context *context, const struct mesh *mesh, int *across);

/* Writes the edges of a mesh, each once, as pairs of vertices that count from `first`. edge: room
 * for 3 x triangles pairs. Returns the number of edges. */
int mesh_edges(const struct mesh *mesh, int first, int *edge);

#endif
