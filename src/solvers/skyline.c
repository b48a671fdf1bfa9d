#include "skyline.h"

#include "../core/simd.h"

#include <math.h>

pdyn_status skyline_create(struct skyline *s, pdyn_context *context, int rows, const int *first) {
    s->context = context, s->rows = rows;
    s->first = NEW_ARRAY(context, rows, int);
    s->start = NEW_ARRAY(context, rows + 1, size_t);
    if ((rows && !s->first) || !s->start) return PDYN_NO_MEMORY;
    for (int i = 0; i < rows; i++) {
        s->first[i] = first[i];
        s->start[i + 1] = s->start[i] + (size_t)(i - first[i] + 1);
    }
    s->value = NEW_ARRAY(context, s->start[rows], double);
    return s->value || !rows ? PDYN_OK : PDYN_NO_MEMORY;
}

void skyline_free(struct skyline *s) {
    if (!s->context) return;
    if (s->start) FREE_ARRAY(s->context, s->value, s->start[s->rows]);
    FREE_ARRAY(s->context, s->start, s->rows + 1);
    FREE_ARRAY(s->context, s->first, s->rows);
}

/* The product of rows i and j of L before column j. */
INLINE double skyline_rows(const struct skyline *s, int i, int j) {
    int from = s->first[i] > s->first[j] ? s->first[i] : s->first[j];
    if (from >= j) return 0.0;
    return simd_dot(skyline_at(s, i, from), skyline_at(s, j, from), j - from);
}

WIDE static bool factor_rows(const struct skyline *s) {
    bool good = true;
    for (int i = 0; i < s->rows; i++) {
        double *row = s->value + s->start[i];
        for (int j = s->first[i]; j < i; j++) {
            double *at = row + (j - s->first[i]);
            *at = (*at - skyline_rows(s, i, j)) * *skyline_at(s, j, j);
        }
        double *own = row + (i - s->first[i]), pivot = *own - skyline_rows(s, i, i);
        good &= pivot > 0.0;
        *own = pivot > 0.0 ? 1.0 / sqrt(pivot) : 0.0;
    }
    return good;
}

WIDE static void substitute(const struct skyline *s, double *x) {
    for (int i = 0; i < s->rows; i++) {
        const double *row = s->value + s->start[i];
        int f = s->first[i], n = i - f;
        x[i] = (x[i] - simd_dot(row, x + f, n)) * row[n];
    }
    for (int i = s->rows - 1; i >= 0; i--) {
        const double *row = s->value + s->start[i];
        int f = s->first[i], n = i - f;
        x[i] *= row[n];
        for (int k = 0; k < n; k++) x[f + k] -= x[i] * row[k];
    }
}

bool skyline_factor(struct skyline *s) { return factor_rows(s); }

void skyline_solve(const struct skyline *s, double *x) { substitute(s, x); }
