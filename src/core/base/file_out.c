/* Writing files that appear complete or not at all: see file_out.h. */
#include "file_out.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum { CHUNK = 1024 }; /* numbers encoded per fwrite */

static const char *target_of(const struct file_out *out) {
    return out->temporary ? out->temporary : out->path;
}

static void release(struct file_out *out) {
    text_end(&out->locale);
    FREE_ARRAY(out->context, out->temporary, out->temporary_size);
}

/* Uses lstat: a link like /dev/stdout must be written through, not replaced by a file. */
static bool is_special(const char *path) {
    struct stat info;
    return lstat(path, &info) == 0 && !S_ISREG(info.st_mode);
}

pdyn_status file_out_open(pdyn_context *context, const char *path, struct file_out *out) {
    *out = (struct file_out){.context = context, .path = path};
    if (!text_begin(&out->locale)) return context_no_memory(context);
    if (!is_special(path)) {
        out->temporary_size = strlen(path) + sizeof ".tmp";
        out->temporary = NEW_ARRAY(context, out->temporary_size, char);
        if (!out->temporary) return text_end(&out->locale), PDYN_NO_MEMORY;
        snprintf(out->temporary, out->temporary_size, "%s.tmp", path);
    }
    out->stream = fopen(target_of(out), "wbe");
    if (out->stream) return PDYN_OK;
    context_fail(context, PDYN_IO_FAILED, "%.1024s: cannot create the file: %s", path,
                 strerror(errno));
    release(out);
    return PDYN_IO_FAILED;
}

static void note_error(struct file_out *out) {
    if (!out->error) out->error = errno ? errno : EIO;
}

void file_out_print(struct file_out *out, const char *format, ...) {
    va_list args;
    va_start(args, format);
    if (vfprintf(out->stream, format, args) < 0) note_error(out);
    va_end(args);
}

void file_out_bytes(struct file_out *out, const void *data, size_t size) {
    if (fwrite(data, 1, size, out->stream) != size) note_error(out);
}

static void encode(uint32_t bits, enum byte_order order, unsigned char byte[4]) {
    for (int k = 0; k < 4; k++)
        byte[order == BIG_ENDIAN_BYTES ? 3 - k : k] = (unsigned char)(bits >> 8 * k);
}

static uint32_t float_bits(struct file_out *out, double value) {
    uint32_t bits;
    bool fits = fabs(value) <= FLT_MAX; /* false for NaN */
    float narrow = fits ? (float)value : 0.0f;
    if (!fits) out->not_finite = true;
    memcpy(&bits, &narrow, sizeof bits);
    return bits;
}

void file_out_reals(struct file_out *out, enum byte_order order, const double *value,
                    size_t count) {
    unsigned char bytes[4 * CHUNK];
    for (size_t done = 0, n; done < count; done += n) {
        n = count - done < CHUNK ? count - done : CHUNK;
        for (size_t i = 0; i < n; i++)
            encode(float_bits(out, value[done + i]), order, bytes + 4 * i);
        file_out_bytes(out, bytes, 4 * n);
    }
}

void file_out_ints(struct file_out *out, enum byte_order order, const int *value, size_t count) {
    unsigned char byte[4];
    for (size_t i = 0; i < count; i++) {
        encode((uint32_t)value[i], order, byte);
        file_out_bytes(out, byte, sizeof byte);
    }
}

static pdyn_status outcome(const struct file_out *out) {
    if (out->error)
        return context_fail(out->context, PDYN_IO_FAILED, "%.1024s: writing failed: %s", out->path,
                            strerror(out->error));
    if (out->not_finite)
        return context_fail(out->context, PDYN_IO_FAILED,
                            "%.1024s: a number does not fit the 32-bit floats of the file",
                            out->path);
    return PDYN_OK;
}

pdyn_status file_out_close(struct file_out *out) {
    errno = 0;
    if (fclose(out->stream)) note_error(out);
    bool good = !out->error && !out->not_finite;
    if (good && out->temporary && rename(out->temporary, out->path)) note_error(out);
    pdyn_status status = outcome(out);
    if (status != PDYN_OK && out->temporary) remove(out->temporary);
    release(out);
    return status;
}
