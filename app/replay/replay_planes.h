/* Coding of the frames for the page. Each frame of a part is a set of planes with one number per
 * point, quantised, predicted from the frames before and compressed. A part at rest has one frame.
 *
 *     planes of a part   x, y, z with 16 bits; its channels (enum channel) with 8 bits
 *     bytes of a plane   predictor, high bytes of the residuals (16 bits only), low bytes */
#ifndef REPLAY_PLANES_H
#define REPLAY_PLANES_H

#include "replay_run.h"
#include "replay_stream.h"

#include <stdint.h>

/* Codes of the page. Coordinate k, x, y or z, of point i, linear in the box: 0 to 65535. */
uint16_t replay_code_position(const struct vtk_frame *frame, const struct box *box, int i, int k);
/* The value of a channel at point i by its square root, up to `most`: 0 to 255. A few large values
 * set the range, and the root keeps small values distinct. filled: values of the channel FILLED;
 * NULL: 1 */
uint16_t replay_code_value(const struct part *part, const struct vtk_frame *frame,
                           enum channel channel, const double *filled, double most, int i);

/* Writes the triangles of all parts, then all frames of a run. Returns an exit code, after a
 * message unless it is EXIT_GOOD. */
int replay_write_data(const struct run *run, struct stream *stream);

#endif
