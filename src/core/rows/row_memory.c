#include "row_memory.h"

#include <string.h>

/* ---- blocks ---------------------------------------------------------------------------------- */

void row_memory_free(pdyn_context *context, struct row_memory *m, size_t size) {
    FREE_ARRAY(context, m->entry, m->room);
    FREE_ARRAY(context, m->block, (size_t)m->room * size);
    m->count = m->room = 0;
}

pdyn_status row_memory_reserve(pdyn_context *context, struct row_memory *m, int count,
                               size_t size) {
    if (count <= m->room) return PDYN_OK;
    struct row_memory grown = {.count = m->count, .room = count + count / 2};
    grown.entry = NEW_ARRAY(context, grown.room, struct keyed);
    grown.block = NEW_ARRAY(context, (size_t)grown.room * size, unsigned char);
    if (!grown.entry || !grown.block) {
        row_memory_free(context, &grown, size);
        return PDYN_NO_MEMORY;
    }
    if (m->count) {
        memcpy(grown.entry, m->entry, (size_t)m->count * sizeof *m->entry);
        memcpy(grown.block, m->block, (size_t)m->count * size);
    }
    row_memory_free(context, m, size);
    *m = grown;
    return PDYN_OK;
}

void row_memory_set(struct row_memory *m, const uint64_t *key, const void *block, int count,
                    size_t size) {
    for (int k = 0; k < count; k++) m->entry[k] = (struct keyed){key[k], k};
    sort_by_key(m->entry, count);
    for (int k = 0; k < count; k++)
        memcpy(m->block + (size_t)k * size,
               (const unsigned char *)block + (size_t)m->entry[k].place * size, size);
    m->count = count;
}

static const void *find(const struct row_memory *m, uint64_t key, size_t size) {
    int low = 0, high = m->count;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (m->entry[middle].key < key) low = middle + 1;
        else high = middle;
    }
    if (low == m->count || m->entry[low].key != key) return NULL;
    return m->block + (size_t)low * size;
}

void row_memory_get(const struct row_memory *m, const uint64_t *key, void *block, int count,
                    size_t size) {
    unsigned char *to = block;
    for (int k = 0; k < count; k++, to += size) {
        const void *from = find(m, key[k], size);
        if (from) memcpy(to, from, size);
        else memset(to, 0, size);
    }
}

void row_memory_persist(pdyn_context *context, struct row_memory *m, size_t size,
                        struct snapshot_file *snapshot) {
    int count = m->count;
    bool ascending = true;
    snapshot_file_count(snapshot, &count, sizeof m->entry->key + size,
                        "the number of remembered elements is out of range");
    if (snapshot->status != PDYN_OK) return;
    if (snapshot->view.reading) snapshot->status = row_memory_reserve(context, m, count, size);
    if (snapshot->status != PDYN_OK) return;
    m->count = count;
    for (int k = 0; k < count; k++) {
        SNAPSHOT(snapshot, m->entry[k].key);
        ascending &= !k || m->entry[k - 1].key <= m->entry[k].key;
    }
    snapshot_file_require(snapshot, ascending, "the keys of remembered elements are not ascending");
    snapshot_file_bytes(snapshot, m->block, (size_t)count * size);
}
