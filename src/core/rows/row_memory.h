/* What the elements of a batch leave to the next step (`end` in module.h): blocks of bytes, found
 * by the elements' keys. */
#ifndef PDYN_ROW_MEMORY_H
#define PDYN_ROW_MEMORY_H

#include "base/context.h"
#include "base/snapshot_file.h"
#include "base/sort_by_key.h"

struct row_memory {
    int count, room;
    struct keyed *entry;  /* room; `count` of them in use, ascending keys; place: of a block among
                             those that were given */
    unsigned char *block; /* room x size bytes, in the order of the entries */
};

/* Makes room for `count` blocks of `size` bytes. PDYN_NO_MEMORY: nothing has changed. */
pdyn_status row_memory_reserve(pdyn_context *context, struct row_memory *memory, int count,
                               size_t size);
/* Replaces everything by `count` blocks with their keys, for which there is room. */
void row_memory_set(struct row_memory *memory, const uint64_t *key, const void *block, int count,
                    size_t size);

/* Copies the block of every key to block (count x size bytes); zeros where a key is unknown. */
void row_memory_get(const struct row_memory *memory, const uint64_t *key, void *block, int count,
                    size_t size);

/* Writes or reads all of it. */
void row_memory_persist(pdyn_context *context, struct row_memory *memory, size_t size,
                        struct snapshot_file *snapshot);

void row_memory_free(pdyn_context *context, struct row_memory *memory, size_t size);

#endif
