#include "panels.h"

#include "../core/simd.h"

#include <math.h>

enum { TILE = 4 };   /* rows */
enum { TASKS = 16 }; /* a task is at most this part of all numbers of the factor, */
enum {
    WORTH = 50000
}; /* and there are none below so many; a panel of the top is shared above
      a quarter of it */
enum { ROW_TILES = 16, COLUMNS = 64 }; /* grains within such a panel */

/* ---- tiles ----------------------------------------------------------------------------------- */

static int tiles_of(int rows) { return (rows + TILE - 1) / TILE; }

/* Tiles of a panel: of the triangle D^-1 first, these have no columns right of it. */
static int panel_tiles(const struct panel *p) { return tiles_of(p->columns) + tiles_of(p->rows); }

INLINE int tile_columns(const struct panel *p, int tile) {
    return TILE * (tile + 1) < p->columns ? TILE * (tile + 1) : p->columns;
}

/* Numbers before a tile. */
INLINE size_t tile_start(const struct panel *p, int tile) {
    size_t triangle = (size_t)(p->columns + TILE - 1) / TILE, t = (size_t)tile;
    if (t < triangle) return TILE * TILE / 2 * t * (t + 1);
    return TILE * TILE / 2 * triangle * (triangle - 1) +
           TILE * (size_t)p->columns * (t - triangle + 1);
}

static size_t panel_values(const struct panel *p) { return tile_start(p, panel_tiles(p)); }

/* ---- products with T and T' ------------------------------------------------------------------ */

INLINE void load(v4 *to, const double *from, int index) {
    memcpy(to, from + 4 * (size_t)index, sizeof *to);
}
INLINE void store(double *to, int index, const v4 *from) {
    memcpy(to + 4 * (size_t)index, from, sizeof *from);
}

/* sum = tile x, of four rows and so many columns */
INLINE void multiply_tile(const double *value, int columns, const double *x, v4 sum[TILE]) {
    v4 a = {0}, b = {0}, c = {0}, d = {0};
    for (int j = 0; j < columns; j++, value += TILE) {
        v4 at;
        load(&at, x, j);
        a += value[0] * at, b += value[1] * at, c += value[2] * at, d += value[3] * at;
    }
    sum[0] = a, sum[1] = b, sum[2] = c, sum[3] = d;
}

/* Rows of T x in tiles [first, last): those of the triangle become the panel's part of the vector,
 * the others are added to the rows below. x: columns x 4, a copy of the panel's part. */
WIDE static void multiply(const struct panels *s, const struct panel *p, const double *x, int first,
                          int last) {
    int triangle = tiles_of(p->columns);
    const double *value = s->value + p->value + tile_start(p, first);
    for (int t = first; t < last; t++) {
        int columns = tile_columns(p, t), row = TILE * (t < triangle ? t : t - triangle);
        v4 sum[TILE], old;
        multiply_tile(value, columns, x, sum);
        value += TILE * (size_t)columns;
        if (t < triangle)
            for (int i = 0; i < TILE && row + i < p->columns; i++)
                store(s->work, p->first + row + i, &sum[i]);
        else
            for (int i = 0; i < TILE && row + i < p->rows; i++) {
                int place = s->place[p->row + row + i];
                load(&old, s->work, place);
                old += sum[i];
                store(s->work, place, &old);
            }
    }
}

/* Row i of so many left in a tile: zero beyond the last. place: of each row, or NULL for rows in
 * order. */
INLINE void load_row(v4 *c, const double *from, const int *place, int i, int left) {
    if (i < left) load(c, from, place ? place[i] : i);
    else *c = (v4){0};
}

/* y += tile' c in columns [first, last); c: the rows of the tile */
INLINE void add_transposed(const double *value, const double *from, const int *place, int left,
                           int first, int last, double *y) {
    v4 a, b, c, d;
    load_row(&a, from, place, 0, left);
    load_row(&b, from, place, 1, left);
    load_row(&c, from, place, 2, left);
    load_row(&d, from, place, 3, left);
    value += TILE * (size_t)first;
    for (int j = first; j < last; j++, value += TILE) {
        v4 sum;
        load(&sum, y, j);
        sum += (value[0] * a + value[1] * b) + (value[2] * c + value[3] * d);
        store(y, j, &sum);
    }
}

/* Columns [first, last) of the panel's part of the vector become those of T' [x; rows below]. */
WIDE static void multiply_transposed(const struct panels *s, const struct panel *p, const double *x,
                                     int first, int last) {
    double *y = s->work + 4 * (size_t)p->first;
    const double *value = s->value + p->value + tile_start(p, first / TILE);
    memset(y + 4 * (size_t)first, 0, 4 * (size_t)(last - first) * sizeof *y);
    for (int row = first / TILE * TILE; row < p->columns; row += TILE) {
        int columns = tile_columns(p, row / TILE);
        add_transposed(value, x + 4 * (size_t)row, NULL, p->columns - row, first,
                       columns < last ? columns : last, y);
        value += TILE * (size_t)columns;
    }
    for (int row = 0; row < p->rows; row += TILE, value += TILE * (size_t)p->columns)
        add_transposed(value, s->work, s->place + p->row + row, p->rows - row, first, last, y);
}

/* ---- substitution ---------------------------------------------------------------------------- */

static void copy_part(const struct panels *s, const struct panel *p, double *x) {
    memcpy(x, s->work + 4 * (size_t)p->first, 4 * (size_t)p->columns * sizeof *x);
}

static double *scratch_of(const struct panels *s, int task) {
    return s->scratch + 4 * (size_t)s->widest * (size_t)task;
}

struct call { /* the arguments of a parallel loop */
    struct panels *s;
    const struct panel *panel;
    const double *b;
    double *y, *x;
};

/* Columns of L [first, last): in from the particles' order, and out. */
static void take_in(struct panels *s, const double *b, int first, int last) {
    for (int k = first; k < last; k++) {
        const double *from = b + 3 * (size_t)s->particle[k];
        double *to = s->work + 4 * (size_t)k;
        to[0] = from[0], to[1] = from[1], to[2] = from[2], to[3] = 0.0;
    }
}

static void give_out(const struct panels *s, double *y, int first, int last) {
    for (int k = first; k < last; k++)
        memcpy(y + 3 * (size_t)s->particle[k], s->work + 4 * (size_t)k, 3 * sizeof *y);
}

static void forward_task(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct panels *s = c->s;
    for (int k = first; k < last; k++) {
        const struct task *task = &s->task[k];
        memset(s->work + 4 * (size_t)task->outside, 0,
               4 * (size_t)(task->outside_end - task->outside) * sizeof *s->work);
        for (int q = task->first; q < task->last; q++) {
            const struct panel *p = &s->panel[q];
            take_in(s, c->b, p->first, p->first + p->columns);
        }
        for (int q = task->first; q < task->last; q++) {
            const struct panel *p = &s->panel[q];
            copy_part(s, p, scratch_of(s, k));
            multiply(s, p, scratch_of(s, k), 0, panel_tiles(p));
        }
    }
}

static void backward_task(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct panels *s = c->s;
    for (int k = first; k < last; k++) {
        const struct task *task = &s->task[k];
        for (int q = task->outside; q < task->outside_end; q++)
            memcpy(s->work + 4 * (size_t)q, s->work + 4 * (size_t)s->column_of[q],
                   4 * sizeof *s->work);
        for (int q = task->last - 1; q >= task->first; q--) {
            const struct panel *p = &s->panel[q];
            copy_part(s, p, scratch_of(s, k));
            multiply_transposed(s, p, scratch_of(s, k), 0, p->columns);
            give_out(s, c->y, p->first, p->first + p->columns);
        }
    }
}

static void share_tiles(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    multiply(c->s, c->panel, c->x, first, last);
}

static void share_columns(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    multiply_transposed(c->s, c->panel, c->x, first, last);
}

/* A panel of the top, by all threads where it is large. */
static void top_panel(struct panels *s, int panel, pdyn_range_fn *share, int count, int grain) {
    const struct panel *p = &s->panel[panel];
    struct call call = {.s = s, .panel = p, .x = scratch_of(s, s->tasks)};
    copy_part(s, p, call.x);
    if (panel_values(p) < WORTH / 4) share(&call, 0, count, 0);
    else pool_for(s->context->pool, count, grain, share, &call);
}

static void solve_top(struct panels *s, const double *b, double *y) {
    for (int k = 0; k < s->tops; k++) {
        const struct panel *p = &s->panel[s->top[k]];
        take_in(s, b, p->first, p->first + p->columns);
    }
    for (int q = s->columns; q < s->places; q++)
        for (int a = 0; a < 4; a++)
            s->work[4 * (size_t)s->column_of[q] + a] += s->work[4 * (size_t)q + a];
    for (int k = 0; k < s->tops; k++)
        top_panel(s, s->top[k], share_tiles, panel_tiles(&s->panel[s->top[k]]), ROW_TILES);
    for (int k = s->tops - 1; k >= 0; k--) {
        const struct panel *p = &s->panel[s->top[k]];
        top_panel(s, s->top[k], share_columns, p->columns, COLUMNS);
        give_out(s, y, p->first, p->first + p->columns);
    }
}

void panels_solve(struct panels *s, const double *b, double *y) {
    struct call call = {.s = s, .b = b, .y = y};
    pool_for(s->context->pool, s->tasks, 1, forward_task, &call);
    solve_top(s, b, y);
    pool_for(s->context->pool, s->tasks, 1, backward_task, &call);
}

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

static void release_values(struct panels *s) {
    FREE_ARRAY(s->context, s->value, s->values);
    FREE_ARRAY(s->context, s->work, 4 * (size_t)s->places);
    FREE_ARRAY(s->context, s->scratch, 4 * (size_t)s->widest * (size_t)(s->tasks + 1));
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
    double limit = s->values < WORTH ? 0.0 : (double)s->values / TASKS, filled = 0.0;
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
        s->scratch = NEW_ARRAY(s->context, 4 * (size_t)s->widest * (size_t)(s->tasks + 1), double);
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
                                int columns, double *value) {
    for (int j = 0; j < columns; j++, value += TILE) {
        const double *w = W + (size_t)j * (size_t)columns;
        double sum[TILE] = {0};
        if (rows == TILE)
            for (int m = j; m < columns; m++)
                for (int i = 0; i < TILE; i++) sum[i] -= R[(size_t)m * stride + (size_t)i] * w[m];
        else
            for (int m = j; m < columns; m++)
                for (int i = 0; i < rows; i++) sum[i] -= R[(size_t)m * stride + (size_t)i] * w[m];
        memcpy(value, sum, sizeof sum);
    }
}

static void fill_panel(const struct panels *s, const struct panel *p, const double *L, double *W) {
    int triangle = tiles_of(p->columns);
    size_t stride = (size_t)(p->columns + p->rows);
    invert(L, stride, p->columns, W);
    for (int t = 0; t < triangle; t++) {
        double *value = s->value + p->value + tile_start(p, t);
        for (int j = 0; j < tile_columns(p, t); j++)
            for (int i = TILE * t; i < TILE * (t + 1); i++, value++)
                *value = i < p->columns ? W[(size_t)j * (size_t)p->columns + (size_t)i] : 0.0;
    }
    for (int row = 0; row < p->rows; row += TILE)
        multiply_below(L + p->columns + row, stride, p->rows - row < TILE ? p->rows - row : TILE, W,
                       p->columns, s->value + p->value + tile_start(p, triangle + row / TILE));
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
