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

/* Position of a value between min and max: 0 ... levels; 0 where max <= min. */
uint16_t replay_quantise(double value, double min, double max, double levels);

/* Writes the triangles of all parts, then all frames of a run. Returns an exit code, after a
 * message unless it is EXIT_GOOD. */
int replay_write_data(const struct run *run, struct stream *stream);

#endif
