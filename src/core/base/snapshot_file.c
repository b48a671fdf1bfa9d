/* The file of a saved state: header, content and checksum. */
#include "snapshot_file.h"

#include "file_in.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char magic[] = "PDYNSTA3";
static const uint64_t order_mark = 0x0102030405060708u;

enum { HEAD = 16, TAIL = 8, CHUNK = 1 << 16 };

uint64_t hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data;
    for (size_t k = 0; k < size; k++) hash = (hash ^ byte[k]) * 0x100000001B3u;
    return hash;
}

/* ---- bytes ----------------------------------------------------------------------------------- */

static void write_bytes(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *a = (struct snapshot_file *)view;
    a->hash = hash_bytes(a->hash, data, size);
    file_out_bytes(&a->out, data, size);
}

static void read_bytes(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *a = (struct snapshot_file *)view;
    bool complete = size <= a->left && fread(data, 1, size, a->in) == size;
    a->left -= complete ? size : a->left;
    if (complete && a->status == PDYN_OK) return;
    memset(data, 0, size);
    if (a->status == PDYN_OK)
        a->status = context_fail(a->context, PDYN_BAD_INPUT,
                                 "%.1024s: the state ends too early: it was saved by another scene "
                                 "or version",
                                 a->path);
}

void snapshot_file_bytes(struct snapshot_file *a, void *data, size_t size) {
    if (size) a->view.bytes(&a->view, data, size);
}

void snapshot_file_expect(struct snapshot_file *a, uint64_t value, const char *what) {
    uint64_t found = value;
    SNAPSHOT(a, found);
    if (a->status == PDYN_OK && found != value)
        a->status = context_fail(a->context, PDYN_BAD_INPUT,
                                 "%.1024s: the state was saved with other %s", a->path, what);
}

/* ---- a state in memory ----------------------------------------------------------------------- */

static void write_memory(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *a = (struct snapshot_file *)view;
    unsigned char *moved = a->status == PDYN_OK
                               ? context_grow(a->context, a->memory, &a->room, a->filled + size, 1)
                               : NULL;
    if (!moved) {
        a->status = PDYN_NO_MEMORY;
        return;
    }
    a->memory = moved;
    memcpy(a->memory + a->filled, data, size);
    a->filled += size;
}

static void read_memory(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *a = (struct snapshot_file *)view;
    bool complete = a->status == PDYN_OK && size <= a->filled - a->taken;
    if (complete) memcpy(data, a->memory + a->taken, size);
    else memset(data, 0, size);
    a->taken += complete ? size : 0;
    snapshot_file_require(a, complete, "it ends too early");
}

void snapshot_memory_create(pdyn_context *context, struct snapshot_file *out) {
    *out = (struct snapshot_file){.view = {.bytes = write_memory},
                                  .context = context,
                                  .path = "the state in memory",
                                  .in_memory = true};
}

void snapshot_memory_rewind(struct snapshot_file *a) {
    a->view = (pdyn_snapshot){.reading = true, .bytes = read_memory};
    a->taken = 0;
}

/* ---- a buffer of the caller ------------------------------------------------------------------ */

static void append(struct snapshot_file *a, const void *data, size_t size) {
    if (a->filled <= a->room && size <= a->room - a->filled)
        memcpy(a->memory + a->filled, data, size);
    a->filled += size;
}

static void write_buffer(pdyn_snapshot *view, void *data, size_t size) {
    struct snapshot_file *a = (struct snapshot_file *)view;
    a->hash = hash_bytes(a->hash, data, size);
    append(a, data, size);
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

size_t snapshot_buffer_end(struct snapshot_file *a) {
    append(a, &a->hash, sizeof a->hash);
    return a->filled;
}

/* ---- checks of values that are read ---------------------------------------------------------- */

void snapshot_file_require(struct snapshot_file *a, bool valid, const char *what) {
    if (valid || !a->view.reading || a->status != PDYN_OK) return;
    a->status = context_fail(a->context, PDYN_BAD_INPUT,
                             "%.1024s: not a saved state of this scene: %s", a->path, what);
}

void snapshot_file_range(struct snapshot_file *a, double *value, size_t count, double max,
                         const char *what) {
    bool valid = true;
    snapshot_file_bytes(a, value, count * sizeof *value);
    for (size_t k = 0; a->view.reading && k < count; k++)
        valid &= fabs(value[k]) <= max; /* false for NaN */
    snapshot_file_require(a, valid, what);
}

void snapshot_file_numbers(struct snapshot_file *a, double *value, size_t count, const char *what) {
    snapshot_file_range(a, value, count, DBL_MAX, what);
}

/* A byte other than 0 and 1 must not be read as bool: bytes are checked first, and replaced. */
void snapshot_file_flags(struct snapshot_file *a, bool *value, size_t count, const char *what) {
    unsigned char *byte = (unsigned char *)value;
    bool valid = true;
    snapshot_file_bytes(a, value, count * sizeof *value);
    for (size_t k = 0; a->view.reading && k < count * sizeof *value; k++) {
        valid &= byte[k] <= 1;
        byte[k] &= 1;
    }
    snapshot_file_require(a, valid, what);
}

void snapshot_file_long(struct snapshot_file *a, long *value, long max, const char *what) {
    SNAPSHOT(a, *value);
    snapshot_file_require(a, *value >= 0 && *value <= max, what);
}

void snapshot_file_count(struct snapshot_file *a, int *value, size_t size, const char *what) {
    SNAPSHOT(a, *value);
    size_t left = a->in_memory ? a->filled - a->taken : a->left;
    bool valid = *value >= 0 && (size_t)*value <= left / size;
    snapshot_file_require(a, valid, what);
    if (a->view.reading && !valid) *value = 0;
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

static pdyn_status damaged(const struct snapshot_file *a, const char *what) {
    return context_fail(a->context, PDYN_BAD_INPUT, "%.1024s: %s", a->path, what);
}

static pdyn_status wrong_checksum(const struct snapshot_file *a) {
    return damaged(a, "the state is damaged: its checksum is wrong");
}

/* Compares the hash of `size` bytes of content with the hash that follows them in the file. */
static pdyn_status check_content(struct snapshot_file *a, size_t size) {
    unsigned char buffer[CHUNK];
    uint64_t hash = HASH_BEGIN, found = 0;
    for (size_t left = size; left; left -= left < CHUNK ? left : CHUNK) {
        size_t part = left < CHUNK ? left : CHUNK;
        if (fread(buffer, 1, part, a->in) != part) return damaged(a, "cannot be read");
        hash = hash_bytes(hash, buffer, part);
    }
    if (fread(&found, 1, sizeof found, a->in) != sizeof found || found != hash)
        return wrong_checksum(a);
    return PDYN_OK;
}

static pdyn_status no_state(const struct snapshot_file *a) {
    return damaged(a, "expected a state saved by this version of projdyn");
}

static pdyn_status check_head(const struct snapshot_file *a, const unsigned char head[HEAD]) {
    const size_t word = sizeof magic - 1;
    if (memcmp(head, magic, word)) return no_state(a);
    if (memcmp(head + word, &order_mark, sizeof order_mark))
        return damaged(a, "the state was saved on a machine with another byte order");
    return PDYN_OK;
}

static pdyn_status check_file(struct snapshot_file *a) {
    struct stat info;
    unsigned char head[HEAD];
    if (fstat(fileno(a->in), &info) || !S_ISREG(info.st_mode) || info.st_size < HEAD + TAIL ||
        fread(head, 1, HEAD, a->in) != HEAD)
        return no_state(a);
    a->left = (size_t)info.st_size - HEAD - TAIL;
    pdyn_status status = check_head(a, head);
    if (status == PDYN_OK) status = check_content(a, a->left);
    if (status == PDYN_OK && fseek(a->in, HEAD, SEEK_SET)) return damaged(a, "cannot be read");
    return status;
}

pdyn_status snapshot_file_open(pdyn_context *context, const char *path, struct snapshot_file *out) {
    int descriptor = file_open(context, path);
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

pdyn_status snapshot_file_close(struct snapshot_file *a) {
    if (a->borrowed) return a->status;
    if (a->in_memory) {
        FREE_ARRAY(a->context, a->memory, a->room);
        return a->status;
    }
    if (a->in) {
        fclose(a->in);
        return a->status;
    }
    if (a->status != PDYN_OK) {
        file_out_discard(&a->out);
        return a->status;
    }
    file_out_bytes(&a->out, &a->hash, sizeof a->hash);
    file_out_sync(&a->out);
    return file_out_close(&a->out);
}
