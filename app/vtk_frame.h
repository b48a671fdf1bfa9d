/* Reader for the VTK files that `projdyn run` and `projdyn mesh` write (legacy VTK 4.2, binary, big
 * endian). It accepts exactly this layout, not VTK in general. */
#ifndef VTK_FRAME_H
#define VTK_FRAME_H

#include "projdyn/box.h"

/* Points of one body at one time. Owns its arrays. */
struct vtk_frame {
    int count;       /* points */
    int triangles;   /* triangles of a surface; 0: the file has one vertex cell per point */
    float *x;        /* positions, m,       count x 3 */
    float *velocity; /* m/s,                count x 3; NULL in a file without data */
    float *normal;   /* length 1,           count x 3; NULL but in the surface of a fluid */
    float *density;  /* kg/m^3,             count; NULL for a surface */
    float *pressure; /* Pa,                 count; NULL for a surface */
    int *triangle;   /* corner indices,     triangles x 3 */
    int *vertex;     /* of a skin: vertices of the body that a point follows,  count x 4 */
    float *weight;   /* of a skin: their weights,                              count x 4 */
};

/* Reads a body's points with their data; vtk_frame_read_geometry() reads a file without data, of
 * boundary points or a solid. Memory is bounded by the size of the file. Both return EXIT_GOOD; or
 * print a message with the file, the byte offset and the expected content, leave nothing to be
 * freed and return EXIT_BAD_INPUT (EXIT_FAILED: out of memory). */
int vtk_frame_read(const char *path, struct vtk_frame *frame);
int vtk_frame_read_geometry(const char *path, struct vtk_frame *frame);
/* Reads the skin of a body, NAME.skin.vtk: x, triangle, vertex and weight. Returns as these. */
int vtk_frame_read_skin(const char *path, struct vtk_frame *frame);

/* Extends a box to contain all points. */
void vtk_frame_extend_box(struct box *box, const struct vtk_frame *frame);

void vtk_frame_free(struct vtk_frame *frame);

#endif
