/* Output stream of a page: plain text, and binary data compressed with deflate and coded in
 * base64. */
#ifndef REPLAY_STREAM_H
#define REPLAY_STREAM_H

#include <stdbool.h>
#include <stdio.h>
#include <zlib.h>

enum { STREAM_CHUNK = 3 << 14 }; /* bytes; a multiple of 3, so that base64 chunks can be joined */

struct stream {
    FILE *file;
    z_stream deflate;
    bool failed; /* a write failed; later writes are still accepted */
    unsigned char compressed[STREAM_CHUNK];
};

void stream_text(struct stream *stream, const char *text, size_t size);

/* Writes bytes in base64. Only the last of joined pieces may have a size that is no multiple of 3.
 */
void stream_base64(struct stream *stream, const unsigned char *bytes, size_t size);

/* Binary data: begin, any number of stream_bytes(), end. false if memory ran out. */
bool stream_begin_data(struct stream *stream);
void stream_bytes(struct stream *stream, const unsigned char *bytes, size_t size);
/* Ends the data and frees its memory. finish: writes the buffered bytes first; otherwise they are
 * discarded. */
void stream_end_data(struct stream *stream, bool finish);

#endif
