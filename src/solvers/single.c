#include "single.h"

#include "base/fours.h"

enum { ELEMENTS = 1024, PARTICLES = 512 }; /* grains: worth waking a thread for */

struct call {
    struct single *s;
    const float *u;
    float *y;
    int batch;
};

/* ---- the product ----------------------------------------------------------------------------- */

INLINE void gather(const struct selected *entry, int count, const float *u, v4f *sum) {
    *sum = (v4f){0};
    for (int k = 0; k < count; k++) {
        v4f at;
        v4f_load(&at, u, entry[k].index);
        *sum += entry[k].coefficient * at;
    }
}

/* The sum of a row; rows of so many entries are unrolled. */
INLINE void gather_row(const struct single *s, int row, const float *x, v4f *u) {
    const struct selected *entry = s->entry + s->row_start[row];
    int count = s->row_start[row + 1] - s->row_start[row];
    if (count == 4) gather(entry, 4, x, u);
    else gather(entry, count, x, u);
}

/* flux += B's part of row k times u; B is symmetric: a row is a column. */
INLINE void add_row(const float *B, int k, int rows, const v4f *u, v4f_anywhere *flux) {
    for (int r = 0; r < rows; r++)
        for (int a = 0; a < 3; a++) {
            v4f column;
            memcpy(&column, B + 3 * (3 * k + a) * rows + 3 * r, sizeof column);
            flux[r] += (*u)[a] * column;
        }
}

INLINE void add_rows(const struct single *s, const float *B, int row, int rows, const float *x,
                     v4f_anywhere *flux) {
    v4f u;
    for (int k = 0; k < rows; k++) gather_row(s, row + k, x, &u), add_row(B, k, rows, &u, flux);
}

enum { FEW = 3 }; /* rows whose fluxes fit registers */

INLINE void multiply_few(const struct single *s, const float *B, int row, int rows,
                         const float *x) {
    v4f_anywhere flux[FEW] = {{0}};
    add_rows(s, B, row, rows, x, flux);
    memcpy(s->flux + 4 * (size_t)row, flux, (size_t)rows * sizeof *flux);
}

INLINE void multiply_many(const struct single *s, const float *B, int row, int rows,
                          const float *x) {
    v4f_anywhere *flux = (v4f_anywhere *)(s->flux + 4 * (size_t)row);
    memset(flux, 0, (size_t)rows * sizeof *flux);
    add_rows(s, B, row, rows, x, flux);
}

/* The same where B = m m' + a I of a row. */
INLINE void multiply_axis(const struct single *s, const float *B, int row, const float *x) {
    v4f u, f, axis;
    gather_row(s, row, x, &u);
    memcpy(&axis, B, sizeof axis);
    f = (axis[0] * u[0] + axis[1] * u[1] + axis[2] * u[2]) * axis + axis[3] * u;
    v4f_store(s->flux, row, &f);
}

/* The fluxes of a batch's elements, the usual sizes unrolled. */
WIDE static void multiply_elements(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->s->objective->batch[c->batch];
    const float *B = c->s->block[c->batch];
    int row = c->s->batch_row[c->batch];
    for (int e = first; e < last; e++) {
        int r = b->view.element_row[e], rows = b->view.element_row[e + 1] - r;
        const float *own = B + b->block_start[e];
        if (b->type->tangent_rank1) multiply_axis(c->s, own, row + r, c->u);
        else if (rows == 1) multiply_few(c->s, own, row + r, 1, c->u);
        else if (rows == 2) multiply_few(c->s, own, row + r, 2, c->u);
        else if (rows == 3) multiply_few(c->s, own, row + r, 3, c->u);
        else multiply_many(c->s, own, row + r, rows, c->u);
    }
}

enum { AHEAD = 16 }; /* hardware alone does not keep up with streams as short as a patch's */

/* The parts of a vector that begin at four places. */
INLINE void gather_four(fours *at, const float *u, int a, int b, int c, int d) {
    v4f part[4];
    v4f_load(&part[0], u + a, 0), v4f_load(&part[1], u + b, 0);
    v4f_load(&part[2], u + c, 0), v4f_load(&part[3], u + d, 0);
    fours_join(at, &part[0], &part[1], &part[2], &part[3]);
}

/* sum = number (u - u of the first member) */
INLINE void sum_numbers(const struct single *s, int patch, const float *u, fours *sum) {
    fours at, first, K, part[PATCH];
    int member = 4 * s->member[PATCH * patch];
    gather_four(&first, u, member, member, member, member);
    for (int m = 0; m < PATCH; m++) fours_zero(&part[m]);
    for (int t = s->number_start[patch]; t < s->number_start[patch + 1]; t++) {
        const struct numbers *n = s->numbers + t;
        __builtin_prefetch(n + AHEAD);
        gather_four(&at, u, n->column[0], n->column[1], n->column[2], n->column[3]);
        fours_subtract(&at, &at, &first);
        fours_load(&K, n->number);
        fours_add_each(&part[0], &K, 0, &at), fours_add_each(&part[1], &K, 1, &at);
        fours_add_each(&part[2], &K, 2, &at), fours_add_each(&part[3], &K, 3, &at);
    }
    fours_sums(sum, part);
}

/* sum += B (own - u of the other end), but for fourth lanes; own: of the members */
INLINE void add_links(const struct single *s, int patch, const float *u, const fours *own,
                      fours *sum) {
    fours at, B, along, plain;
    fours_zero(&plain);
    for (int t = s->link_start[patch]; t < s->link_start[patch + 1]; t++) {
        const struct links *l = s->links + t;
        __builtin_prefetch(l + AHEAD);
        gather_four(&at, u, l->to[0], l->to[1], l->to[2], l->to[3]);
        fours_subtract(&at, own, &at);
        fours_load(&B, l->block);
        fours_multiply(&along, &B, &at);
        fours_sum_each(&along, &along);
        fours_add_product(sum, &along, &B);
        fours_add_each(&plain, &B, 3, &at);
    }
    fours_add(sum, &plain);
}

/* y += what doubles give to particle i */
INLINE void add_wide(const struct single *s, int i, v4f *y) {
    v4 wide;
    memcpy(&wide, s->wide_y + 3 * (size_t)i, sizeof wide);
    *y += __builtin_convertvector(wide, v4f);
}

/* The four members' parts of y = H u; adds to u.H u. */
INLINE void multiply_patch(const struct call *c, int patch, v4 *product) {
    const struct single *s = c->s;
    const int *member = s->member + PATCH * patch;
    fours own, sum;
    v4f sums[PATCH], products = {0};
    gather_four(&own, c->u, 4 * member[0], 4 * member[1], 4 * member[2], 4 * member[3]);
    sum_numbers(s, patch, c->u, &sum);
    add_links(s, patch, c->u, &own, &sum);
    fours_store(sums, &sum);
    for (int m = 0; m < PATCH; m++) {
        int i = member[m], t = s->touch_start[i];
        v4f u, y = {0};
        v4f_load(&u, c->u, i);
        if (s->rows) gather(s->touch + t, s->touch_start[i + 1] - t, s->flux, &y);
        y += sums[m] + s->self[i] * u;
        if (s->wide_y && i < s->objective->particles) add_wide(s, i, &y);
        y[3] = 0.0F;
        products += u * y;
        v4f_store(c->y, i, &y);
    }
    *product += __builtin_convertvector(products, v4);
}

WIDE static void multiply_patches(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    v4 product = {0};
    for (int k = first; k < last; k++) multiply_patch(c, k, &product);
    c->s->partial[block] = v4_sum(&product);
}

WIDE static void widen(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++)
        for (int a = 0; a < 3; a++) {
            c->s->wide_u[3 * (size_t)i + a] = (double)c->u[4 * (size_t)i + a];
            c->s->wide_y[3 * (size_t)i + a] = 0.0;
        }
}

/* wide_y = what batches that are left out give */
static void multiply_wide(struct call *call) {
    struct single *s = call->s;
    struct objective *sys = s->objective;
    pool_for(sys->context->pool, sys->particles, PARTICLES, widen, call);
    for (int b = 0; b < sys->batches; b++)
        if (s->way[b] == LEFT_OUT) batch_apply(sys->batch[b], s->wide_u, s->wide_y);
}

double single_apply(struct single *s, const float *u, float *y) {
    struct objective *sys = s->objective;
    struct call call = {.s = s, .u = u, .y = y};
    double sum = 0.0;
    if (s->wide_u) multiply_wide(&call);
    for (call.batch = 0; call.batch < sys->batches; call.batch++)
        if (s->block[call.batch])
            pool_for(sys->context->pool, sys->batch[call.batch]->view.elements, ELEMENTS,
                     multiply_elements, &call);
    pool_for(sys->context->pool, s->patches, SINGLE_GRAIN, multiply_patches, &call);
    for (int k = 0; k < pool_blocks(s->patches, SINGLE_GRAIN); k++) sum += s->partial[k];
    return sum;
}

/* ---- its numbers ----------------------------------------------------------------------------- */

WIDE static void take_inertia(void *arg, int first, int last, int block) {
    (void)block;
    const struct single *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) {
        double inertia = objective_inertia(s->objective, i), *D = s->diagonal + 6 * (size_t)i;
        s->self[i] = (float)(s->own[i] + inertia);
        memset(D, 0, 6 * sizeof *D);
        D[0] = D[3] = D[5] = inertia;
    }
}

static void take_weights(const struct single *s, const struct batch *b) {
    for (int r = 0; r < b->rows; r++) {
        double c = b->view.coefficient[r], weight = b->view.weight[r] * c * c;
        double *D = s->diagonal + 6 * (size_t)b->view.column[r];
        s->self[b->view.column[r]] += (float)weight;
        D[0] += weight, D[3] += weight, D[5] += weight;
    }
}

/* B = w I where the components do not couple. */
static void take_plain(const struct batch *b, int e, float *B) {
    int n = 3 * (b->view.element_row[e + 1] - b->view.element_row[e]);
    memset(B, 0, (b->block_start[e + 1] - b->block_start[e]) * sizeof *B);
    if (b->type->tangent_rank1) B[3] = (float)b->view.weight[e];
    else
        for (int k = 0; k < n; k++) B[k * n + k] = (float)b->view.weight[e];
}

WIDE static void take_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->s->objective->batch[c->batch];
    float *to = c->s->block[c->batch];
    if (batch_has_blocks(b))
        for (size_t k = b->block_start[first]; k < b->block_start[last]; k++)
            to[k] = (float)b->block[k];
    else
        for (int e = first; e < last; e++) take_plain(b, e, to + b->block_start[e]);
}

struct source { /* of links: a batch */
    int batch;
    const double *weight, *block; /* block NULL: B = w I */
};

struct sum_of_links { /* of B = m m' + a I: rows x and y, the corner, a */
    v4 x, y;
    double zz, plain;
};

INLINE void take_link(const struct single *s, struct source *source, int t, int m,
                      struct sum_of_links *sum) {
    const struct origin *from = &s->origin[PATCH * t + m];
    if (from->row < 0) return;
    if (from->batch != source->batch) {
        const struct batch *b = s->objective->batch[from->batch];
        *source =
            (struct source){from->batch, b->view.weight, batch_has_blocks(b) ? b->block : NULL};
    }
    v4 B = {0};
    if (source->block) v4_load(&B, source->block, from->row);
    else B[3] = source->weight[from->row];
    v4f single = __builtin_convertvector(B, v4f);
    v4f_store(s->links[t].block, m, &single);
    sum->x += B[0] * B, sum->y += B[1] * B;
    sum->zz += B[2] * B[2], sum->plain += B[3];
}

WIDE static void take_links(void *arg, int first, int last, int block) {
    (void)block;
    const struct single *s = ((const struct call *)arg)->s;
    struct source source = {.batch = -1};
    for (int k = first; k < last; k++)
        for (int m = 0; m < PATCH; m++) {
            struct sum_of_links sum = {0};
            int i = s->member[PATCH * k + m];
            for (int t = s->link_start[k]; t < s->link_start[k + 1]; t++)
                take_link(s, &source, t, m, &sum);
            if (i == s->objective->particles) continue;
            double *D = s->diagonal + 6 * (size_t)i;
            D[0] += sum.x[0] + sum.plain, D[1] += sum.x[1], D[2] += sum.x[2];
            D[3] += sum.y[1] + sum.plain, D[4] += sum.y[2], D[5] += sum.zz + sum.plain;
        }
}

void single_prepare(struct single *s) {
    struct objective *sys = s->objective;
    struct call call = {.s = s};
    pool_for(sys->context->pool, sys->particles, PARTICLES, take_inertia, &call);
    pool_for(sys->context->pool, s->patches, SINGLE_GRAIN, take_links, &call);
    for (; call.batch < sys->batches; call.batch++) {
        struct batch *b = sys->batch[call.batch];
        if (s->way[call.batch] == NUMBERS) linear_rows_diagonal(b->linear, s->diagonal);
        if (s->way[call.batch] == WEIGHTS) take_weights(s, b);
        if (s->way[call.batch] == ROWS)
            pool_for(sys->context->pool, b->view.elements, ELEMENTS, take_blocks, &call);
    }
}

void single_diagonal(const struct single *s, double *blocks) {
    memcpy(blocks, s->diagonal, 6 * (size_t)s->objective->particles * sizeof *blocks);
    for (int b = 0; b < s->objective->batches; b++)
        if (s->way[b] == LEFT_OUT || s->way[b] == ROWS)
            batch_diagonal(s->objective->batch[b], blocks);
}
