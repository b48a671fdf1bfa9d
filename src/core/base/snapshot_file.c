/* The file of a saved state: header, content and checksum. */
#include "snapshot_file.h"

#include "file_in.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char magic[] = "PDYNSTA4";
static const uint64_t order_mark = 0x0102030405060708u;

enum { HEAD = 16, TAIL = 8, CHUNK = 1 << 16 };

uint64_t hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data;
    for (size_t k = 0; k < size; k++) hash = (hash ^ byte[k]) * 0x100000001B3u;
    return hash;
}

/* ---- bytes ----------------------------------------------------------------------------------- */

static void write_bytes(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *file = (struct snapshot_file *)view;
    file->hash = hash_bytes(file->hash, data, size);
    file_out_bytes(&file->out, data, size);
}

static void read_bytes(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *file = (struct snapshot_file *)view;
    bool complete = size <= file->left && fread(data, 1, size, file->in) == size;
    file->left -= complete ? size : file->left;
    if (complete && file->status == PDYN_OK) return;
    memset(data, 0, size);
    if (file->status == PDYN_OK)
        file->status = set_error(PDYN_BAD_INPUT,
                                 "%.1024s: the state ends too early: it was saved by another scene "
                                 "or version",
                                 file->path);
}

void snapshot_file_bytes(struct snapshot_file *file, void *data, size_t size) {
    if (size) file->view.bytes(&file->view, data, size);
}

void snapshot_file_expect(struct snapshot_file *file, uint64_t value, const char *what) {
    uint64_t found = value;
    SNAPSHOT(file, found);
    if (file->status == PDYN_OK && found != value)
        file->status = set_error(PDYN_BAD_INPUT, "%.1024s: the state was saved with other %s",
                                 file->path, what);
}

/* ---- a state in memory ----------------------------------------------------------------------- */

static void write_memory(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *file = (struct snapshot_file *)view;
    unsigned char *moved =
        file->status == PDYN_OK
            ? context_grow(file->context, file->memory, &file->room, file->filled + size, 1)
            : NULL;
    if (!moved) {
        file->status = PDYN_NO_MEMORY;
        return;
    }
    file->memory = moved;
    memcpy(file->memory + file->filled, data, size);
    file->filled += size;
}

static void read_memory(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *file = (struct snapshot_file *)view;
    bool complete = file->status == PDYN_OK && size <= file->filled - file->taken;
    if (complete) memcpy(data, file->memory + file->taken, size);
    else memset(data, 0, size);
    file->taken += complete ? size : 0;
    snapshot_file_require(file, complete, "it ends too early");
}

void snapshot_memory_create(pdyn_context *context, struct snapshot_file *out) {
    *out = (struct snapshot_file){.view = {.bytes = write_memory},
                                  .context = context,
                                  .path = "the state in memory",
                                  .in_memory = true};
}

void snapshot_memory_rewind(struct snapshot_file *file) {
    file->view = (pdyn_snapshot){.reading = true, .bytes = read_memory};
    file->taken = 0;
}

/* ---- a buffer of the caller ------------------------------------------------------------------ */

static void append(struct snapshot_file *file, const void *data, size_t size) {
    if (file->filled <= file->room && size <= file->room - file->filled)
        memcpy(file->memory + file->filled, data, size);
    file->filled += size;
}

static void write_buffer(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *file = (struct snapshot_file *)view;
    file->hash = hash_bytes(file->hash, data, size);
    append(file, data, size);
}

void snapshot_buffer_create(pdyn_context *context, void *buffer, size_t capacity,
                            struct snapshot_file *out) {
    snapshot_memory_create(context, out);
    out->view.bytes = write_buffer;
    out->borrowed = true;
    out->memory = buffer, out->room = capacity;
    out->hash = HASH_BEGIN;
    append(out, magic, sizeof magic - 1);
    append(out, &order_mark, sizeof order_mark);
}

size_t snapshot_buffer_end(struct snapshot_file *file) {
    append(file, &file->hash, sizeof file->hash);
    return file->filled;
}

/* ---- checks of values that are read ---------------------------------------------------------- */

void snapshot_file_require(struct snapshot_file *file, bool valid, const char *what) {
    if (valid || !file->view.reading || file->status != PDYN_OK) return;
    file->status =
        set_error(PDYN_BAD_INPUT, "%.1024s: not a saved state of this scene: %s", file->path, what);
}

void snapshot_file_range(struct snapshot_file *file, double *value, size_t count, double max,
                         const char *what) {
    bool valid = true;
    snapshot_file_bytes(file, value, count * sizeof *value);
    for (size_t k = 0; file->view.reading && k < count; k++)
        valid &= fabs(value[k]) <= max; /* false for NaN */
    snapshot_file_require(file, valid, what);
}

void snapshot_file_numbers(struct snapshot_file *file, double *value, size_t count,
                           const char *what) {
    snapshot_file_range(file, value, count, DBL_MAX, what);
}

/* A byte other than 0 and 1 must not be read as bool: bytes are checked first, and replaced. */
void snapshot_file_flags(struct snapshot_file *file, bool *value, size_t count, const char *what) {
    unsigned char *byte = (unsigned char *)value;
    bool valid = true;
    snapshot_file_bytes(file, value, count * sizeof *value);
    for (size_t k = 0; file->view.reading && k < count * sizeof *value; k++) {
        valid &= byte[k] <= 1;
        byte[k] &= 1;
    }
    snapshot_file_require(file, valid, what);
}

void snapshot_file_long(struct snapshot_file *file, long *value, long max, const char *what) {
    SNAPSHOT(file, *value);
    snapshot_file_require(file, *value >= 0 && *value <= max, what);
}

void snapshot_file_count(struct snapshot_file *file, int *value, size_t size, const char *what) {
    SNAPSHOT(file, *value);
    size_t left = file->in_memory ? file->filled - file->taken : file->left;
    bool valid = *value >= 0 && (size_t)*value <= left / size;
    snapshot_file_require(file, valid, what);
    if (file->view.reading && !valid) *value = 0;
}

/* ---- writing --------------------------------------------------------------------------------- */

pdyn_status snapshot_file_create(pdyn_context *context, const char *path,
                                 struct snapshot_file *out) {
    *out = (struct snapshot_file){
        .view = {.bytes = write_bytes}, .context = context, .path = path, .hash = HASH_BEGIN};
    pdyn_status status = file_out_open(context, path, &out->out);
    if (status != PDYN_OK) return status;
    file_out_bytes(&out->out, magic, sizeof magic - 1);
    file_out_bytes(&out->out, &order_mark, sizeof order_mark);
    return PDYN_OK;
}

/* ---- reading --------------------------------------------------------------------------------- */

static pdyn_status damaged(const struct snapshot_file *file, const char *what) {
    return set_error(PDYN_BAD_INPUT, "%.1024s: %s", file->path, what);
}

static pdyn_status wrong_checksum(const struct snapshot_file *file) {
    return damaged(file, "the state is damaged: its checksum is wrong");
}

/* Compares the hash of `size` bytes of content with the hash that follows them in the file. */
static pdyn_status check_content(struct snapshot_file *file, size_t size) {
    unsigned char buffer[CHUNK];
    uint64_t hash = HASH_BEGIN, found = 0;
    for (size_t left = size; left; left -= left < CHUNK ? left : CHUNK) {
        size_t part = left < CHUNK ? left : CHUNK;
        if (fread(buffer, 1, part, file->in) != part) return damaged(file, "cannot be read");
        hash = hash_bytes(hash, buffer, part);
    }
    if (fread(&found, 1, sizeof found, file->in) != sizeof found || found != hash)
        return wrong_checksum(file);
    return PDYN_OK;
}

static pdyn_status no_state(const struct snapshot_file *file) {
    return damaged(file, "expected a state saved by this version of projdyn");
}

static pdyn_status check_head(const struct snapshot_file *file, const unsigned char head[HEAD]) {
    const size_t word = sizeof magic - 1;
    if (memcmp(head, magic, word)) return no_state(file);
    if (memcmp(head + word, &order_mark, sizeof order_mark))
        return damaged(file, "the state was saved on a machine with another byte order");
    return PDYN_OK;
}

static pdyn_status check_file(struct snapshot_file *file) {
    struct stat info;
    unsigned char head[HEAD];
    if (fstat(fileno(file->in), &info) || !S_ISREG(info.st_mode) || info.st_size < HEAD + TAIL ||
        fread(head, 1, HEAD, file->in) != HEAD)
        return no_state(file);
    file->left = (size_t)info.st_size - HEAD - TAIL;
    pdyn_status status = check_head(file, head);
    if (status == PDYN_OK) status = check_content(file, file->left);
    if (status == PDYN_OK && fseek(file->in, HEAD, SEEK_SET))
        return damaged(file, "cannot be read");
    return status;
}

pdyn_status snapshot_file_open(pdyn_context *context, const char *path, struct snapshot_file *out) {
    int descriptor = file_open(path);
    if (descriptor < 0) return PDYN_IO_FAILED;
    *out = (struct snapshot_file){.view = {.bytes = read_bytes, .reading = true},
                                  .context = context,
                                  .path = path,
                                  .in = fdopen(descriptor, "rb")};
    if (!out->in) return close(descriptor), context_no_memory(context);
    pdyn_status status = check_file(out);
    if (status != PDYN_OK) fclose(out->in);
    return status;
}

pdyn_status snapshot_buffer_open(pdyn_context *context, const void *buffer, size_t size,
                                 struct snapshot_file *out) {
    unsigned char *bytes = (unsigned char *)(uintptr_t)buffer; /* only read */
    snapshot_memory_create(context, out);
    snapshot_memory_rewind(out);
    out->borrowed = true;
    if (size < HEAD + TAIL) return no_state(out);
    out->memory = bytes + HEAD, out->filled = size - HEAD - TAIL;
    pdyn_status status = check_head(out, bytes);
    uint64_t hash = hash_bytes(HASH_BEGIN, out->memory, out->filled);
    if (status == PDYN_OK && memcmp(&hash, out->memory + out->filled, sizeof hash))
        return wrong_checksum(out);
    return status;
}

pdyn_status snapshot_file_close(struct snapshot_file *file) {
    if (file->borrowed) return file->status;
    if (file->in_memory) {
        FREE_ARRAY(file->context, file->memory, file->room);
        return file->status;
    }
    if (file->in) {
        fclose(file->in);
        return file->status;
    }
    if (file->status != PDYN_OK) {
        file_out_discard(&file->out);
        return file->status;
    }
    file_out_bytes(&file->out, &file->hash, sizeof file->hash);
    file_out_sync(&file->out);
    return file_out_close(&file->out);
}
