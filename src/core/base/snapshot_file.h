/* The file of a saved state. One function per struct lists what is saved; it writes or reads,
 * depending on the direction of the file. The file appears complete or not at all, and its checksum
 * is verified before anything is read from it. The checksum has no key, so a file with a correct
 * checksum may contain anything: the reader checks every field that it uses as an index, a count, a
 * flag or a number. */
#ifndef PDYN_SNAPSHOT_FILE_H
#define PDYN_SNAPSHOT_FILE_H

#include "file_out.h"
#include "projdyn/module.h"

/* The 8 bytes "PDYNSTA4", the number 0x0102030405060708 in the machine's byte order, the
 * content, and the 64-bit FNV-1a hash of the content. */
struct snapshot_file {
    pdyn_snapshot view; /* the part that modules (module.h) use */
    pdyn_context *context;
    const char *path; /* not copied: must stay valid until snapshot_file_close */
    struct file_out out;
    FILE *in;
    size_t left; /* bytes of content that were not read yet */
    uint64_t hash;
    bool in_memory;        /* the state is in `memory`, without a file */
    bool borrowed;         /* `memory` belongs to the caller: snapshot_file_close leaves it */
    unsigned char *memory; /* room bytes, of which `filled` are written and `taken` are read */
    size_t room, filled, taken;
    pdyn_status status; /* the first error */
};

/* Opens a file for writing (create) or reading (open). After a failure there is nothing to close.
 * PDYN_BAD_INPUT: not a complete saved state, or one of a machine with another byte order.
 * PDYN_IO_FAILED, PDYN_NO_MEMORY. */
pdyn_status snapshot_file_create(pdyn_context *context, const char *path,
                                 struct snapshot_file *out);
pdyn_status snapshot_file_open(pdyn_context *context, const char *path, struct snapshot_file *out);
/* Closes the file. One that was written gets its checksum and its name, or is removed after an
 * error. Returns the first error. */
pdyn_status snapshot_file_close(struct snapshot_file *snapshot);

/* A state in memory. snapshot_memory_create opens it for writing, snapshot_memory_rewind opens it
 * for reading from the beginning; snapshot_file_close frees it. PDYN_NO_MEMORY. */
void snapshot_memory_create(pdyn_context *context, struct snapshot_file *out);
void snapshot_memory_rewind(struct snapshot_file *snapshot);

/* A state in a buffer of the caller, with the bytes of the file. snapshot_buffer_create opens it
 * for writing. Bytes beyond `capacity` are counted and not stored; snapshot_buffer_end returns the
 * size of the whole state. snapshot_buffer_open verifies the checksum and opens it for reading;
 * after a failure there is nothing to close. PDYN_BAD_INPUT: as snapshot_file_open. */
void snapshot_buffer_create(pdyn_context *context, void *buffer, size_t capacity,
                            struct snapshot_file *out);
size_t snapshot_buffer_end(struct snapshot_file *snapshot);
pdyn_status snapshot_buffer_open(pdyn_context *context, const void *buffer, size_t size,
                                 struct snapshot_file *out);

/* Writes or reads `size` bytes. After the first error, reading gives zeros. */
void snapshot_file_bytes(struct snapshot_file *snapshot, void *data, size_t size);
#define SNAPSHOT(snapshot, value) snapshot_file_bytes(snapshot, &(value), sizeof(value))

/* Writes a number, or reads one that must equal `value`. PDYN_BAD_INPUT: "PATH: the state was saved
 * with other WHAT". */
void snapshot_file_expect(struct snapshot_file *snapshot, uint64_t value, const char *what);

/* Checks what was read: where `valid` is false, sets PDYN_BAD_INPUT, "PATH: not a saved state of
 * this scene: WHAT". Does nothing while writing, and after an error. */
void snapshot_file_require(struct snapshot_file *snapshot, bool valid, const char *what);

/* Write or read, and require: finite numbers; numbers in [-max, max]; bytes 0 or 1; a number in
 * [0, max]; the number of items of `size` bytes that follow in the file, which must be long enough
 * for them. */
void snapshot_file_numbers(struct snapshot_file *snapshot, double *value, size_t count,
                           const char *what);
void snapshot_file_range(struct snapshot_file *snapshot, double *value, size_t count, double max,
                         const char *what);
void snapshot_file_flags(struct snapshot_file *snapshot, bool *value, size_t count,
                         const char *what);
void snapshot_file_long(struct snapshot_file *snapshot, long *value, long max, const char *what);
void snapshot_file_count(struct snapshot_file *snapshot, int *value, size_t size, const char *what);

#define HASH_BEGIN 0xCBF29CE484222325u
/* The 64-bit FNV-1a hash of `hash` continued over `size` bytes. */
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
