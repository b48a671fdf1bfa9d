/* A frame of a live view as bytes for the page:
 *
 *     length of the JSON text, 32 bits | JSON, with spaces to a multiple of 4 | numbers
 *
 * The JSON object has the time, the numbers of the last step and what changed; the numbers are, for
 * each part that moves, in the order of the page: x, y, z of its points with 16 bits in the box of
 * the frame, then each channel (enum channel) with 8 bits, as replay_planes.h has them. Each array
 * is padded to a multiple of 4 bytes; the byte order is little endian. */
#ifndef FRAME_H
#define FRAME_H

#include "live.h"

struct bytes {
    unsigned char *data; /* capacity; the owner frees it */
    size_t size, capacity;
};

/* Makes the frame of the present state; drops the notes. false if memory ran out. */
bool frame_make(struct live *live, struct bytes *out);

#endif
