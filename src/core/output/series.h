/* The series of a part of the frames: NAME.vtk.series, which lists its files with their times. */
#ifndef PDYN_SERIES_H
#define PDYN_SERIES_H

#include "writer.h"

/* A part of a frame, one file: of a body, the moving boundary points, or a moving solid. */
struct part {
    const char *folder, *name; /* folder: "" or SOLIDS_FOLDER; name NULL: the part is at rest */
    int body, solid;           /* index; -1: none */
};

/* Writes the series of the first `frames` frames. Nothing for a part at rest. */
pdyn_status series_write(pdyn_writer *writer, struct part part, int frames);
/* Lists frame f. Call in the C locale. A file that is not the series of the frames before is
 * replaced. */
pdyn_status series_append(pdyn_writer *writer, struct part part, int f);

#endif
