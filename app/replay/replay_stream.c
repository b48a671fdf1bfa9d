/* Output of a page: text, and data as deflate in base64. */
#include "replay_stream.h"

void stream_text(struct stream *stream, const char *text, size_t size) {
    if (fwrite(text, 1, size, stream->file) != size) stream->failed = true;
}

void stream_base64(struct stream *stream, const unsigned char *bytes, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned word = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0U) |
                        (left > 2 ? bytes[i + 2] : 0U);
        char text[4] = {digits[word >> 18], digits[word >> 12 & 63],
                        left > 1 ? digits[word >> 6 & 63] : '=',
                        left > 2 ? digits[word & 63] : '='};
        stream_text(stream, text, sizeof text);
    }
}

bool stream_begin_data(struct stream *stream) {
    stream->deflate = (z_stream){.next_out = stream->compressed, .avail_out = STREAM_CHUNK};
    return deflateInit(&stream->deflate, Z_DEFAULT_COMPRESSION) == Z_OK;
}

/* Compresses bytes; writes each full chunk, and the last one if flush is Z_FINISH. */
static void compress_bytes(struct stream *stream, const unsigned char *bytes, size_t size,
                           int flush) {
    z_stream *z = &stream->deflate;
    z->next_in = (unsigned char *)bytes;
    z->avail_in = (uInt)size;
    int status = Z_OK;
    while (status == Z_OK && (z->avail_in || flush == Z_FINISH)) {
        status = deflate(z, flush);
        if (z->avail_out && status != Z_STREAM_END) continue;
        stream_base64(stream, stream->compressed, STREAM_CHUNK - z->avail_out);
        z->next_out = stream->compressed;
        z->avail_out = STREAM_CHUNK;
    }
}

void stream_bytes(struct stream *stream, const unsigned char *bytes, size_t size) {
    compress_bytes(stream, bytes, size, Z_NO_FLUSH);
}

void stream_end_data(struct stream *stream, bool finish) {
    if (finish) compress_bytes(stream, NULL, 0, Z_FINISH);
    deflateEnd(&stream->deflate);
}
