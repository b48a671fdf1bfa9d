#include "block_skyline.h"

#include "memory.h"
#include "projdyn/simd.h"

#include <math.h>

enum {
    FOUR = 4,  /* columns of L that are found at once */
    PANEL = 16 /* block rows that are factored on several threads */
};

/* Numbers in `value`. */
static size_t size_of(const struct skyline *s) { return 9 * s->start[s->nodes]; }

pdyn_status skyline_create(struct skyline *s, const pdyn_services *services, int nodes,
                           const int *first) {
    s->services = services, s->nodes = nodes;
    s->first = NEW(services, nodes, int);
    s->start = NEW(services, nodes + 1, size_t);
    s->origin = NEW(services, 3 * nodes, ptrdiff_t);
    if ((nodes && !(s->first && s->origin)) || !s->start) return PDYN_NO_MEMORY;
    for (int i = nodes - 1; i >= 0; i--) {
        bool beyond = i + 1 < nodes && first[i] > s->first[i + 1];
        s->first[i] = beyond ? s->first[i + 1] : first[i];
    }
    for (int i = 0; i < nodes; i++) s->start[i + 1] = s->start[i] + (size_t)(i - s->first[i] + 1);
    s->value = NEW(services, size_of(s), double);
    s->factor = NEW(services, size_of(s), float);
    if (nodes && !(s->value && s->factor)) return PDYN_NO_MEMORY;
    for (int r = 0; r < 3 * nodes; r++)
        s->origin[r] = skyline_row(s, r / 3, r % 3) - s->value - 3 * s->first[r / 3];
    return PDYN_OK;
}

void skyline_free(struct skyline *s) {
    if (!s->services) return;
    if (s->start) {
        FREE(s->services, s->value, size_of(s));
        FREE(s->services, s->factor, size_of(s));
    }
    FREE(s->services, s->start, s->nodes + 1);
    FREE(s->services, s->first, s->nodes);
    FREE(s->services, s->origin, 3 * s->nodes);
}

/* ---- the factor ------------------------------------------------------------------------------ */

/* out[q] = the sum of the lanes of x[q] */
INLINE void sum_lanes(v4 *out, const v4 x[FOUR]) {
    v4 a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6) +
           __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7);
    v4 b = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6) +
           __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
    *out = __builtin_shufflevector(a, b, 0, 1, 4, 5) + __builtin_shufflevector(a, b, 2, 3, 6, 7);
}

/* sum[p][q] = row[p] . other[q] over the first `count` numbers, lane by lane */
INLINE void multiply_rows(v4 sum[3][FOUR], double *const row[3], const double *const other[FOUR],
                          int count) {
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < FOUR; q++) sum[p][q] = (v4){0};
    for (int m = 0; m < count; m += 4) {
        v4 x[3], y;
        for (int p = 0; p < 3; p++) memcpy(&x[p], row[p] + m, sizeof x[p]);
        for (int q = 0; q < FOUR; q++) {
            memcpy(&y, other[q] + m, sizeof y);
            for (int p = 0; p < 3; p++) sum[p][q] += x[p] * y;
        }
    }
}

/* Columns k to k + 3 of three rows of L, from A's values there and L's columns before them. other:
 * the four rows of L whose diagonals are in these columns. */
INLINE void factor_four_columns(double *const row[3], const double *const other[FOUR], int k) {
    v4 sum[3][FOUR];
    multiply_rows(sum, row, other, k);
    for (int p = 0; p < 3; p++) {
        double own[FOUR];
        v4 rest, found;
        sum_lanes(&rest, sum[p]);
        for (int q = 0; q < FOUR; q++) {
            own[q] = row[p][k + q] - rest[q];
            for (int r = 0; r < q; r++) own[q] -= own[r] * other[q][k + r];
            own[q] *= other[q][k + q];
        }
        found = (v4){own[0], own[1], own[2], own[3]};
        memcpy(row[p] + k, &found, sizeof found);
    }
}

/* Scalar row r of L, from the first column of block row i. */
INLINE double *row_at(const struct skyline *s, int i, int r) {
    return s->value + s->origin[r] + 3 * s->first[i];
}

/* Columns k to n + 2 of a block row: its diagonal block, and at most three columns before it. */
INLINE bool factor_diagonal(const struct skyline *s, int i, double *const row[3], int k, int n) {
    int f = 3 * s->first[i];
    double sum[3][2 * FOUR];
    bool good = true;
    for (int c = k; c < n + 3; c += FOUR) {
        v4 part[3][FOUR], all;
        const double *other[FOUR];
        for (int q = 0; q < FOUR; q++) other[q] = row_at(s, i, f + (c + q < n + 3 ? c + q : c));
        multiply_rows(part, row, other, k);
        for (int p = 0; p < 3; p++)
            sum_lanes(&all, part[p]), memcpy(sum[p] + (c - k), &all, sizeof all);
    }
    for (int p = 0; p < 3; p++)
        for (int m = k; m <= n + p; m++) {
            const double *other = row_at(s, i, f + m);
            double rest = row[p][m] - sum[p][m - k];
            for (int r = k; r < m; r++) rest -= row[p][r] * other[r];
            if (m < n + p) row[p][m] = rest * other[m];
            else good &= rest > 0.0, row[p][m] = rest > 0.0 ? 1.0 / sqrt(rest) : 0.0;
        }
    return good;
}

/* The three rows of block row i. */
INLINE void rows_of(const struct skyline *s, int i, double *row[3]) {
    for (int p = 0; p < 3; p++) row[p] = row_at(s, i, 3 * i + p);
}

/* Columns of block row i from its column k on, four at a time, as far as they lie before block
 * column `end`. Returns the first column that is left. */
INLINE int factor_columns(const struct skyline *s, int i, int k, int end) {
    int f = 3 * s->first[i];
    double *row[3];
    rows_of(s, i, row);
    for (; k + FOUR <= 3 * end - f; k += FOUR) {
        const double *other[FOUR];
        for (int q = 0; q < FOUR; q++) other[q] = row_at(s, i, f + k + q);
        factor_four_columns(row, other, k);
    }
    return k;
}

struct panel { /* block rows that are factored together */
    const struct skyline *s;
    int first;
    int done[PANEL]; /* columns of each row that are done */
};

/* Columns before the panel: they need no other row of it. */
WIDE static void factor_before_panel(void *arg, int first, int last, int block) {
    (void)block;
    struct panel *panel = arg;
    for (int r = first; r < last; r++)
        panel->done[r] = factor_columns(panel->s, panel->first + r, 0, panel->first);
}

/* The other columns, row after row. */
WIDE static bool factor_panel(const struct panel *panel, int rows) {
    const struct skyline *s = panel->s;
    bool good = true;
    for (int r = 0; r < rows; r++) {
        int i = panel->first + r, n = 3 * (i - s->first[i]);
        double *row[3];
        rows_of(s, i, row);
        good &= factor_diagonal(s, i, row, factor_columns(s, i, panel->done[r], i), n);
    }
    return good;
}

/* L in single precision: solves wait for memory. */
WIDE static void copy_factor(const struct skyline *s) {
    for (size_t k = 0; k < size_of(s); k++) s->factor[k] = (float)s->value[k];
}

bool skyline_factor(struct skyline *s) {
    bool good = true;
    for (int i = 0; i < s->nodes; i += PANEL) {
        struct panel panel = {.s = s, .first = i};
        int rows = s->nodes - i < PANEL ? s->nodes - i : PANEL;
        s->services->parallel_for(s->services->core, rows, 1, factor_before_panel, &panel);
        good &= factor_panel(&panel, rows);
    }
    copy_factor(s);
    return good;
}

/* ---- solves ---------------------------------------------------------------------------------- */

/* The three rows of block row i of the copy of L, from its first column. */
INLINE void rows_of_copy(const struct skyline *s, int i, const float *row[3]) {
    for (int p = 0; p < 3; p++) row[p] = s->factor + (skyline_row(s, i, p) - s->value);
}

/* x = L^-1 x in block row i */
INLINE void substitute_forward(const float *const row[3], const double *x, int n, double *own) {
    v4 sum[3] = {{0}}, a, b;
    double rest[3] = {0};
    int k = 0;
    for (; k + 4 <= n; k += 4) {
        memcpy(&b, x + k, sizeof b);
        for (int p = 0; p < 3; p++) v4_widen(&a, row[p] + k), sum[p] += a * b;
    }
    for (; k < n; k++)
        for (int p = 0; p < 3; p++) rest[p] += (double)row[p][k] * x[k];
    for (int p = 0; p < 3; p++) {
        own[p] -= v4_sum(&sum[p]) + rest[p];
        for (int q = 0; q < p; q++) own[p] -= (double)row[p][n + q] * own[q];
        own[p] *= (double)row[p][n + p];
    }
}

/* x = L^-T x there, which leaves its part of those before it */
INLINE void substitute_backward(const float *const row[3], double *x, int n, double *own) {
    v4 a, b;
    int k = 0;
    for (int p = 2; p >= 0; p--) {
        for (int q = p + 1; q < 3; q++) own[p] -= (double)row[q][n + p] * own[q];
        own[p] *= (double)row[p][n + p];
    }
    double known[3] = {own[0], own[1], own[2]};
    for (; k + 4 <= n; k += 4) {
        memcpy(&b, x + k, sizeof b);
        for (int p = 0; p < 3; p++) v4_widen(&a, row[p] + k), b -= known[p] * a;
        memcpy(x + k, &b, sizeof b);
    }
    for (; k < n; k++)
        for (int p = 0; p < 3; p++) x[k] -= known[p] * (double)row[p][k];
}

WIDE static void substitute(const struct skyline *s, double *x) {
    const float *row[3];
    for (int i = 0; i < s->nodes; i++) {
        rows_of_copy(s, i, row);
        substitute_forward(row, x + 3 * s->first[i], 3 * (i - s->first[i]), x + 3 * i);
    }
    for (int i = s->nodes - 1; i >= 0; i--) {
        rows_of_copy(s, i, row);
        substitute_backward(row, x + 3 * s->first[i], 3 * (i - s->first[i]), x + 3 * i);
    }
}

void skyline_solve(const struct skyline *s, double *x) { substitute(s, x); }
