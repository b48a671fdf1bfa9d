/* Files of a surface. */
#ifndef SURFACE_FILE_H
#define SURFACE_FILE_H

#include "surface.h"

#include <stdio.h>

struct surface_format {
    const char *name; /* argument of --format, and the ending of the files */
    void (*write)(FILE *file, const struct surface *surface, const char *title);
};

/* vtk: the layout of the frames of a run, and normals after the velocity. ply: binary, little
 * endian. obj: positions and normals; the format has no velocities. The last name is NULL. */
extern const struct surface_format surface_formats[];

/* Writes a file, completely or not at all. title: of the VTK file. Returns an exit code, after a
 * message unless it is EXIT_GOOD. */
int surface_write(const struct surface *surface, const struct surface_format *format,
                  const char *path, const char *title);

#endif
