#include "poisson_disk.h"
#include "projdyn/vec3.h"

#include <math.h>

static const double cell_edge = 2.1; /* distances: a little more than two, against rounding */

static const double *point(const struct poisson_disk *set, int k) {
    return set->at.x + 3 * (size_t)k;
}

static bool is_close(const struct poisson_disk *set, int k, const double x[3]) {
    double r[3];
    vec3_subtract(r, point(set, k), x);
    return vec3_dot(r, r) < set->distance * set->distance;
}

/* The cell `shift` cells from x along each axis. */
static void find_cell(const struct poisson_disk *set, const double x[3], double shift,
                      int64_t cell[3]) {
    for (int a = 0; a < 3; a++)
        cell[a] = (int64_t)floor(x[a] / (cell_edge * set->distance) + shift);
}

static int *bucket_of(const struct poisson_disk *set, int64_t i, int64_t j, int64_t k) {
    uint64_t hash = (uint64_t)i * 73856093u ^ (uint64_t)j * 19349663u ^ (uint64_t)k * 83492791u;
    return &set->bucket[hash & (set->buckets - 1)];
}

/* Is a point of this bucket in the way? */
static bool is_in_bucket(struct poisson_disk *set, const int *bucket, const double x[3]) {
    for (int k = *bucket; k >= 0; k = set->next[k])
        if (is_close(set, k, x)) return set->last = k, true;
    return false;
}

/* Points are offered in rows, so the one in the way of the last point often is in the way again. */
static bool is_free(struct poisson_disk *set, const double x[3]) {
    int64_t at[3];
    if (!set->at.count) return true;
    if (is_close(set, set->last, x)) return false;
    find_cell(set, x, -0.5, at);
    for (int n = 0; n < 8; n++) {
        const int *bucket = bucket_of(set, at[0] + n % 2, at[1] + n / 2 % 2, at[2] + n / 4);
        if (is_in_bucket(set, bucket, x)) return false;
    }
    return true;
}

static void put_into_bucket(struct poisson_disk *set, int k) {
    int64_t cell[3];
    find_cell(set, point(set, k), 0.0, cell);
    int *bucket = bucket_of(set, cell[0], cell[1], cell[2]);
    set->next[k] = *bucket, *bucket = k;
}

/* Makes room for one more point: at least two buckets for each. */
static pdyn_status make_room(pdyn_context *context, struct poisson_disk *set) {
    size_t need = (size_t)set->at.count + 1, buckets = set->buckets ? 2 * set->buckets : 1024;
    int *next = context_grow(context, set->next, &set->chained, need, sizeof *next);
    if (!next) return PDYN_NO_MEMORY;
    set->next = next;
    if (2 * need <= set->buckets) return PDYN_OK;
    int *bucket = NEW_ARRAY(context, buckets, int);
    if (!bucket) return PDYN_NO_MEMORY;
    FREE_ARRAY(context, set->bucket, set->buckets);
    set->bucket = bucket, set->buckets = buckets;
    for (size_t b = 0; b < buckets; b++) bucket[b] = -1;
    for (int k = 0; k < set->at.count; k++) put_into_bucket(set, k);
    return PDYN_OK;
}

pdyn_status poisson_disk_offer(pdyn_context *context, struct poisson_disk *set, const double x[3],
                               bool *taken) {
    *taken = is_free(set, x);
    if (!*taken) return PDYN_OK;
    pdyn_status status = make_room(context, set);
    if (status == PDYN_OK) status = point_list_add(context, &set->at, x);
    if (status == PDYN_OK) put_into_bucket(set, set->at.count - 1);
    return status;
}

void poisson_disk_free(pdyn_context *context, struct poisson_disk *set) {
    FREE_ARRAY(context, set->next, set->chained);
    FREE_ARRAY(context, set->bucket, set->buckets);
    point_list_free(context, &set->at);
}
