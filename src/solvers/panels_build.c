/* Setting up panels.h: which columns are a panel, which panels a task, and their numbers. */
#include "panels.h"

#include "base/simd.h"

#include <math.h>

enum { TASKS = 16 }; /* a task is at most this part of all numbers of the factor */

/* ---- layout ---------------------------------------------------------------------------------- */

static bool allocate(struct panels *s) {
    pdyn_context *c = s->context;
    s->particle = NEW_ARRAY(c, s->columns, int);
    s->panel = NEW_ARRAY(c, s->panels, struct panel);
    s->place = NEW_ARRAY(c, s->rows, int);
    s->column_of = NEW_ARRAY(c, s->columns + s->rows, int);
    s->task = NEW_ARRAY(c, s->panels, struct task);
    s->top = NEW_ARRAY(c, s->panels, int);
    return s->particle && s->panel && (!s->rows || s->place) && s->column_of && s->task && s->top;
}

static size_t scratch_numbers(const struct panels *s) {
    return 4 * (size_t)s->widest * (size_t)(s->tasks + 1);
}

static void release_values(struct panels *s) {
    FREE_ARRAY(s->context, s->value, s->values);
    FREE_ARRAY(s->context, s->work, 4 * (size_t)s->places);
    FREE_ARRAY(s->context, s->scratch, scratch_numbers(s));
}

void panels_free(struct panels *s) {
    if (!s->context) return;
    release_values(s);
    FREE_ARRAY(s->context, s->particle, s->columns);
    FREE_ARRAY(s->context, s->panel, s->panels);
    FREE_ARRAY(s->context, s->place, s->rows);
    FREE_ARRAY(s->context, s->column_of, s->columns + s->rows);
    FREE_ARRAY(s->context, s->task, s->panels);
    FREE_ARRAY(s->context, s->top, s->panels);
    *s = (struct panels){0};
}

/* Panels, their rows (as columns, at first) and parents. column_of serves as the panel of each
 * column meanwhile. */
static void read_panels(struct panels *s, const cholmod_factor *factor) {
    const int *super = factor->super, *start = factor->pi, *row = factor->s;
    int *panel_of = s->column_of, rows = 0;
    for (int q = 0; q < s->panels; q++) {
        struct panel *p = &s->panel[q];
        *p = (struct panel){
            .first = super[q], .columns = super[q + 1] - super[q], .row = rows, .value = s->values};
        p->rows = start[q + 1] - start[q] - p->columns;
        if (p->rows)
            memcpy(s->place + rows, row + start[q] + p->columns, (size_t)p->rows * sizeof *row);
        for (int k = 0; k < p->columns; k++) panel_of[p->first + k] = q;
        rows += p->rows;
        s->values += panel_values(p);
        if (p->columns > s->widest) s->widest = p->columns;
    }
    for (int q = 0; q < s->panels; q++)
        s->panel[q].parent = s->panel[q].rows ? panel_of[s->place[s->panel[q].row]] : -1;
}

/* The numbers in each panel's subtree, and its first panel; subtrees are contiguous, for CHOLMOD
 * orders columns by a postorder of their tree. */
static void weigh_subtrees(const struct panels *s, double *weight, int *low) {
    for (int q = 0; q < s->panels; q++) weight[q] = (double)panel_values(&s->panel[q]), low[q] = q;
    for (int q = 0; q < s->panels; q++) {
        int parent = s->panel[q].parent;
        if (parent < 0) continue;
        weight[parent] += weight[q];
        if (low[q] < low[parent]) low[parent] = low[q];
    }
}

/* The largest subtrees within a limit, neighbours together as far as it allows. */
static void split(struct panels *s, const double *weight, const int *low) {
    double limit = s->values < PANELS_WORTH ? 0.0 : (double)s->values / TASKS, filled = 0.0;
    for (int q = 0; q < s->panels; q++) {
        int parent = s->panel[q].parent;
        if (weight[q] > limit) s->top[s->tops++] = q;
        if (weight[q] > limit || (parent >= 0 && weight[parent] <= limit)) continue;
        struct task *last = s->tasks ? &s->task[s->tasks - 1] : NULL;
        if (last && last->last == low[q] && filled + weight[q] <= limit) last->last = q + 1;
        else s->task[s->tasks++] = (struct task){.first = low[q], .last = q + 1}, filled = 0.0;
        filled += weight[q];
    }
}

/* Rows of the top get places of each task's own behind the columns. seen: columns, zero. */
static void find_places(struct panels *s, int *seen) {
    s->places = s->columns;
    for (int k = 0; k < s->columns; k++) s->column_of[k] = k;
    for (int k = 0; k < s->tasks; k++) {
        struct task *task = &s->task[k];
        const struct panel *last = &s->panel[task->last - 1];
        int end = last->first + last->columns;
        task->outside = s->places;
        for (int r = s->panel[task->first].row; r < last->row + last->rows; r++) {
            int column = s->place[r];
            if (column < end) continue;
            if (seen[column] < task->outside) {
                s->column_of[s->places] = column;
                seen[column] = s->places++;
            }
            s->place[r] = seen[column];
        }
        task->outside_end = s->places;
    }
}

static pdyn_status lay_out(struct panels *s) {
    double *weight = NEW_ARRAY(s->context, s->panels, double);
    int *low = NEW_ARRAY(s->context, s->panels, int),
        *seen = NEW_ARRAY(s->context, s->columns, int);
    if (weight && low && seen) {
        weigh_subtrees(s, weight, low);
        split(s, weight, low);
        find_places(s, seen);
        s->value = NEW_ARRAY(s->context, s->values, double);
        s->work = NEW_ARRAY(s->context, 4 * (size_t)s->places, double);
        s->scratch = NEW_ARRAY(s->context, scratch_numbers(s), double);
    }
    FREE_ARRAY(s->context, weight, s->panels);
    FREE_ARRAY(s->context, low, s->panels);
    FREE_ARRAY(s->context, seen, s->columns);
    return s->value && s->work && s->scratch ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status panels_build(struct panels *s, pdyn_context *context, const cholmod_factor *factor) {
    panels_free(s);
    s->context = context;
    s->columns = (int)factor->n, s->panels = (int)factor->nsuper;
    s->rows = ((const int *)factor->pi)[s->panels] - s->columns;
    if (!allocate(s)) return PDYN_NO_MEMORY;
    memcpy(s->particle, factor->Perm, (size_t)s->columns * sizeof *s->particle);
    read_panels(s, factor);
    return lay_out(s);
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* W = D^-1, lower triangles, columns x columns by columns; D: by columns, `stride` from one to the
 * next */
WIDE static void invert(const double *D, size_t stride, int columns, double *W) {
    for (int j = 0; j < columns; j++) {
        double *w = W + (size_t)j * (size_t)columns;
        memset(w, 0, (size_t)columns * sizeof *w);
        w[j] = 1.0;
        for (int m = j; m < columns; m++) {
            const double *d = D + (size_t)m * stride;
            w[m] /= d[m];
            for (int i = m + 1; i < columns; i++) w[i] -= d[i] * w[m];
        }
    }
}

/* A tile of so many rows of -R W, from the rows of R. */
WIDE static void multiply_below(const double *R, size_t stride, int rows, const double *W,
                                int columns, double *tile) {
    for (int j = 0; j < columns; j++, tile += TILE) {
        const double *w = W + (size_t)j * (size_t)columns;
        double sum[TILE] = {0};
        if (rows == TILE)
            for (int m = j; m < columns; m++)
                for (int i = 0; i < TILE; i++) sum[i] -= R[(size_t)m * stride + (size_t)i] * w[m];
        else
            for (int m = j; m < columns; m++)
                for (int i = 0; i < rows; i++) sum[i] -= R[(size_t)m * stride + (size_t)i] * w[m];
        memcpy(tile, sum, sizeof sum);
    }
}

/* A tile of W, of so many columns. */
static void copy_triangle(const double *W, const struct panel *p, int t, int columns,
                          double *tile) {
    for (int j = 0; j < columns; j++)
        for (int i = TILE * t; i < TILE * (t + 1); i++, tile++)
            *tile = i < p->columns ? W[(size_t)j * (size_t)p->columns + (size_t)i] : 0.0;
}

/* W: columns x columns */
static void fill_panel(const struct panels *s, const struct panel *p, const double *L, double *W) {
    int triangle = tiles_of(p->columns);
    size_t stride = (size_t)(p->columns + p->rows);
    invert(L, stride, p->columns, W);
    for (int t = 0; t < panel_tiles(p); t++) {
        int columns = tile_columns(p, t), row = TILE * (t - triangle), left = p->rows - row;
        double *tile = s->value + p->value + tile_start(p, t);
        if (t < triangle) copy_triangle(W, p, t, columns, tile);
        else
            multiply_below(L + p->columns + row, stride, left < TILE ? left : TILE, W, columns,
                           tile);
    }
}

pdyn_status panels_fill(struct panels *s, const cholmod_factor *factor) {
    const int *start = factor->px;
    size_t count = (size_t)s->widest * (size_t)s->widest;
    double *W = NEW_ARRAY(s->context, count, double);
    if (!W) return PDYN_NO_MEMORY;
    for (int q = 0; q < s->panels; q++)
        fill_panel(s, &s->panel[q], (const double *)factor->x + start[q], W);
    FREE_ARRAY(s->context, W, count);
    return PDYN_OK;
}
