/* A file with the state of a simulation. What belongs to it is named once, in functions that write
 * it or read it: both directions are one text. The file appears whole or not at all, and nothing is
 * read from it before its checksum was right.
 *
 * Format 1: 8 bytes "PDYNSTA1", the number 0x0102030405060708 in the machine's byte order, what was
 * written, and its 64-bit FNV-1a hash. */
#ifndef PDYN_SNAPSHOT_FILE_H
#define PDYN_SNAPSHOT_FILE_H

#include "file_out.h"
#include "projdyn/module.h"

struct snapshot_file {
    pdyn_snapshot view; /* what modules see */
    pdyn_context *context;
    const char *path; /* the caller's, until the file is closed */
    struct file_out out;
    FILE *in;
    uint64_t hash;
    pdyn_status status; /* of all so far */
};

/* On failure nothing is left to close. PDYN_BAD_INPUT: this is no whole saved state of this
 * machine. */
pdyn_status snapshot_file_create(pdyn_context *context, const char *path,
                                 struct snapshot_file *out);
pdyn_status snapshot_file_open(pdyn_context *context, const char *path, struct snapshot_file *out);
/* The first error of all. One that was written takes its name now, unless there was one. */
pdyn_status snapshot_file_close(struct snapshot_file *snapshot);

void snapshot_file_bytes(struct snapshot_file *snapshot, void *data, size_t size);
#define ARCHIVE(snapshot, value) snapshot_file_bytes(snapshot, &(value), sizeof(value))

/* A number that has to be the same when it is read, PDYN_BAD_INPUT: "PATH: the state has other
 * WHAT". */
void snapshot_file_expect(struct snapshot_file *snapshot, uint64_t value, const char *what);

#define HASH_BEGIN 0xCBF29CE484222325u
/* FNV-1a */
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
