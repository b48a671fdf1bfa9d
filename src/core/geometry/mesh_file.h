/* A file of a mesh or of points in memory, read from front to back, and what grows from it. Shared
 * by mesh.c and the file formats only. */
#ifndef PDYN_MESH_FILE_H
#define PDYN_MESH_FILE_H

#include "mesh.h"

struct mesh_array {
    void *data;
    size_t bytes;
};

struct mesh_file {
    pdyn_context *context;
    const char *path;
    char *data; /* size bytes and a closing NUL */
    size_t size;
    const char *at;   /* how far it is read */
    const char *last; /* where the last word or value begins */
    long line;
    bool only_points; /* with their velocities, no faces */
    bool binary;      /* messages tell places by byte, not by line */
    int first_index;  /* what the format calls the first vertex */
    /* the mesh so far */
    int vertices, triangles, faces;
    int velocities;
    struct mesh_array vertex, triangle, velocity;
    struct mesh_array last_face;  /* per vertex: the last face that used it, counted from 1 */
    int corners, first, previous; /* of the current face */
};

/* The formats; each reads all of the file. */
pdyn_status mesh_obj_parse(struct mesh_file *file);
pdyn_status mesh_ply_parse(struct mesh_file *file);
pdyn_status mesh_vtk_parse(struct mesh_file *file); /* only points */

/* Loads the file at `path`; line and all else are the caller's. */
pdyn_status mesh_file_load(struct mesh_file *file);
/* Gives an array away with no room to spare. */
void *mesh_file_detach(const struct mesh_file *file, struct mesh_array *array, size_t bytes);
void mesh_file_release(struct mesh_file *file);

/* Words of a line; a length of 0 says that the line has no more. */
struct mesh_word {
    const char *text;
    size_t length;
};
struct mesh_word mesh_file_word(struct mesh_file *file);
void mesh_file_next_line(struct mesh_file *file);
/* Goes to the next word, over ends of lines too, or to the end of the file. */
void mesh_file_skip_blank(struct mesh_file *file);
bool mesh_file_at_end(const struct mesh_file *file);
bool mesh_word_is(struct mesh_word word, const char *text);
bool mesh_word_number(struct mesh_word word, double *value);

/* The numbers that such bits stand for. */
double mesh_from_float(uint64_t bits);
double mesh_from_double(uint64_t bits);

/* Errors at the place reached: PDYN_BAD_INPUT. */
pdyn_status mesh_file_fail(const struct mesh_file *file, const char *format, ...) PDYN_PRINTF(2, 3);
pdyn_status mesh_file_expected(const struct mesh_file *file, const char *what,
                               struct mesh_word found);

/* Makes room for that many bytes in all; false: no memory. */
bool mesh_file_reserve(const struct mesh_file *file, struct mesh_array *array, size_t bytes);

/* Adds a vertex, or a polygon corner by corner as a fan; index counts from 0. */
pdyn_status mesh_file_vertex(struct mesh_file *file, const double x[3]);
pdyn_status mesh_file_velocity(struct mesh_file *file, const double v[3]);
void mesh_file_begin_face(struct mesh_file *file);
pdyn_status mesh_file_corner(struct mesh_file *file, int index);
pdyn_status mesh_file_end_face(const struct mesh_file *file);

#endif
