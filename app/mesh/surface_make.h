/* The surface of a fluid in a frame of a run. `mesh` writes it, `render` draws it. */
#ifndef SURFACE_MAKE_H
#define SURFACE_MAKE_H

#include "run_directory.h"
#include "surface.h"

/* Makes the surface of a fluid at frame f; it ends at cloth, soft bodies and solids. drops: with a
 * ball for each particle without neighbours. The caller frees *out in any case. Returns an exit
 * code, after a message unless it is EXIT_GOOD. */
int surface_make(const struct run *run, const struct part *part, int f, bool drops, int threads,
                 struct surface *out);

/* Reads the skin of a body in frame f, with normals. The caller frees *out in any case. */
int surface_carry(const struct run *run, const struct part *part, int f, int threads,
                  struct surface *out);

#endif
