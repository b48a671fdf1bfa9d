/* A mesh or particle file while it is parsed, and the arrays built from it. Private to mesh_file.c
 * and the parsers of the formats. */
#ifndef PDYN_MESH_FILE_H
#define PDYN_MESH_FILE_H

#include "base/scan.h"
#include "mesh.h"

struct mesh_array {
    void *data;
    size_t bytes;
};

struct mesh_file {
    struct scan in;
    bool only_points; /* read vertices and velocities, not faces */
    int first_index;  /* index of the first vertex in the format: 0 or 1 */
    /* the mesh read so far */
    int vertices, triangles, faces;
    int velocities;
    struct mesh_array vertex, triangle, velocity;
    struct mesh_array last_face; /* vertices: the last face that used each vertex, counted from 1 */
    int corners;                 /* of the current face: number of corners, */
    int first, previous;         /* first and previous corner */
};

/* Parsers of the formats; each reads the whole file. */
pdyn_status mesh_obj_parse(struct mesh_file *file);
pdyn_status mesh_ply_parse(struct mesh_file *file);
pdyn_status mesh_stl_parse(struct mesh_file *file);
pdyn_status mesh_vtk_parse(struct mesh_file *file); /* for particles only */

/* Moves an array out of the file, shrunk to `bytes`. NULL: no memory. */
void *mesh_file_detach(const struct mesh_file *file, struct mesh_array *array, size_t bytes);
void mesh_file_release(struct mesh_file *file);

/* Grows an array to at least `bytes`; false: no memory. */
bool mesh_file_reserve(const struct mesh_file *file, struct mesh_array *array, size_t bytes);

/* Append a vertex, a velocity, or a polygon, corner by corner, as a triangle fan. `index` counts
 * from 0. Coordinates, indices and numbers of elements are checked. */
pdyn_status mesh_file_vertex(struct mesh_file *file, const double x[3]);
pdyn_status mesh_file_velocity(struct mesh_file *file, const double v[3]);
void mesh_file_begin_face(struct mesh_file *file);
pdyn_status mesh_file_corner(struct mesh_file *file, int index);
pdyn_status mesh_file_end_face(const struct mesh_file *file);

#endif
