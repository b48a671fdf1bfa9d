/* What `projdyn mesh` reads from the directory of a run. */
#ifndef MESH_INPUT_H
#define MESH_INPUT_H

#include "obstacles.h"
#include "run_directory.h"

/* Reads the triangles of all surface bodies and solids at frame f and builds their tree. The caller
 * frees *out in any case. Returns an exit code, after a message unless it is EXIT_GOOD. */
int mesh_read_obstacles(const struct run *run, int f, struct obstacles *out);

#endif
