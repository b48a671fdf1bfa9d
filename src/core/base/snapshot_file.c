/* The file of a saved state: header, content and checksum. */
#include "snapshot_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

static const char magic[] = "PDYNSTA1";
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
    if (a->status == PDYN_OK && fread(data, 1, size, a->in) != size)
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
        return damaged(a, "the state is damaged: its checksum is wrong");
    return PDYN_OK;
}

static pdyn_status check_file(struct snapshot_file *a) {
    struct stat info;
    char word[sizeof magic - 1];
    uint64_t mark = 0;
    if (fstat(fileno(a->in), &info) || !S_ISREG(info.st_mode) || info.st_size < HEAD + TAIL ||
        fread(word, 1, sizeof word, a->in) != sizeof word || memcmp(word, magic, sizeof word))
        return damaged(a, "expected a state saved by this version of projdyn");
    if (fread(&mark, 1, sizeof mark, a->in) != sizeof mark || mark != order_mark)
        return damaged(a, "the state was saved on a machine with another byte order");
    pdyn_status status = check_content(a, (size_t)info.st_size - HEAD - TAIL);
    if (status == PDYN_OK && fseek(a->in, HEAD, SEEK_SET)) return damaged(a, "cannot be read");
    return status;
}

pdyn_status snapshot_file_open(pdyn_context *context, const char *path, struct snapshot_file *out) {
    *out = (struct snapshot_file){.view = {.bytes = read_bytes, .reading = true},
                                  .context = context,
                                  .path = path,
                                  .in = fopen(path, "rbe")};
    if (!out->in)
        return context_fail(context, PDYN_IO_FAILED, "%.1024s: cannot open the file: %s", path,
                            strerror(errno));
    pdyn_status status = check_file(out);
    if (status != PDYN_OK) fclose(out->in);
    return status;
}

pdyn_status snapshot_file_close(struct snapshot_file *a) {
    if (a->in) {
        fclose(a->in);
        return a->status;
    }
    file_out_bytes(&a->out, &a->hash, sizeof a->hash);
    return file_out_close(&a->out);
}
