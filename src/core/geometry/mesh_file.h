/* A mesh or particle file, or one of rows of numbers, in memory, parsed from front to back, and the
 * arrays built from it. Private to mesh_file.c and the parsers of the formats. */
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
    const char *at;   /* current position */
    const char *last; /* start of the last word or value, for error messages */
    long line;
    bool only_points; /* read vertices and velocities, not faces */
    bool binary;      /* error messages give the byte, not the line */
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

/* Reads the file at `path` into memory. The caller sets `line`. */
pdyn_status mesh_file_load(struct mesh_file *file);
/* Moves an array out of the file, shrunk to `bytes`. NULL: no memory. */
void *mesh_file_detach(const struct mesh_file *file, struct mesh_array *array, size_t bytes);
void mesh_file_release(struct mesh_file *file);

/* A word of a line; length 0: the line has no further word. */
struct mesh_word {
    const char *text;
    size_t length;
};
struct mesh_word mesh_file_word(struct mesh_file *file);
void mesh_file_next_line(struct mesh_file *file);
/* Skips blanks and line ends up to the next word, or to the end of the file. */
void mesh_file_skip_blank(struct mesh_file *file);
bool mesh_file_at_end(const struct mesh_file *file);
bool mesh_word_is(struct mesh_word word, const char *text);
bool mesh_word_number(struct mesh_word word, double *value);

/* The number, of at most 8 bytes, at a place of the file; big: the most significant byte is first.
 */
uint64_t mesh_bits(const char *at, size_t size, bool big);
/* Converts a bit pattern to the number it represents. */
double mesh_from_float(uint64_t bits);
double mesh_from_double(uint64_t bits);

/* Sets the error text with file and position; returns PDYN_BAD_INPUT. */
pdyn_status mesh_file_fail(const struct mesh_file *file, const char *format, ...) PDYN_PRINTF(2, 3);
pdyn_status mesh_file_expected(const struct mesh_file *file, const char *what,
                               struct mesh_word found);

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
