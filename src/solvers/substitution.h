/* The substitutions of panels.c, for numbers of one type: NUMBER, four of them a VECTOR, with LOAD
 * and STORE; a particle's part of b and y has WIDTH; AS(name) is the name of a function for that
 * type. Included once for each. */

/* ---- products with T and T' ------------------------------------------------------------------ */

/* Rows of T x in tiles [first, last): those of the triangle become the panel's part of the vector,
 * the others are added to the rows below. x: columns x 4, a copy of the panel's part. */
WIDE static void AS(multiply)(const struct panels *s, const struct panel *p, const NUMBER *x,
                              int first, int last) {
    int triangle = tiles_of(p->columns);
    NUMBER *work = s->work;
    const NUMBER *value = (const NUMBER *)s->value + p->value + tile_start(p, first);
    for (int t = first; t < last; t++) {
        int columns = tile_columns(p, t), row = TILE * (t < triangle ? t : t - triangle);
        VECTOR sum[TILE], old;
        AS(multiply_tile)(value, columns, x, sum);
        value += TILE * (size_t)columns;
        if (t < triangle)
            for (int i = 0; i < TILE && row + i < p->columns; i++)
                STORE(work, p->first + row + i, &sum[i]);
        else
            for (int i = 0; i < TILE && row + i < p->rows; i++) {
                int place = s->place[p->row + row + i];
                LOAD(&old, work, place);
                old += sum[i];
                STORE(work, place, &old);
            }
    }
}

/* The rows of a tile, zero from `left` on. place: of each row, or NULL for rows in order. */
INLINE void AS(load_rows)(VECTOR c[TILE], const NUMBER *from, const int *place, int left) {
    for (int i = 0; i < TILE; i++)
        if (i < left) LOAD(&c[i], from, place ? place[i] : i);
        else c[i] = (VECTOR){0};
}

/* Columns [first, last) of the panel's part of the vector become those of T' [x; rows below]. */
WIDE static void AS(multiply_transposed)(const struct panels *s, const struct panel *p,
                                         const NUMBER *x, int first, int last) {
    NUMBER *work = s->work, *y = work + 4 * (size_t)p->first;
    const NUMBER *value = (const NUMBER *)s->value + p->value + tile_start(p, first / TILE);
    VECTOR c[TILE];
    memset(y + 4 * (size_t)first, 0, 4 * (size_t)(last - first) * sizeof *y);
    for (int row = first / TILE * TILE; row < p->columns; row += TILE) {
        int columns = tile_columns(p, row / TILE), end = columns < last ? columns : last,
            left = p->columns - row;
        AS(load_rows)(c, x + 4 * (size_t)row, NULL, left);
        AS(add_transposed)(value, c, first, end, y);
        value += TILE * (size_t)columns;
    }
    for (int row = 0; row < p->rows; row += TILE, value += TILE * (size_t)p->columns) {
        AS(load_rows)(c, work, s->place + p->row + row, p->rows - row);
        AS(add_transposed)(value, c, first, last, y);
    }
}

/* ---- substitution ---------------------------------------------------------------------------- */

static void AS(copy_part)(const struct panels *s, const struct panel *p, NUMBER *x) {
    memcpy(x, (const NUMBER *)s->work + 4 * (size_t)p->first, 4 * (size_t)p->columns * sizeof *x);
}

static NUMBER *AS(scratch_of)(const struct panels *s, int task) {
    return (NUMBER *)s->scratch + 4 * (size_t)s->widest * (size_t)task;
}

/* Columns of L [first, last): in from the particles' order, and out. */
static void AS(take_in)(struct panels *s, const NUMBER *b, int first, int last) {
    for (int k = first; k < last; k++) {
        NUMBER *to = (NUMBER *)s->work + 4 * (size_t)k;
        memcpy(to, b + WIDTH * (size_t)s->particle[k], WIDTH * sizeof *to);
        if (WIDTH < 4) to[3] = 0;
    }
}

static void AS(give_out)(const struct panels *s, NUMBER *y, int first, int last) {
    for (int k = first; k < last; k++)
        memcpy(y + WIDTH * (size_t)s->particle[k], (const NUMBER *)s->work + 4 * (size_t)k,
               WIDTH * sizeof *y);
}

static void AS(forward_task)(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct panels *s = c->s;
    for (int k = first; k < last; k++) {
        const struct task *task = &s->task[k];
        memset((NUMBER *)s->work + 4 * (size_t)task->outside, 0,
               4 * (size_t)(task->outside_end - task->outside) * sizeof(NUMBER));
        for (int q = task->first; q < task->last; q++) {
            const struct panel *p = &s->panel[q];
            AS(take_in)(s, c->b, p->first, p->first + p->columns);
        }
        for (int q = task->first; q < task->last; q++) {
            const struct panel *p = &s->panel[q];
            AS(copy_part)(s, p, AS(scratch_of)(s, k));
            AS(multiply)(s, p, AS(scratch_of)(s, k), 0, panel_tiles(p));
        }
    }
}

static void AS(backward_task)(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct panels *s = c->s;
    NUMBER *work = s->work;
    for (int k = first; k < last; k++) {
        const struct task *task = &s->task[k];
        for (int q = task->outside; q < task->outside_end; q++)
            memcpy(work + 4 * (size_t)q, work + 4 * (size_t)s->column_of[q], 4 * sizeof *work);
        for (int q = task->last - 1; q >= task->first; q--) {
            const struct panel *p = &s->panel[q];
            AS(copy_part)(s, p, AS(scratch_of)(s, k));
            AS(multiply_transposed)(s, p, AS(scratch_of)(s, k), 0, p->columns);
            AS(give_out)(s, c->y, p->first, p->first + p->columns);
        }
    }
}

static void AS(share_tiles)(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    AS(multiply)(c->s, c->panel, c->x, first, last);
}

static void AS(share_columns)(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    AS(multiply_transposed)(c->s, c->panel, c->x, first, last);
}

/* A panel of the top, by all threads where it is large. */
static void AS(top_panel)(struct panels *s, int panel, pdyn_range_fn *share, int count, int grain) {
    const struct panel *p = &s->panel[panel];
    struct call call = {.s = s, .panel = p, .x = AS(scratch_of)(s, s->tasks)};
    AS(copy_part)(s, p, call.x);
    if (panel_values(p) < WORTH / 4) share(&call, 0, count, 0);
    else pool_for(s->context->pool, count, grain, share, &call);
}

static void AS(solve_top)(struct panels *s, const NUMBER *b, NUMBER *y) {
    NUMBER *work = s->work;
    for (int k = 0; k < s->tops; k++) {
        const struct panel *p = &s->panel[s->top[k]];
        AS(take_in)(s, b, p->first, p->first + p->columns);
    }
    for (int q = s->columns; q < s->places; q++)
        for (int a = 0; a < 4; a++)
            work[4 * (size_t)s->column_of[q] + a] += work[4 * (size_t)q + a];
    for (int k = 0; k < s->tops; k++)
        AS(top_panel)(s, s->top[k], AS(share_tiles), panel_tiles(&s->panel[s->top[k]]), ROW_TILES);
    for (int k = s->tops - 1; k >= 0; k--) {
        const struct panel *p = &s->panel[s->top[k]];
        AS(top_panel)(s, s->top[k], AS(share_columns), p->columns, COLUMNS);
        AS(give_out)(s, y, p->first, p->first + p->columns);
    }
}

static void AS(solve)(struct panels *s, const NUMBER *b, NUMBER *y) {
    struct call call = {.s = s, .b = b, .y = y};
    pool_for(s->context->pool, s->tasks, 1, AS(forward_task), &call);
    AS(solve_top)(s, b, y);
    pool_for(s->context->pool, s->tasks, 1, AS(backward_task), &call);
}

#undef NUMBER
#undef VECTOR
#undef WIDTH
#undef LOAD
#undef STORE
#undef AS
