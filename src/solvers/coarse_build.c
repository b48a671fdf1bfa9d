/* Setting up coarse.h: which nodes rows tie, and what each element counts between them. */
#include "coarse.h"

#include <math.h>
#include <string.h>

/* Nodes at most; and of so many particles at most one, as more are left to 3 x 3 blocks for less.
 * Where the matrix is made for every step: fewer; but a few cost little, and stiff sheets need
 * them however small. */
enum { MOST_NODES = 400, PARTICLES_OF_NODE = 12, PARTICLES_OF_NODE_STATIC = 40 };
enum { FEW_NODES = 120, PARTICLES_OF_FEW = 4 };

/* A node that moves a row by less than this part of what the strongest one does is left to that
 * one: half of the terms, for a matrix that is as good. */
static const float feeble = 0.25F;

/* A matrix that stands for rows adds little to a body below this part of the others' trace: then it
 * is not worth blocks between nodes that they do not tie. */
static const double little = 0.3;

/* The matrix is made anew after so many products with its inverse; until then it is that of another
 * H. Where all is static, solves are short and making it may be most of what they take: then when
 * they have taken so many times as long. */
enum { WORTH = 200, WORTH_STATIC = 8 };

/* What else takes as long as a term of the matrix: an iteration for a particle, by a 30th; a 3 x 3
 * part of elements of several rows, 4 times; a product of the factor, by a 12th. */
static const double terms_of_iteration = 30.0, terms_of_part = 4.0, terms_of_product = 1.0 / 12.0;

/* ---- rows, as nodes have them ---------------------------------------------------------------- */

/* What is feeble in rows goes to the strongest: what nodes do together stays as it is. */
static void leave_out_feeble(struct sparse *rows) {
    int kept = 0;
    for (int r = 0; r < rows->rows; r++) {
        int first = rows->start[r], last = rows->start[r + 1], strongest = first;
        float rest = 0.0F;
        for (int k = first; k < last; k++)
            if (fabsf(rows->entry[k].value) > fabsf(rows->entry[strongest].value)) strongest = k;
        float least = first < last ? feeble * fabsf(rows->entry[strongest].value) : 0.0F;
        for (int k = first; k < last; k++)
            if (fabsf(rows->entry[k].value) < least) rest += rows->entry[k].value;
        rows->start[r] = kept;
        for (int k = first; k < last; k++) {
            struct entry e = rows->entry[k];
            if (k == strongest) e.value += rest;
            if (k == strongest || fabsf(e.value) >= least) rows->entry[kept++] = e;
        }
    }
    rows->start[rows->rows] = kept;
}

/* G of a batch's rows; *largest: of its numbers. */
static pdyn_status take_selector(const struct batch *b, int particles, float *largest,
                                 struct sparse *G) {
    int *counts = NEW_ARRAY(b->context, b->rows, int);
    if (b->rows && !counts) return PDYN_NO_MEMORY;
    for (int r = 0; r < b->rows; r++) counts[r] = b->view.row_entry[r + 1] - b->view.row_entry[r];
    pdyn_status status = sparse_create(G, b->context, b->rows, particles, counts);
    FREE_ARRAY(b->context, counts, b->rows);
    *largest = 0.0F;
    for (int k = 0; status == PDYN_OK && k < b->entries; k++) {
        float c = (float)b->view.coefficient[k];
        G->entry[k] = (struct entry){b->view.column[k], c};
        *largest = fmaxf(*largest, fabsf(c));
    }
    return status;
}

/* G P of a batch's rows. */
static pdyn_status follow_rows(const struct batch *b, const struct sparse *P, struct sparse *out) {
    struct sparse G = {0};
    float largest;
    pdyn_status status = take_selector(b, P->rows, &largest, &G);
    if (status == PDYN_OK) status = sparse_multiply(&G, P, 1e-5F * largest, out);
    if (status == PDYN_OK) leave_out_feeble(out);
    sparse_free(&G);
    return status;
}

/* ---- the pattern ----------------------------------------------------------------------------- */

/* An element reaches from the lowest of its nodes to all others. */
static void reach(const struct sparse *nodes, int begin, int end, int *first) {
    int lowest = INT32_MAX;
    for (int k = nodes->start[begin]; k < nodes->start[end]; k++)
        if (nodes->entry[k].column < lowest) lowest = nodes->entry[k].column;
    for (int k = nodes->start[begin]; k < nodes->start[end]; k++)
        if (lowest < first[nodes->entry[k].column]) first[nodes->entry[k].column] = lowest;
}

/* What rows of two particles or more put on the diagonal of the projective step's matrix. */
static double trace_of(const struct batch *b) {
    double sum = 0.0;
    for (int k = 0; k < b->entries; k++) {
        int r = b->entry_row[k];
        if (b->view.row_entry[r + 1] - b->view.row_entry[r] > 1)
            sum += b->view.weight[b->entry_element[k]] * b->view.coefficient[k] *
                   b->view.coefficient[k];
    }
    return sum;
}

/* A matrix that stands for rows, far beyond what others of its body tie, and little beside these.
 */
static bool is_far_and_little(const struct objective *sys, const struct batch *b) {
    double others = 0.0;
    if (!b->linear) return false;
    for (int k = 0; k < sys->batches; k++) {
        const struct batch *other = sys->batch[k];
        if (batch_is_static(other) && !other->linear && other->view.body == b->view.body)
            others += trace_of(other);
    }
    return trace_of(b) <= little * others;
}

static pdyn_status create_pattern(struct coarse *s) {
    struct objective *sys = s->objective;
    int *first = NEW_ARRAY(sys->context, s->p.nodes, int);
    if (!first) return PDYN_NO_MEMORY;
    for (int i = 0; i < s->p.nodes; i++) first[i] = i;
    for (int b = 0; b < sys->batches; b++) {
        const struct batch *batch = sys->batch[b];
        if (!batch_is_static(batch) || is_far_and_little(sys, batch)) continue;
        for (int e = 0; e < batch->view.elements; e++)
            reach(&s->batch[b].rows, batch->view.element_row[e], batch->view.element_row[e + 1],
                  first);
    }
    pdyn_status status = skyline_create(&s->a, sys->context, s->p.nodes, first);
    FREE_ARRAY(sys->context, first, s->p.nodes);
    return status;
}

/* ---- what the matrix is made of -------------------------------------------------------------- */

/* Calls for the products of all pairs of a row's entries, of blocks up to the diagonal. */
static void visit_pairs(const struct coarse *s, const struct sparse *rows, int *counts,
                        struct sparse *terms) {
    for (int r = 0; r < rows->rows; r++)
        for (int k = rows->start[r]; k < rows->start[r + 1]; k++)
            for (int m = rows->start[r]; m < rows->start[r + 1]; m++) {
                int i = rows->entry[k].column, j = rows->entry[m].column;
                if (j > i) continue;
                size_t block = s->a.start[i] + (size_t)(j - s->a.first[i]);
                int at = counts[block]++;
                if (terms)
                    terms->entry[at] =
                        (struct entry){r, rows->entry[k].value * rows->entry[m].value};
            }
}

/* By blocks, what each element of one row counts there. */
static pdyn_status take_terms(struct coarse *s, const struct sparse *rows, struct sparse *terms) {
    pdyn_context *c = rows->context;
    size_t blocks = s->a.start[s->a.nodes];
    int *counts = NEW_ARRAY(c, blocks, int);
    if (!counts) return PDYN_NO_MEMORY;
    visit_pairs(s, rows, counts, NULL);
    pdyn_status status = sparse_create(terms, c, (int)blocks, rows->rows, counts);
    if (status == PDYN_OK) {
        memcpy(counts, terms->start, blocks * sizeof *counts);
        visit_pairs(s, rows, counts, terms);
    }
    FREE_ARRAY(c, counts, blocks);
    return status;
}

static pdyn_status take_batch(struct coarse *s, const struct batch *b, struct followed *f) {
    if (b->rows != b->view.elements) return sparse_transpose(&f->rows, &f->nodes);
    pdyn_status status = take_terms(s, &f->rows, &f->terms);
    sparse_free(&f->rows);
    return status;
}

/* Adds a number between particles i and j to `to`, by blocks; between nodes that have none, to the
 * diagonal of both instead: that never makes the matrix indefinite. */
static void add_number(const struct coarse *s, int i, int j, double number, double *to) {
    const struct sparse *P = &s->p.particles;
    for (int k = P->start[i]; k < P->start[i + 1]; k++)
        for (int m = P->start[j]; m < P->start[j + 1]; m++) {
            int row = P->entry[k].column, column = P->entry[m].column;
            double part = (double)P->entry[k].value * (double)P->entry[m].value * number;
            if (column > row) continue;
            if (column >= s->a.first[row])
                to[s->a.start[row] + (size_t)(column - s->a.first[row])] += part;
            else
                to[s->a.start[row + 1] - 1] += fabs(part),
                    to[s->a.start[column + 1] - 1] += fabs(part);
        }
}

static void take_stiffness(struct coarse *s, const struct linear_rows *k) {
    for (int i = 0; i < k->count; i++) {
        add_number(s, k->first + i, k->first + i, k->diagonal[i], s->stiffness);
        for (int m = k->start[i]; m < k->start[i + 1]; m++)
            add_number(s, k->first + i, k->column[m], k->value[m], s->stiffness);
    }
}

static pdyn_status take_numbers(struct coarse *s) {
    struct objective *sys = s->objective;
    pdyn_status status = PDYN_OK;
    s->stiffness = NEW_ARRAY(sys->context, s->a.start[s->a.nodes], double);
    s->mass = NEW_ARRAY(sys->context, s->a.start[s->a.nodes], double);
    if (!s->stiffness || !s->mass) return PDYN_NO_MEMORY;
    for (int i = 0; i < sys->particles; i++) add_number(s, i, i, sys->mass[i], s->mass);
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++) {
        const struct batch *batch = sys->batch[b];
        if (!batch_is_static(batch)) continue;
        if (!batch->linear) status = take_batch(s, batch, &s->batch[b]);
        else take_stiffness(s, batch->linear), sparse_free(&s->batch[b].rows);
    }
    return status;
}

static pdyn_status create_matrix(struct coarse *s) {
    struct objective *sys = s->objective;
    pdyn_status status = PDYN_OK;
    s->batch = NEW_ARRAY(sys->context, sys->batches, struct followed);
    if (!s->batch) return PDYN_NO_MEMORY;
    for (int b = 0; status == PDYN_OK && b < sys->batches; b++)
        if (batch_is_static(sys->batch[b]))
            status = follow_rows(sys->batch[b], &s->p.particles, &s->batch[b].rows);
    if (status == PDYN_OK) status = create_pattern(s);
    return status == PDYN_OK ? take_numbers(s) : status;
}

/* What making and factoring the matrix takes, in terms. */
static double find_cost(const struct coarse *s) {
    double cost = 0.0;
    for (int b = 0; b < s->objective->batches; b++) {
        const struct followed *f = &s->batch[b];
        const pdyn_batch *v = &s->objective->batch[b]->view;
        if (f->terms.start) cost += f->terms.start[f->terms.rows];
        for (int e = 0; f->rows.start && e < v->elements; e++) {
            double entries =
                f->rows.start[v->element_row[e + 1]] - f->rows.start[v->element_row[e]];
            cost += terms_of_part * entries * entries;
        }
    }
    for (int i = 0; i < s->a.nodes; i++) {
        double width = 3.0 * (i - s->a.first[i] + 1);
        cost += terms_of_product * 1.5 * width * width;
    }
    return cost;
}

/* After how many products with its inverse that has paid. */
static int find_worth(const struct coarse *s) {
    const struct objective *sys = s->objective;
    if (sys->dynamic_rows) return WORTH;
    return 1 + (int)(WORTH_STATIC * find_cost(s) / (terms_of_iteration * sys->particles));
}

static int smaller(int a, int b) { return a < b ? a : b; }

static int most_nodes(const struct objective *sys) {
    if (sys->dynamic_rows) return smaller(sys->particles / PARTICLES_OF_NODE, MOST_NODES);
    int few = smaller(sys->particles / PARTICLES_OF_FEW, FEW_NODES);
    int many = smaller(sys->particles / PARTICLES_OF_NODE_STATIC, MOST_NODES);
    return few < many ? many : few;
}

pdyn_status coarse_create(struct coarse *s, struct objective *objective) {
    pdyn_context *c = objective->context;
    s->objective = objective;
    pdyn_status status = interpolation_create(&s->p, objective, most_nodes(objective));
    if (status == PDYN_OK && s->p.nodes) status = create_matrix(s);
    if (status != PDYN_OK || !s->p.nodes) return status;
    s->worth = find_worth(s);
    s->x = NEW_ARRAY(c, 3 * s->p.nodes, double);
    s->sum = NEW_ARRAY(c, 3 * s->p.nodes, double);
    s->moved = NEW_ARRAY(c, 4 * s->p.nodes, float);
    if (objective->dynamic_rows) s->rest = NEW_ARRAY(c, 6 * (size_t)objective->particles, double);
    return s->x && s->sum && s->moved && (s->rest || !objective->dynamic_rows) ? PDYN_OK
                                                                               : PDYN_NO_MEMORY;
}

void coarse_free(struct coarse *s) {
    if (!s->objective) return;
    pdyn_context *c = s->objective->context;
    size_t blocks = s->a.start ? s->a.start[s->a.nodes] : 0;
    for (int b = 0; s->batch && b < s->objective->batches; b++) {
        struct followed *f = &s->batch[b];
        sparse_free(&f->rows), sparse_free(&f->nodes), sparse_free(&f->terms);
    }
    FREE_ARRAY(c, s->batch, s->objective->batches);
    FREE_ARRAY(c, s->stiffness, blocks);
    FREE_ARRAY(c, s->mass, blocks);
    skyline_free(&s->a);
    FREE_ARRAY(c, s->x, 3 * s->p.nodes);
    FREE_ARRAY(c, s->sum, 3 * s->p.nodes);
    FREE_ARRAY(c, s->moved, 4 * s->p.nodes);
    FREE_ARRAY(c, s->rest, 6 * (size_t)s->objective->particles);
    interpolation_free(&s->p);
}
