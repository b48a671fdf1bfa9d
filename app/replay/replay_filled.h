/* How densely the particles of a fluid surround each of them: drops and films are drawn by it. */
#ifndef REPLAY_FILLED_H
#define REPLAY_FILLED_H

#include "vtk_frame.h"

/* Values 0...1 of frame->count particles: 1 inside the fluid, 0.19 for a lone particle. The caller
 * frees them; NULL if memory ran out. radius: of the particles, m */
double *replay_find_filled(const struct vtk_frame *frame, double radius);

#endif
