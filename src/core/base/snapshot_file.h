/* The file of a saved state. One function per struct lists what is saved; it writes or reads,
 * depending on the direction of the file. The file appears complete or not at all, and its checksum
 * is verified before anything is read from it. */
#ifndef PDYN_SNAPSHOT_FILE_H
#define PDYN_SNAPSHOT_FILE_H

#include "file_out.h"
#include "projdyn/module.h"

/* Format 1: the 8 bytes "PDYNSTA1", the number 0x0102030405060708 in the machine's byte order, the
 * content, and the 64-bit FNV-1a hash of the content. */
struct snapshot_file {
    pdyn_snapshot view; /* the part that modules (module.h) use */
    pdyn_context *context;
    const char *path; /* not copied: must stay valid until snapshot_file_close */
    struct file_out out;
    FILE *in;
    uint64_t hash;
    pdyn_status status; /* the first error */
};

/* Opens a file for writing (create) or reading (open). After a failure there is nothing to close.
 * PDYN_BAD_INPUT: not a complete saved state, or one of a machine with another byte order.
 * PDYN_IO_FAILED, PDYN_NO_MEMORY. */
pdyn_status snapshot_file_create(pdyn_context *context, const char *path,
                                 struct snapshot_file *out);
pdyn_status snapshot_file_open(pdyn_context *context, const char *path, struct snapshot_file *out);
/* Closes the file; one that was written gets its checksum and its name. Returns the first error. */
pdyn_status snapshot_file_close(struct snapshot_file *snapshot);

/* Writes or reads `size` bytes. */
void snapshot_file_bytes(struct snapshot_file *snapshot, void *data, size_t size);
#define SNAPSHOT(snapshot, value) snapshot_file_bytes(snapshot, &(value), sizeof(value))

/* Writes a number, or reads one that must equal `value`. PDYN_BAD_INPUT: "PATH: the state was saved
 * with other WHAT". */
void snapshot_file_expect(struct snapshot_file *snapshot, uint64_t value, const char *what);

#define HASH_BEGIN 0xCBF29CE484222325u
/* The 64-bit FNV-1a hash of `hash` continued over `size` bytes. */
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
