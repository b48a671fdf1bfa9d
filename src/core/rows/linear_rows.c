/* Rows with p = 0 and J = 0, added up to one constant matrix: products, energy and construction. */
#include "linear_rows.h"

#include "batch.h"
#include "projdyn/simd.h"
#include "projdyn/vec3.h"

enum { GRAIN = 512 }; /* particles */

struct call {
    struct linear_rows *k;
    const double *x;
    double *y;
};

/* Sums run in several lanes, so that no addition waits for the one before. */
enum { LANES = 4 };

enum { AHEAD = 512 }; /* prefetches so many entries ahead: K may be larger than the L2 cache */

/* sum += K_ij (x_j - x_i) of entry t */
INLINE void add_entry(const struct linear_rows *k, int t, const double *x, const v4 *xi, v4 *sum,
                      v4 *squares) {
    v4 xj;
    memcpy(&xj, x + 3 * (size_t)k->column[t], sizeof xj);
    xj -= *xi;
    v4 force = k->value[t] * xj;
    *sum += force;
    if (squares) *squares += force * xj;
}

/* y_i += sum_j K_ij (x_j - x_i) + own_i x_i: what neighbours have in common does not round. Adds
 * twice the energy's part of i, the fourth lane means nothing. */
INLINE void multiply_row(const struct call *c, int i, v4 *energy) {
    const struct linear_rows *k = c->k;
    v4 x, sum[LANES] = {{0}}, squares[LANES] = {{0}};
    int t = k->start[i], end = k->start[i + 1];
    memcpy(&x, c->x + 3 * (size_t)(k->first + i), sizeof x);
    for (; t + LANES <= end; t += LANES) {
        __builtin_prefetch(k->value + t + AHEAD);
        __builtin_prefetch(k->column + t + AHEAD);
        for (int l = 0; l < LANES; l++)
            add_entry(k, t + l, c->x, &x, &sum[l], energy ? &squares[l] : NULL);
    }
    for (; t < end; t++) add_entry(k, t, c->x, &x, &sum[0], energy ? &squares[0] : NULL);
    v4 all = (sum[0] + sum[1]) + (sum[2] + sum[3]) + k->own[i] * x;
    v4_add_to(c->y + 3 * (size_t)(k->first + i), &all);
    if (!energy) return;
    *energy += k->own[i] * x * x - 0.5 * ((squares[0] + squares[1]) + (squares[2] + squares[3]));
}

WIDE static void multiply_rows(void *arg, int first, int last, int block) {
    (void)block;
    for (int i = first; i < last; i++) multiply_row(arg, i, NULL);
}

WIDE static void sum_energy(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    v4 energy = {0};
    for (int i = first; i < last; i++) multiply_row(c, i, &energy);
    c->k->partial[block] = 0.5 * (energy[0] + energy[1] + energy[2]);
}

void linear_rows_apply(struct linear_rows *k, const double *x, double *y) {
    struct call call = {k, x, y};
    pool_for(k->context->pool, k->count, GRAIN, multiply_rows, &call);
}

double linear_rows_energy(struct linear_rows *k, const double *x, double *y) {
    struct call call = {k, x, y};
    double sum = 0.0;
    pool_for(k->context->pool, k->count, GRAIN, sum_energy, &call);
    for (int b = 0; b < pool_blocks(k->count, GRAIN); b++) sum += k->partial[b];
    return sum;
}

void linear_rows_diagonal(const struct linear_rows *k, double *blocks) {
    for (int i = 0; i < k->count; i++)
        vec3_add_identity(blocks + 6 * (size_t)(k->first + i), k->diagonal[i]);
}

/* ---- setting up ------------------------------------------------------------------------------ */

/* Row i: its numbers where `value`, which begins at the row; returns how many entries beside the
 * diagonal. place: for each particle, the last row that met it and where; particles x 2. */
static int sum_row(const struct batch *b, int i, int *place, int *column, double *value,
                   double *diagonal) {
    const pdyn_batch *v = &b->view;
    int count = 0, self = b->touch_first + i;
    for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
        const struct touch *at = &b->touch[t];
        double w = v->weight[b->entry_element[at->entry]] * at->coefficient;
        for (int m = v->row_entry[at->row]; m < v->row_entry[at->row + 1]; m++) {
            int *met = place + 2 * (v->column[m] - b->touch_first);
            double number = w * v->coefficient[m];
            if (number == 0.0) continue;
            if (v->column[m] == self) {
                *diagonal += number;
                continue;
            }
            if (met[0] != i + 1) {
                if (value) column[count] = v->column[m], value[count] = 0.0;
                met[0] = i + 1, met[1] = count++;
            }
            if (value) value[met[1]] += number;
        }
    }
    return count;
}

/* The arrays but `start`, from which the number of entries follows. */
static bool resize_arrays(struct linear_rows *k, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(k->column, k->entries),
        ARRAY(k->value, k->entries),
        ARRAY(k->own, k->count),
        ARRAY(k->diagonal, k->count),
        ARRAY(k->partial, pool_blocks(k->count, GRAIN)),
    };
    return context_arrays(k->context, table, ARRAY_ROWS(table), action);
}

static void fill(struct linear_rows *k, const struct batch *b, int *place) {
    if (k->count) memset(place, 0, 2 * (size_t)k->count * sizeof *place);
    for (int i = 0; i < k->count; i++) {
        int from = k->start[i];
        int *column = k->entries ? k->column + from : NULL;
        sum_row(b, i, place, column, k->entries ? k->value + from : NULL, &k->diagonal[i]);
        k->own[i] = k->diagonal[i];
        for (int t = from; t < k->start[i + 1]; t++) k->own[i] += k->value[t];
    }
}

pdyn_status linear_rows_create(pdyn_context *context, const struct batch *b,
                               struct linear_rows **out) {
    struct linear_rows *k = *out = NEW_ARRAY(context, 1, struct linear_rows);
    if (!k) return PDYN_NO_MEMORY;
    *k = (struct linear_rows){.context = context, .first = b->touch_first, .count = b->touch_count};
    k->start = NEW_ARRAY(context, k->count + 1, int);
    int *place = NEW_ARRAY(context, 2 * (size_t)k->count, int);
    bool good = k->start && (!k->count || place);
    double unused = 0.0;
    for (int i = 0; good && i < k->count; i++)
        k->start[i + 1] = k->entries += sum_row(b, i, place, NULL, NULL, &unused);
    good = good && resize_arrays(k, ARRAYS_ALLOCATE);
    if (good) fill(k, b, place);
    FREE_ARRAY(context, place, 2 * (size_t)k->count);
    if (good) return PDYN_OK;
    linear_rows_free(k);
    *out = NULL;
    return PDYN_NO_MEMORY;
}

void linear_rows_free(struct linear_rows *k) {
    if (!k) return;
    resize_arrays(k, ARRAYS_FREE);
    FREE_ARRAY(k->context, k->start, k->count + 1);
    FREE_ARRAY(k->context, k, 1);
}
