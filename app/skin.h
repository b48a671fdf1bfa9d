/* Skin of a body that `cell` has filled: the mesh of its scene, in DIR/NAME.skin.vtk, whose points
 * follow the vertices of the body. */
#ifndef SKIN_H
#define SKIN_H

#include "vtk_frame.h"

/* Replaces the points, velocities and triangles of a frame of the body by those of the skin,
 *
 *     x = y_0 + sum_k w_k (y_k - y_0),     k = 1 .. 3
 *
 * path: of the frame, for messages. Returns an exit code. */
int skin_carry(const struct vtk_frame *skin, const char *path, struct vtk_frame *frame);

#endif
