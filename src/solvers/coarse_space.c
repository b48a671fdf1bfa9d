#include "coarse_space.h"

#include "projdyn/simd.h"

#include <string.h>

/* Terms that are summed side by side, so that no addition waits for the one before. */
enum { LANES = 2 };

enum { NODE_GRAIN = 4, RESTRICT_GRAIN = 32, PARTICLE_GRAIN = 1024 }; /* parallel blocks */

/* Dynamic constraints couple particles of one node, which their block diagonal does not contain:
 * it is multiplied by this. Measured on water_on_cloth: 1 to 8 make little difference. */
static const double coupling = 4.0;

/* ---- A = I' H I ------------------------------------------------------------------------------ */

struct part { /* a 3 x 3 block, fourth lanes 0 */
    v4 row[3];
};

INLINE void part_diagonal(struct part *B, double d) {
    for (int p = 0; p < 3; p++) B->row[p] = (v4){0}, B->row[p][p] = d;
}

/* The 3 x 3 part of B between rows r and m of an element that is not of rank 1. */
INLINE void part_load(struct part *B, const pdyn_elements *at, int e, int r, int m) {
    if (!at->block) {
        part_diagonal(B, r == m ? at->rows->weight[e] : 0.0);
        return;
    }
    const double *block = at->block + at->block_start[e];
    int r0 = at->rows->element_row[e], n = 3 * (at->rows->element_row[e + 1] - r0);
    for (int p = 0; p < 3; p++)
        v4_set(&B->row[p], block + (3 * (r - r0) + p) * n + 3 * (m - r0), 0.0);
}

/* Adds scale B to block (i, j) of A. */
INLINE void part_add(const struct coarse_space *s, int i, int j, double scale,
                     const struct part *B) {
    for (int p = 0; p < 3; p++) {
        double *row = skyline_block_row(&s->a, i, j, p);
        for (int q = 0; q < 3; q++) row[q] += scale * B->row[p][q];
    }
}

/* Adds the elements of one row with B = m m' + a I to a block. */
INLINE void add_rank1(struct part *sum, const double *block, const struct sparse *terms, int to) {
    v4 squares[LANES] = {{0}}, mixed[LANES] = {{0}}, plain[LANES] = {{0}};
    int k = terms->start[to], end = terms->start[to + 1];
    for (; k < end; k += LANES)
        for (int l = 0; l < LANES && k + l < end; l++) {
            v4 m;
            v4_load(&m, block, terms->entry[k + l].column);
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

/* Adds any elements of one row to a block. */
INLINE void add_terms(struct part *sum, const pdyn_elements *at, const struct sparse *terms,
                      int to) {
    if (at->block && !at->block_start) {
        add_rank1(sum, at->block, terms, to);
        return;
    }
    for (int k = terms->start[to]; k < terms->start[to + 1]; k++) {
        int e = terms->entry[k].column;
        struct part B = {0};
        part_load(&B, at, e, at->rows->element_row[e], at->rows->element_row[e]);
        for (int p = 0; p < 3; p++) sum->row[p] += (double)terms->entry[k].value * B.row[p];
    }
}

/* Adds elements of several rows to all blocks of node i. */
INLINE void add_rows(const struct coarse_space *s, int i, const struct coarse_rows *f) {
    const int *element_row = f->now.rows->element_row;
    for (int k = f->transpose.start[i]; k < f->transpose.start[i + 1]; k++) {
        int r = f->transpose.entry[k].column, e = f->row_element[r];
        double weight = (double)f->transpose.entry[k].value;
        for (int m = element_row[e]; m < element_row[e + 1]; m++) {
            struct part B = {0};
            part_load(&B, &f->now, e, r, m);
            for (int t = f->rows.start[m]; t < f->rows.start[m + 1]; t++)
                if (f->rows.entry[t].column <= i)
                    part_add(s, i, f->rows.entry[t].column, weight * (double)f->rows.entry[t].value,
                             &B);
        }
    }
}

/* Adds the block diagonal of dynamic constraints to all blocks of node i. */
INLINE void add_dynamic(const struct coarse_space *s, int i) {
    const struct sparse *to = &s->interpolation.prolongation, *from = &s->interpolation.restriction;
    for (int k = from->start[i]; k < from->start[i + 1]; k++) {
        int particle = from->entry[k].column;
        const double *D = s->dynamic + 6 * (size_t)particle;
        struct part B = {{{D[0], D[1], D[2]}, {D[1], D[3], D[4]}, {D[2], D[4], D[5]}}};
        for (int t = to->start[particle]; t < to->start[particle + 1]; t++)
            if (to->entry[t].column <= i)
                part_add(s, i, to->entry[t].column,
                         coupling * (double)from->entry[k].value * (double)to->entry[t].value, &B);
    }
}

WIDE static void coarse_compute_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct coarse_space *s = arg;
    double h = s->model->h;
    for (int i = first; i < last; i++) {
        for (int j = s->a.first[i]; j <= i; j++) {
            size_t k = skyline_block(&s->a, i, j);
            struct part sum = {0};
            part_diagonal(&sum, s->stiffness[k] + s->mass[k] / (h * h));
            for (int b = 0; b < s->model->elements_count; b++)
                if (s->part[b].terms.start)
                    add_terms(&sum, &s->part[b].now, &s->part[b].terms, (int)k);
            for (int p = 0; p < 3; p++)
                memcpy(skyline_block_row(&s->a, i, j, p), &sum.row[p], 3 * sizeof(double));
        }
        for (int b = 0; b < s->model->elements_count; b++)
            if (s->part[b].transpose.start) add_rows(s, i, &s->part[b]);
        if (s->dynamic) add_dynamic(s, i);
    }
}

static void parallel_for(const struct coarse_space *s, int count, int grain, pdyn_range_fn *fn) {
    s->model->services->parallel_for(s->model->services->core, count, grain, fn, (void *)s);
}

void coarse_space_update(struct coarse_space *s, bool first_of_step) {
    pdyn_model *m = s->model;
    if (!s->interpolation.nodes || (s->left > 0 && !first_of_step)) return;
    for (int k = 0; k < m->elements_count; k++) s->part[k].now = m->elements(m, k);
    if (s->dynamic) m->diagonal(m, PDYN_DYNAMIC, s->dynamic);
    parallel_for(s, s->interpolation.nodes, NODE_GRAIN, coarse_compute_rows);
    s->left = skyline_factor(&s->a) ? s->lifetime : 0;
}

/* ---- the correction -------------------------------------------------------------------------- */

/* x = I' r */
WIDE static void coarse_restrict(void *arg, int first, int last, int block) {
    (void)block;
    const struct coarse_space *s = arg;
    const struct sparse *from = &s->interpolation.restriction;
    for (int node = first; node < last; node++) {
        v4 sum[LANES] = {{0}}, r = {0};
        int k = from->start[node], end = from->start[node + 1];
        for (; k < end; k += LANES)
            for (int l = 0; l < LANES && k + l < end; l++) {
                memcpy(&r, s->r + 3 * (size_t)from->entry[k + l].column, sizeof r);
                sum[l] += (double)from->entry[k + l].value * r;
            }
        v4 x = sum[0] + sum[1];
        memcpy(s->x + 3 * node, &x, 3 * sizeof *s->x);
    }
}

/* z += I x */
WIDE static void coarse_prolong(void *arg, int first, int last, int block) {
    (void)block;
    const struct coarse_space *s = arg;
    const struct sparse *to = &s->interpolation.prolongation;
    for (int i = first; i < last; i++) {
        v4 sum = {0}, x;
        for (int k = to->start[i]; k < to->start[i + 1]; k++) {
            memcpy(&x, s->x + 3 * (size_t)to->entry[k].column, sizeof x);
            sum += (double)to->entry[k].value * x;
        }
        v4_add_to(s->z + 3 * (size_t)i, &sum);
    }
}

void coarse_space_correct(struct coarse_space *s, const double *r, double *z) {
    if (!s->interpolation.nodes) return;
    s->r = r, s->z = z, s->left--;
    parallel_for(s, s->interpolation.nodes, RESTRICT_GRAIN, coarse_restrict);
    skyline_solve(&s->a, s->x);
    s->model->for_particles(s->model, PARTICLE_GRAIN, coarse_prolong, s);
}
