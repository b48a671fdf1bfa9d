/* Reads what `projdyn run` wrote: its own VTK files and nothing else. */
#ifndef FRAMES_H
#define FRAMES_H

#include <stdbool.h>
#include <stddef.h>

/* Owns its arrays. */
struct frame {
    int count;       /* points */
    int triangles;   /* of a surface; 0: every point is a cell */
    float *x;        /* m,      count x 3 */
    float *velocity; /* m/s,    count x 3; NULL in a file of boundary points */
    float *density;  /* kg/m^3, count; only of particles */
    float *pressure; /* Pa,     count; only of particles */
    int *triangle;   /* triangles x 3 */
};

/* All return EXIT_GOOD; or print a message that names the file and what was expected, leave nothing
 * to be freed and return EXIT_BAD_INPUT (EXIT_FAILED: out of memory). Memory is bounded by the size
 * of the file. */
int frame_read(const char *path, struct frame *frame);
int frame_read_boundary(const char *path, struct frame *frame); /* points without data */
/* A regular file as a whole, with a NUL after its end; to be freed. */
int file_read(const char *path, char **text, size_t *size);

void frame_free(struct frame *frame);

#endif
