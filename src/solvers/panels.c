#include "panels.h"

#include "base/simd.h"

enum { ROW_TILES = 16, COLUMNS = 64 }; /* grains within a panel of the top that is shared */

/* ---- substitution ---------------------------------------------------------------------------- */

struct call { /* the arguments of a parallel loop */
    struct panels *s;
    const struct panel *panel;
    const void *b;
    void *y, *x; /* x: a copy of the panel's part of the vector */
};

/* Products with a tile: sum = tile x, x: columns, and y += tile' c in columns [first, last). */

INLINE void multiply_tile(const double *value, int columns, const double *x, v4 sum[TILE]) {
    v4 a = {0}, b = {0}, c = {0}, d = {0};
    for (int j = 0; j < columns; j++, value += TILE) {
        v4 at;
        v4_load(&at, x, j);
        a += value[0] * at, b += value[1] * at, c += value[2] * at, d += value[3] * at;
    }
    sum[0] = a, sum[1] = b, sum[2] = c, sum[3] = d;
}

INLINE void add_transposed(const double *value, const v4 c[TILE], int first, int last, double *y) {
    value += TILE * (size_t)first;
    for (int j = first; j < last; j++, value += TILE) {
        v4 sum;
        v4_load(&sum, y, j);
        sum += (value[0] * c[0] + value[1] * c[1]) + (value[2] * c[2] + value[3] * c[3]);
        v4_store(y, j, &sum);
    }
}

/* ---- products with T and T' ------------------------------------------------------------------ */

/* Rows of T x in tiles [first, last): those of the triangle become the panel's part of the vector,
 * the others are added to the rows below. x: columns x 4, a copy of the panel's part. */
WIDE static void multiply(const struct panels *s, const struct panel *p, const double *x, int first,
                          int last) {
    int triangle = tiles_of(p->columns);
    double *work = s->work;
    const double *value = s->value + p->value + tile_start(p, first);
    for (int t = first; t < last; t++) {
        int columns = tile_columns(p, t), row = TILE * (t < triangle ? t : t - triangle);
        v4 sum[TILE], old;
        multiply_tile(value, columns, x, sum);
        value += TILE * (size_t)columns;
        if (t < triangle)
            for (int i = 0; i < TILE && row + i < p->columns; i++)
                v4_store(work, p->first + row + i, &sum[i]);
        else
            for (int i = 0; i < TILE && row + i < p->rows; i++) {
                int place = s->place[p->row + row + i];
                v4_load(&old, work, place);
                old += sum[i];
                v4_store(work, place, &old);
            }
    }
}

/* The rows of a tile, zero from `left` on. place: of each row, or NULL for rows in order. */
INLINE void load_rows(v4 c[TILE], const double *from, const int *place, int left) {
    for (int i = 0; i < TILE; i++)
        if (i < left) v4_load(&c[i], from, place ? place[i] : i);
        else c[i] = (v4){0};
}

/* Columns [first, last) of the panel's part of the vector become those of T' [x; rows below]. */
WIDE static void multiply_transposed(const struct panels *s, const struct panel *p, const double *x,
                                     int first, int last) {
    double *work = s->work, *y = work + 4 * (size_t)p->first;
    const double *value = s->value + p->value + tile_start(p, first / TILE);
    v4 c[TILE];
    memset(y + 4 * (size_t)first, 0, 4 * (size_t)(last - first) * sizeof *y);
    for (int row = first / TILE * TILE; row < p->columns; row += TILE) {
        int columns = tile_columns(p, row / TILE), end = columns < last ? columns : last,
            left = p->columns - row;
        load_rows(c, x + 4 * (size_t)row, NULL, left);
        add_transposed(value, c, first, end, y);
        value += TILE * (size_t)columns;
    }
    for (int row = 0; row < p->rows; row += TILE, value += TILE * (size_t)p->columns) {
        load_rows(c, work, s->place + p->row + row, p->rows - row);
        add_transposed(value, c, first, last, y);
    }
}

/* ---- substitution ---------------------------------------------------------------------------- */

static void copy_part(const struct panels *s, const struct panel *p, double *x) {
    memcpy(x, s->work + 4 * (size_t)p->first, 4 * (size_t)p->columns * sizeof *x);
}

static double *scratch_of(const struct panels *s, int task) {
    return s->scratch + 4 * (size_t)s->widest * (size_t)task;
}

/* Columns of L [first, last): in from the particles' order, and out. */
static void take_in(struct panels *s, const double *b, int first, int last) {
    for (int k = first; k < last; k++) {
        double *to = s->work + 4 * (size_t)k;
        memcpy(to, b + 3 * (size_t)s->particle[k], 3 * sizeof *to);
        to[3] = 0.0;
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
               4 * (size_t)(task->outside_end - task->outside) * sizeof(double));
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
    double *work = s->work;
    for (int k = first; k < last; k++) {
        const struct task *task = &s->task[k];
        for (int q = task->outside; q < task->outside_end; q++)
            memcpy(work + 4 * (size_t)q, work + 4 * (size_t)s->column_of[q], 4 * sizeof *work);
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
    if (panel_values(p) < PANELS_WORTH / 4) share(&call, 0, count, 0);
    else pool_for(s->context->pool, count, grain, share, &call);
}

static void solve_top(struct panels *s, const double *b, double *y) {
    double *work = s->work;
    for (int k = 0; k < s->tops; k++) {
        const struct panel *p = &s->panel[s->top[k]];
        take_in(s, b, p->first, p->first + p->columns);
    }
    for (int q = s->columns; q < s->places; q++)
        for (int a = 0; a < 4; a++)
            work[4 * (size_t)s->column_of[q] + a] += work[4 * (size_t)q + a];
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
