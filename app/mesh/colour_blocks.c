/* Samples of a colour field near its surface: the blocks in reach of particles that are not deep,
 * and the blocks into which the surface runs from these. */
#include "app.h"
#include "colour_field.h"
#include "parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GRAIN = 32, MOST_BINS = 5 * 5 * 5 }; /* MOST_BINS: that the particles of one bin reach */

/* ---- blocks ---------------------------------------------------------------------------------- */

/* Bins `low` to `high` in which particles of bin b that are not deep contribute to a cell. Returns
 * whether there are any. */
static bool reach_of_bin(const struct colour_field *field, int b, int low[3], int high[3]) {
    bool any = false;
    double reach = field->support + field->cell;
    for (int i = field->first[b]; i < field->first[b + 1]; i++) {
        if (field->deep[i] || colour_is_alone(field, i)) continue;
        for (int a = 0; a < 3; a++) {
            double x = (double)field->x[3 * (size_t)i + (size_t)a];
            int from = (int)floor((x - reach) / field->support);
            int to = (int)floor((x + reach) / field->support);
            low[a] = any && low[a] < from ? low[a] : from;
            high[a] = any && high[a] > to ? high[a] : to;
        }
        any = true;
    }
    return any;
}

static int compare_keys(const void *a, const void *b) {
    uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

static int unique_keys(uint64_t *key, size_t count) {
    size_t kept = 0;
    qsort(key, count, sizeof *key, compare_keys);
    for (size_t k = 0; k < count; k++)
        if (!kept || key[k] != key[kept - 1]) key[kept++] = key[k];
    return (int)kept;
}

/* A list of keys that grows. */
struct key_list {
    uint64_t *key;
    size_t count, capacity;
};

static int add_keys(struct key_list *list, const uint64_t *key, int count) {
    if (list->count + (size_t)count > list->capacity) {
        size_t capacity = 2 * list->count + 4096;
        uint64_t *grown = realloc(list->key, capacity * sizeof *grown);
        if (!grown) return report_no_memory();
        list->key = grown, list->capacity = capacity;
    }
    memcpy(list->key + list->count, key, (size_t)count * sizeof *key);
    list->count += (size_t)count;
    return EXIT_GOOD;
}

/* Lists the bins in reach of the particles that are not deep; removes duplicates as it goes. */
static int list_reached(const struct colour_field *field, struct key_list *list) {
    int code = EXIT_GOOD;
    for (int b = 0; b < field->bins && code == EXIT_GOOD; b++) {
        uint64_t key[MOST_BINS];
        int low[3] = {0}, high[3] = {0}, at[3], count = 0;
        if (!reach_of_bin(field, b, low, high)) continue;
        for (at[2] = low[2]; at[2] <= high[2]; at[2]++)
            for (at[1] = low[1]; at[1] <= high[1]; at[1]++)
                for (at[0] = low[0]; at[0] <= high[0]; at[0]++) key[count++] = colour_key(at);
        if (list->count + (size_t)count > list->capacity && list->count)
            list->count = (size_t)unique_keys(list->key, list->count);
        code = add_keys(list, key, count);
    }
    if (list->count) list->count = (size_t)unique_keys(list->key, list->count);
    return code;
}

/* Adds a particle to the samples of a block. p: its position relative to the block, in cells. */
static void add_particle(const double p[3], double weight, double value[BLOCK_SAMPLES]) {
    const double inverse = 1.0 / (BLOCK * BLOCK); /* 1 / support^2, in cells */
    for (int k = 0; k < BLOCK; k++)
        for (int j = 0; j < BLOCK; j++) {
            double y = j - p[1], z = k - p[2], yz = 1.0 - (y * y + z * z) * inverse;
            if (yz <= 0.0) continue;
            for (int i = 0; i < BLOCK; i++) {
                double x = i - p[0], rest = yz - x * x * inverse, square = rest * rest;
                value[(k * BLOCK + j) * BLOCK + i] +=
                    rest > 0.0 ? weight * square * square * rest : 0.0;
            }
        }
}

struct block_sampling {
    struct colour_field *field;
    const bool *fresh; /* blocks: has no samples yet */
};

static void sample_blocks(void *self, int first, int last) {
    const struct block_sampling *sampling = self;
    struct colour_field *field = sampling->field;
    for (int b = first; b < last; b++) {
        if (!sampling->fresh[b]) continue;
        double value[BLOCK_SAMPLES] = {0}, p[3];
        int at[3];
        colour_coordinates(field->block[b], at);
        struct colour_rows rows = colour_rows_around(field, at);
        for (int r = 0; r < 9; r++)
            for (int j = rows.first[r]; j < rows.last[r]; j++) {
                for (int a = 0; a < 3; a++)
                    p[a] =
                        (double)field->x[3 * (size_t)j + (size_t)a] / field->cell - BLOCK * at[a];
                add_particle(p, (double)field->weight[j], value);
            }
        for (int s = 0; s < BLOCK_SAMPLES; s++)
            field->value[(size_t)b * BLOCK_SAMPLES + (size_t)s] = (float)value[s];
    }
}

/* ---- blocks beside --------------------------------------------------------------------------- */

bool colour_is_inside(float value) { return value >= (float)COLOUR_ISO; }

/* Whether a bin without samples counts as inside of the fluid: it has particles, all of them deep.
 */
bool colour_is_deep(const struct colour_field *field, uint64_t key) {
    return colour_find(field->bin, field->bins, key) >= 0;
}

/* Whether a sample of block b that faces the neighbour at `offset` is on the given side. */
static bool faces_with(const struct colour_field *field, int b, const int offset[3], bool inside) {
    const float *value = field->value + (size_t)b * BLOCK_SAMPLES;
    int first[3], last[3];
    for (int a = 0; a < 3; a++) {
        first[a] = offset[a] > 0 ? BLOCK - 1 : 0;
        last[a] = offset[a] < 0 ? 0 : BLOCK - 1;
    }
    for (int k = first[2]; k <= last[2]; k++)
        for (int j = first[1]; j <= last[1]; j++)
            for (int i = first[0]; i <= last[0]; i++)
                if (colour_is_inside(value[(k * BLOCK + j) * BLOCK + i]) == inside) return true;
    return false;
}

/* Lists the missing neighbours of block b into which the surface runs; returns their number. */
static int missing_neighbours(const struct colour_field *field, int b, uint64_t key[27]) {
    int count = 0, at[3];
    colour_coordinates(field->block[b], at);
    for (int n = 0; n < 27; n++) {
        const int offset[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        uint64_t next =
            colour_key((const int[]){at[0] + offset[0], at[1] + offset[1], at[2] + offset[2]});
        if (colour_find(field->block, field->blocks, next) < 0 &&
            faces_with(field, b, offset, !colour_is_deep(field, next)))
            key[count++] = next;
    }
    return count;
}

/* Lists the missing neighbours of the fresh blocks. */
static int list_missing(const struct colour_field *field, const bool *fresh,
                        struct key_list *list) {
    int code = EXIT_GOOD;
    list->count = 0;
    for (int b = 0; b < field->blocks && code == EXIT_GOOD; b++) {
        uint64_t key[27];
        if (fresh[b]) code = add_keys(list, key, missing_neighbours(field, b, key));
    }
    if (list->count) list->count = (size_t)unique_keys(list->key, list->count);
    return code;
}

/* Adds the blocks of a list, which the field does not have, with their samples. Then lists their
 * missing neighbours. */
static int add_blocks(struct colour_field *field, struct key_list *list, int threads) {
    size_t total = (size_t)field->blocks + list->count, old = (size_t)field->blocks,
           more = list->count;
    uint64_t *block = realloc(field->block, (total + 1) * sizeof *block);
    if (block) field->block = block;
    float *value = realloc(field->value, (total + 1) * BLOCK_SAMPLES * sizeof *value);
    if (value) field->value = value;
    bool *fresh = malloc(total + 1);
    if (!block || !value || !fresh) return free(fresh), report_no_memory();
    for (size_t at = total; at-- > 0;) { /* from the end, where there is room */
        fresh[at] = more && (!old || list->key[more - 1] > block[old - 1]);
        if (fresh[at]) block[at] = list->key[--more];
        else {
            block[at] = block[--old];
            memmove(value + at * BLOCK_SAMPLES, value + old * BLOCK_SAMPLES,
                    BLOCK_SAMPLES * sizeof *value);
        }
    }
    field->blocks = (int)total;
    parallel_for(threads, field->blocks, GRAIN, sample_blocks,
                 &(struct block_sampling){field, fresh});
    int code = list_missing(field, fresh, list);
    free(fresh);
    return code;
}

int colour_sample_surface(struct colour_field *field, int threads) {
    struct key_list list = {0};
    int code = list_reached(field, &list);
    while (code == EXIT_GOOD && list.count) code = add_blocks(field, &list, threads);
    free(list.key);
    return code;
}
