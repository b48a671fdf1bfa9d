/* Writing files that appear complete or not at all: see file_out.h. */
#include "file_out.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK = 1024 }; /* numbers encoded per fwrite */

/* ---- names ----------------------------------------------------------------------------------- */

/* The ending of a temporary file's name: a dot, RANDOM_DIGITS hexadecimal digits, ".tmp". */
enum { RANDOM_DIGITS = 8, ENDING = 1 + RANDOM_DIGITS + 4 };

static bool is_temporary(const char *name) {
    size_t length = strlen(name);
    if (length <= ENDING) return false;
    const char *ending = name + length - ENDING;
    for (int k = 1; k <= RANDOM_DIGITS; k++)
        if (!isxdigit((unsigned char)ending[k])) return false;
    return *ending == '.' && !strcmp(ending + 1 + RANDOM_DIGITS, ".tmp");
}

void file_out_remove_leftovers(const char *directory) {
    DIR *entries = opendir(directory);
    for (struct dirent *entry; entries && (entry = readdir(entries));)
        if (is_temporary(entry->d_name)) unlinkat(dirfd(entries), entry->d_name, 0);
    if (entries) closedir(entries);
}

/* Whether the path is a name of an open descriptor of the process. These names are symbolic links,
 * which must be written through: a rename would replace /dev/stdout. */
static bool is_descriptor(const char *path) {
    return !strcmp(path, "/dev/stdout") || !strcmp(path, "/dev/stderr") ||
           !strncmp(path, "/dev/fd/", 8) || !strncmp(path, "/proc/self/fd/", 14);
}

/* Whether the path itself is written: it is a device, a pipe or an open descriptor. Any other
 * symbolic link is replaced by the new file, like a regular file. */
static bool is_written_directly(const char *path) {
    struct stat info;
    return is_descriptor(path) ||
           (lstat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISLNK(info.st_mode));
}

/* ---- opening and closing --------------------------------------------------------------------- */

static void release(struct file_out *out) {
    text_end(&out->locale);
    FREE_ARRAY(out->context, out->temporary, out->temporary_size);
}

/* Creates a file PATH.RANDOM.tmp that did not exist. Returns its descriptor, or -1 with errno. */
static int create_temporary(struct file_out *out) {
    const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    for (int tries = 0; tries < 100; tries++) {
        uint32_t random;
        if (getrandom(&random, sizeof random, 0) != sizeof random) return -1;
        snprintf(out->temporary, out->temporary_size, "%s.%08x.tmp", out->path, (unsigned)random);
        int descriptor = open(out->temporary, flags, 0666);
        if (descriptor >= 0 || errno != EEXIST) return descriptor;
    }
    return -1;
}

/* Opens the temporary file, or the path itself if it has none. Returns NULL with errno. */
static FILE *open_stream(struct file_out *out) {
    int flags = O_WRONLY | O_CLOEXEC | (is_descriptor(out->path) ? O_TRUNC : O_NOFOLLOW);
    int descriptor = out->temporary ? create_temporary(out) : open(out->path, flags);
    if (descriptor < 0) return NULL;
    FILE *stream = fdopen(descriptor, "wb");
    if (stream) return stream;
    int error = errno;
    close(descriptor);
    if (out->temporary) unlink(out->temporary);
    errno = error;
    return NULL;
}

pdyn_status file_out_open(pdyn_context *context, const char *path, struct file_out *out) {
    *out = (struct file_out){.context = context, .path = path};
    if (!text_begin(&out->locale)) return context_no_memory(context);
    if (!is_written_directly(path)) {
        out->temporary_size = strlen(path) + ENDING + 1;
        out->temporary = NEW_ARRAY(context, out->temporary_size, char);
        if (!out->temporary) return text_end(&out->locale), PDYN_NO_MEMORY;
    }
    out->stream = open_stream(out);
    if (out->stream) return PDYN_OK;
    pdyn_status status = errno == ENOMEM
                             ? context_no_memory(context)
                             : set_error(PDYN_IO_FAILED, "%.1024s: cannot create the file: %s",
                                         path, strerror(errno));
    release(out);
    return status;
}

pdyn_status file_open_in_place(const char *path, int create, int *descriptor) {
    struct stat info;
    *descriptor =
        open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | create, 0666);
    if (*descriptor < 0 && errno != ELOOP)
        return set_error(PDYN_IO_FAILED, "%.1024s: cannot %s the file: %s", path,
                         create ? "create" : "open", strerror(errno));
    bool good = *descriptor >= 0 && fstat(*descriptor, &info) == 0 && S_ISREG(info.st_mode) &&
                info.st_nlink == 1;
    if (good) return PDYN_OK;
    if (*descriptor >= 0) close(*descriptor);
    *descriptor = -1;
    return set_error(PDYN_BAD_INPUT,
                     "%.1024s: expected a regular file with a single name, found a link or "
                     "special file; remove it",
                     path);
}

/* ---- content --------------------------------------------------------------------------------- */

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

void file_out_doubles(struct file_out *out, const double *value, size_t count) {
    unsigned char byte[8];
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &value[i], sizeof bits);
        encode((uint32_t)bits, LITTLE_ENDIAN_BYTES, byte);
        encode((uint32_t)(bits >> 32), LITTLE_ENDIAN_BYTES, byte + 4);
        file_out_bytes(out, byte, sizeof byte);
    }
}

void file_out_sync(struct file_out *out) {
    errno = 0;
    if (out->temporary && (fflush(out->stream) || fsync(fileno(out->stream)))) note_error(out);
}

static pdyn_status outcome(const struct file_out *out) {
    if (out->error)
        return set_error(PDYN_IO_FAILED, "%.1024s: writing failed: %s", out->path,
                         strerror(out->error));
    if (out->not_finite)
        return set_error(PDYN_IO_FAILED,
                         "%.1024s: a number does not fit the 32-bit floats of the file", out->path);
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

void file_out_discard(struct file_out *out) {
    fclose(out->stream);
    if (out->temporary) remove(out->temporary);
    release(out);
}
