#include "coarse.h"

#include "base/simd.h"

#include <math.h>
#include <string.h>

/* Terms that are added up side by side, so that none waits for the one before. */
enum { LANES = 2 };

enum { GRAIN = 16, LIGHT_GRAIN = 32 }; /* nodes: worth waking a thread for */

/* Rows of a fluid or a contact tie some particles of a node together, of which the block diagonal
 * knows nothing: a node feels them up to this many times as much. */
static const double together = 4.0;

/* ---- the matrix ------------------------------------------------------------------------------ */

struct part { /* 3 x 3 numbers, fourth lanes 0 */
    v4 row[3];
};

INLINE void part_diagonal(struct part *B, double d) {
    for (int p = 0; p < 3; p++) B->row[p] = (v4){0}, B->row[p][p] = d;
}

/* Of one row each, with B = m m' + a I. */
static bool has_axes(const struct batch *b) {
    return b->type->tangent_rank1 && batch_has_blocks(b);
}

/* The 3 x 3 part of B between rows r and m of an element that has none. */
INLINE void part_load(struct part *B, const struct batch *b, int e, int r, int m) {
    if (!batch_has_blocks(b)) {
        part_diagonal(B, r == m ? b->view.weight[e] : 0.0);
        return;
    }
    const double *own = b->block + b->block_start[e];
    int r0 = b->view.element_row[e], n = 3 * (b->view.element_row[e + 1] - r0);
    for (int p = 0; p < 3; p++)
        v4_set(&B->row[p], own + (3 * (r - r0) + p) * n + 3 * (m - r0), 0.0);
}

/* Adds scale B to block (i, j). */
INLINE void part_add(const struct coarse *s, int i, int j, double scale, const struct part *B) {
    for (int p = 0; p < 3; p++) {
        double *row = skyline_row(&s->a, i, p) + 3 * (j - s->a.first[i]);
        for (int q = 0; q < 3; q++) row[q] += scale * B->row[p][q];
    }
}

/* What elements of one row each, B = m m' + a I, add to a block. */
INLINE void add_axes(struct part *sum, const struct batch *b, const struct sparse *terms,
                     int block) {
    v4 squares[LANES] = {{0}}, mixed[LANES] = {{0}}, plain[LANES] = {{0}};
    int k = terms->start[block], end = terms->start[block + 1];
    for (; k < end; k += LANES)
        for (int l = 0; l < LANES && k + l < end; l++) {
            v4 m;
            v4_load(&m, b->block, terms->entry[k + l].column);
            v4 scaled = (double)terms->entry[k + l].value * m;
            squares[l] += scaled * m;
            mixed[l] += scaled * __builtin_shufflevector(m, m, 1, 2, 0, 3);
            plain[l] += scaled;
        }
    v4 xx = squares[0] + squares[1], xy = mixed[0] + mixed[1];
    double a = plain[0][3] + plain[1][3];
    sum->row[0] += (v4){xx[0] + a, xy[0], xy[2]};
    sum->row[1] += (v4){xy[0], xx[1] + a, xy[1]};
    sum->row[2] += (v4){xy[2], xy[1], xx[2] + a};
}

/* The same of any such elements. */
INLINE void add_terms(struct part *sum, const struct batch *b, const struct sparse *terms,
                      int block) {
    for (int k = terms->start[block]; k < terms->start[block + 1]; k++) {
        int e = terms->entry[k].column;
        struct part B = {0};
        part_load(&B, b, e, e, e);
        for (int p = 0; p < 3; p++) sum->row[p] += (double)terms->entry[k].value * B.row[p];
    }
}

/* Elements of several rows, in all blocks of node i's row. */
INLINE void add_rows(const struct coarse *s, int i, const struct batch *b,
                     const struct followed *f) {
    for (int k = f->nodes.start[i]; k < f->nodes.start[i + 1]; k++) {
        int r = f->nodes.entry[k].column, e = b->entry_element[b->view.row_entry[r]];
        double own = (double)f->nodes.entry[k].value;
        for (int m = b->view.element_row[e]; m < b->view.element_row[e + 1]; m++) {
            struct part B = {0};
            part_load(&B, b, e, r, m);
            for (int t = f->rows.start[m]; t < f->rows.start[m + 1]; t++)
                if (f->rows.entry[t].column <= i)
                    part_add(s, i, f->rows.entry[t].column, own * (double)f->rows.entry[t].value,
                             &B);
        }
    }
}

/* What is not static. */
INLINE void add_rest(const struct coarse *s, int i) {
    const struct sparse *P = &s->p.particles, *back = &s->p.followers;
    for (int k = back->start[i]; k < back->start[i + 1]; k++) {
        int particle = back->entry[k].column;
        const double *D = s->rest + 6 * (size_t)particle;
        struct part B = {{{D[0], D[1], D[2]}, {D[1], D[3], D[4]}, {D[2], D[4], D[5]}}};
        for (int t = P->start[particle]; t < P->start[particle + 1]; t++)
            if (P->entry[t].column <= i)
                part_add(s, i, P->entry[t].column,
                         together * (double)back->entry[k].value * (double)P->entry[t].value, &B);
    }
}

WIDE static void take_coarse_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct coarse *s = arg;
    const struct objective *sys = s->objective;
    for (int i = first; i < last; i++) {
        for (int j = s->a.first[i]; j <= i; j++) {
            size_t k = s->a.start[i] + (size_t)(j - s->a.first[i]);
            struct part sum = {0};
            part_diagonal(&sum, s->stiffness[k] + s->mass[k] / (sys->h * sys->h));
            for (int b = 0; b < sys->batches; b++) {
                const struct sparse *terms = &s->batch[b].terms;
                if (!terms->start) continue;
                if (has_axes(sys->batch[b])) add_axes(&sum, sys->batch[b], terms, (int)k);
                else add_terms(&sum, sys->batch[b], terms, (int)k);
            }
            for (int p = 0; p < 3; p++)
                memcpy(skyline_row(&s->a, i, p) + 3 * (j - s->a.first[i]), &sum.row[p],
                       3 * sizeof(double));
        }
        for (int b = 0; b < sys->batches; b++)
            if (s->batch[b].nodes.start) add_rows(s, i, sys->batch[b], &s->batch[b]);
        if (s->rest) add_rest(s, i);
    }
}

void coarse_prepare(struct coarse *s, bool first) {
    struct objective *sys = s->objective;
    bool again = s->left <= 0 || (first && !sys->dynamic_rows);
    if (!s->p.nodes || !again) return;
    if (s->rest) {
        memset(s->rest, 0, 6 * (size_t)sys->particles * sizeof *s->rest);
        for (int b = 0; b < sys->batches; b++)
            if (!batch_is_static(sys->batch[b])) batch_diagonal(sys->batch[b], s->rest);
    }
    pool_for(sys->context->pool, s->p.nodes, GRAIN, take_coarse_rows, s);
    s->left = skyline_factor(&s->a) ? s->worth : 0;
}

void coarse_persist(struct coarse *s, pdyn_snapshot *snapshot) {
    if (!s->p.nodes) return;
    snapshot->bytes(snapshot, &s->left, sizeof s->left);
    snapshot->bytes(snapshot, s->a.value, skyline_size(&s->a) * sizeof *s->a.value);
}

/* ---- a product ------------------------------------------------------------------------------- */

/* The residual of particle i, as it came. */
INLINE void load_residual(const struct coarse *s, int i, v4 *r) {
    v4f single;
    if (!s->single) {
        v4_set(r, s->r + 3 * (size_t)i, 0.0);
        return;
    }
    v4f_load(&single, s->single, i);
    *r = __builtin_convertvector(single, v4);
}

/* x = P' r */
WIDE static void restrict_residual(void *arg, int first, int last, int block) {
    (void)block;
    const struct coarse *s = arg;
    const struct sparse *back = &s->p.followers;
    for (int node = first; node < last; node++) {
        v4 sum = {0}, r = {0};
        for (int k = back->start[node]; k < back->start[node + 1]; k++) {
            load_residual(s, back->entry[k].column, &r);
            sum += (double)back->entry[k].value * r;
        }
        memcpy(s->x + 3 * node, &sum, 3 * sizeof *s->x);
    }
}

/* z += P x */
static void add_moves(void *arg, int first, int last, int block) {
    (void)block;
    const struct coarse *s = arg;
    const struct sparse *P = &s->p.particles;
    for (int i = first; i < last; i++)
        for (int k = P->start[i]; k < P->start[i + 1]; k++)
            for (int a = 0; a < 3; a++)
                s->z[3 * (size_t)i + (size_t)a] +=
                    (double)P->entry[k].value * s->x[3 * P->entry[k].column + a];
}

void coarse_solve_single(struct coarse *s, const float *r) {
    s->single = r, s->left--;
    pool_for(s->objective->context->pool, s->p.nodes, LIGHT_GRAIN, restrict_residual, s);
    skyline_solve(&s->a, s->x);
    for (int node = 0; node < s->p.nodes; node++)
        for (int a = 0; a < 3; a++) s->moved[4 * node + a] = (float)s->x[3 * node + a];
}

double coarse_add(struct coarse *s, const double *r, double *z) {
    struct pool *pool = s->objective->context->pool;
    double rz = 0.0;
    if (!s->p.nodes) return 0.0;
    s->single = NULL, s->r = r, s->z = z, s->left--;
    pool_for(pool, s->p.nodes, LIGHT_GRAIN, restrict_residual, s);
    memcpy(s->sum, s->x, 3 * (size_t)s->p.nodes * sizeof *s->x);
    skyline_solve(&s->a, s->x);
    for (int k = 0; k < 3 * s->p.nodes; k++) rz += s->sum[k] * s->x[k];
    pool_for(pool, s->objective->particles, PARTICLE_GRAIN, add_moves, s);
    return rz;
}
