/* Setup of the coarse space: the pattern of A, and how much each element adds to which block. */
#include "coarse_space.h"
#include "memory.h"

#include <math.h>
#include <string.h>

/* Number of nodes: at most one per so many particles. A sheet takes as many iterations at any size
 * if a node stands for as many particles at any size; the factor, whose cost grows with the square
 * of the number, sets the limit. Small stiff sheets need more. Beside fluid and contact, where most
 * iterations are for short waves, the limit is lower. */
enum { MAX_NODES = 400, PARTICLES_PER_NODE = 12 };
enum { MAX_NODES_STATIC = 1600, PARTICLES_PER_NODE_STATIC = 10 };
enum { FEW_NODES = 120, PARTICLES_PER_NODE_FEW = 4 };

/* An entry of G I below this part of the largest one in its row is added to that one: half of the
 * terms, with as few iterations. */
static const float weak_entry = 0.25F;

/* The stiffness of constant elements, relative to that of all other elements of their body, below
 * which they get no blocks of their own in the pattern of A. */
static const double weak_elements = 0.3;

/* Corrections that one factor is used for; and where all is static, as many as take so many times
 * as long as computing it. */
enum { LIFETIME = 200, LIFETIME_STATIC = 4 };

/* Costs in units of one term of A, measured: an iteration, per particle; a 3 x 3 part of an element
 * of several rows; a multiplication in the factorisation. */
static const double cost_of_iteration = 30.0, cost_of_part = 4.0, cost_of_product = 1.0 / 30.0;

/* ---- G I ------------------------------------------------------------------------------------- */

/* Adds weak entries of each row to the strongest one: the sum of a row stays. */
static void merge_weak_entries(struct sparse *rows) {
    int kept = 0;
    for (int r = 0; r < rows->rows; r++) {
        int first = rows->start[r], last = rows->start[r + 1], strongest = first;
        float rest = 0.0F;
        for (int k = first; k < last; k++)
            if (fabsf(rows->entry[k].value) > fabsf(rows->entry[strongest].value)) strongest = k;
        float limit = first < last ? weak_entry * fabsf(rows->entry[strongest].value) : 0.0F;
        for (int k = first; k < last; k++)
            if (fabsf(rows->entry[k].value) < limit) rest += rows->entry[k].value;
        rows->start[r] = kept;
        for (int k = first; k < last; k++) {
            struct entry e = rows->entry[k];
            if (k == strongest) e.value += rest;
            if (k == strongest || fabsf(e.value) >= limit) rows->entry[kept++] = e;
        }
    }
    rows->start[rows->rows] = kept;
}

static int rows_of(const pdyn_batch *b) { return b->element_row[b->elements]; }

/* G of a constraint's rows; *largest: its largest absolute coefficient. */
static pdyn_status copy_selector(const pdyn_services *c, const pdyn_batch *b, int particles,
                                 float *largest, struct sparse *G) {
    int rows = rows_of(b), *counts = NEW(c, rows, int);
    if (rows && !counts) return PDYN_NO_MEMORY;
    for (int r = 0; r < rows; r++) counts[r] = b->row_entry[r + 1] - b->row_entry[r];
    pdyn_status status = sparse_create(G, c, rows, particles, counts);
    FREE(c, counts, rows);
    *largest = 0.0F;
    for (int k = 0; status == PDYN_OK && k < b->row_entry[rows]; k++) {
        float value = (float)b->coefficient[k];
        G->entry[k] = (struct entry){b->column[k], value};
        *largest = fmaxf(*largest, fabsf(value));
    }
    return status;
}

/* G I of a constraint's rows. */
static pdyn_status interpolate_rows(const pdyn_batch *b, const struct sparse *I,
                                    struct sparse *out) {
    struct sparse G = {0};
    float largest;
    pdyn_status status = copy_selector(I->services, b, I->rows, &largest, &G);
    if (status == PDYN_OK) status = sparse_multiply(&G, I, 1e-5F * largest, out);
    if (status == PDYN_OK) merge_weak_entries(out);
    sparse_free(&G);
    return status;
}

/* ---- the pattern of A ------------------------------------------------------------------------ */

/* Couples all nodes of the rows [begin, end) of an element: first[node] is the lowest of them. */
static void couple_nodes(const struct sparse *rows, int begin, int end, int *first) {
    int lowest = INT32_MAX;
    for (int k = rows->start[begin]; k < rows->start[end]; k++)
        if (rows->entry[k].column < lowest) lowest = rows->entry[k].column;
    for (int k = rows->start[begin]; k < rows->start[end]; k++)
        if (lowest < first[rows->entry[k].column]) first[rows->entry[k].column] = lowest;
}

/* The trace of what rows of two particles or more add to the projective step's matrix. */
static double trace_of(const pdyn_batch *b) {
    double sum = 0.0;
    for (int e = 0; e < b->elements; e++)
        for (int r = b->element_row[e]; r < b->element_row[e + 1]; r++)
            for (int k = b->row_entry[r]; k < b->row_entry[r + 1]; k++)
                if (b->row_entry[r + 1] - b->row_entry[r] > 1)
                    sum += b->weight[e] * b->coefficient[k] * b->coefficient[k];
    return sum;
}

/* Constant elements that are weak beside the others of their body: bending beside stretching. Their
 * wide stencils would fill A. */
static bool is_weak(const struct coarse_space *s, const pdyn_elements *elements) {
    double others = 0.0;
    if (!elements->constant) return false;
    for (int k = 0; k < s->model->elements_count; k++) {
        const pdyn_elements *other = &s->part[k].now;
        if (!other->constant && other->steady && other->rows->body == elements->rows->body)
            others += trace_of(other->rows);
    }
    return trace_of(elements->rows) <= weak_elements * others;
}

static pdyn_status create_pattern(struct coarse_space *s) {
    const pdyn_services *c = s->model->services;
    int nodes = s->interpolation.nodes, *first = NEW(c, nodes, int);
    if (!first) return PDYN_NO_MEMORY;
    for (int i = 0; i < nodes; i++) first[i] = i;
    for (int k = 0; k < s->model->elements_count; k++) {
        const pdyn_batch *b = s->part[k].now.rows;
        if (is_weak(s, &s->part[k].now)) continue;
        for (int e = 0; e < b->elements; e++)
            couple_nodes(&s->part[k].rows, b->element_row[e], b->element_row[e + 1], first);
    }
    for (int i = 0; s->model->dynamic && i < s->model->particles; i++)
        couple_nodes(&s->interpolation.prolongation, i, i + 1, first);
    pdyn_status status = skyline_create(&s->a, c, nodes, first);
    FREE(c, first, nodes);
    return status;
}

/* ---- contributions to A ---------------------------------------------------------------------- */

/* Counts, and stores where terms is not NULL, the products of all pairs of entries of a row, by
 * blocks of the lower triangle. */
static void visit_pairs(const struct coarse_space *s, const struct sparse *rows, int *counts,
                        struct sparse *terms) {
    for (int r = 0; r < rows->rows; r++)
        for (int k = rows->start[r]; k < rows->start[r + 1]; k++)
            for (int m = rows->start[r]; m < rows->start[r + 1]; m++) {
                int i = rows->entry[k].column, j = rows->entry[m].column;
                if (j > i) continue;
                int at = counts[skyline_block(&s->a, i, j)]++;
                if (terms)
                    terms->entry[at] =
                        (struct entry){r, rows->entry[k].value * rows->entry[m].value};
            }
}

/* Elements of one row: for each block of A, which elements add to it, and by what factor. */
static pdyn_status create_terms(struct coarse_space *s, const struct sparse *rows,
                                struct sparse *terms) {
    const pdyn_services *c = rows->services;
    size_t blocks = s->a.start[s->a.nodes];
    int *counts = NEW(c, blocks, int);
    if (!counts) return PDYN_NO_MEMORY;
    visit_pairs(s, rows, counts, NULL);
    pdyn_status status = sparse_create(terms, c, (int)blocks, rows->rows, counts);
    if (status == PDYN_OK) {
        memcpy(counts, terms->start, blocks * sizeof *counts);
        visit_pairs(s, rows, counts, terms);
    }
    FREE(c, counts, blocks);
    return status;
}

/* Elements of several rows: the transpose of G I, and the element of each row. */
static pdyn_status create_transpose(struct coarse_rows *f) {
    const pdyn_batch *b = f->now.rows;
    f->row_element = NEW(f->rows.services, rows_of(b), int);
    if (rows_of(b) && !f->row_element) return PDYN_NO_MEMORY;
    for (int e = 0; e < b->elements; e++)
        for (int r = b->element_row[e]; r < b->element_row[e + 1]; r++) f->row_element[r] = e;
    return sparse_transpose(&f->rows, &f->transpose);
}

/* Adds a number between particles i and j to the blocks of `to`. Between nodes without a block in
 * the pattern it goes to both diagonals, which keeps A positive definite. */
static void add_number(const struct coarse_space *s, int i, int j, double number, double *to) {
    const struct sparse *I = &s->interpolation.prolongation;
    for (int k = I->start[i]; k < I->start[i + 1]; k++)
        for (int m = I->start[j]; m < I->start[j + 1]; m++) {
            int row = I->entry[k].column, column = I->entry[m].column;
            double part = (double)I->entry[k].value * (double)I->entry[m].value * number;
            if (column > row) continue;
            if (column >= s->a.first[row]) to[skyline_block(&s->a, row, column)] += part;
            else
                to[skyline_block(&s->a, row, row)] += fabs(part),
                    to[skyline_block(&s->a, column, column)] += fabs(part);
        }
}

/* Constant elements are summed once. */
static void sum_constant(struct coarse_space *s, const pdyn_batch *b) {
    for (int e = 0; e < b->elements; e++)
        for (int r = b->element_row[e]; r < b->element_row[e + 1]; r++)
            for (int k = b->row_entry[r]; k < b->row_entry[r + 1]; k++)
                for (int m = b->row_entry[r]; m < b->row_entry[r + 1]; m++)
                    add_number(s, b->column[k], b->column[m],
                               b->weight[e] * b->coefficient[k] * b->coefficient[m], s->stiffness);
}

static pdyn_status create_contribution(struct coarse_space *s, struct coarse_rows *f) {
    const pdyn_batch *b = f->now.rows;
    if (!f->now.constant && rows_of(b) != b->elements) return create_transpose(f);
    pdyn_status status = PDYN_OK;
    if (f->now.constant) sum_constant(s, b);
    else status = create_terms(s, &f->rows, &f->terms);
    sparse_free(&f->rows);
    return status;
}

static pdyn_status create_matrix(struct coarse_space *s) {
    pdyn_model *m = s->model;
    pdyn_status status = PDYN_OK;
    s->part = NEW(m->services, m->elements_count, struct coarse_rows);
    if (!s->part) return PDYN_NO_MEMORY;
    for (int k = 0; k < m->elements_count; k++) s->part[k].now = m->elements(m, k);
    for (int k = 0; status == PDYN_OK && k < m->elements_count; k++)
        status =
            interpolate_rows(s->part[k].now.rows, &s->interpolation.prolongation, &s->part[k].rows);
    if (status == PDYN_OK) status = create_pattern(s);
    if (status != PDYN_OK) return status;
    s->stiffness = NEW(m->services, s->a.start[s->a.nodes], double);
    s->mass = NEW(m->services, s->a.start[s->a.nodes], double);
    if (!s->stiffness || !s->mass) return PDYN_NO_MEMORY;
    for (int i = 0; i < m->particles; i++) add_number(s, i, i, m->mass[i], s->mass);
    for (int k = 0; status == PDYN_OK && k < m->elements_count; k++)
        status = create_contribution(s, &s->part[k]);
    return status;
}

/* ---- sizes ----------------------------------------------------------------------------------- */

/* The cost of computing and factoring A. */
static double cost_of_matrix(const struct coarse_space *s) {
    double cost = 0.0;
    for (int k = 0; k < s->model->elements_count; k++) {
        const struct coarse_rows *f = &s->part[k];
        const pdyn_batch *b = f->now.rows;
        if (f->terms.start) cost += f->terms.start[f->terms.rows];
        for (int e = 0; f->rows.start && e < b->elements; e++) {
            double entries =
                f->rows.start[b->element_row[e + 1]] - f->rows.start[b->element_row[e]];
            cost += cost_of_part * entries * entries;
        }
    }
    for (int i = 0; i < s->a.nodes; i++) {
        double width = 3.0 * (i - s->a.first[i] + 1);
        cost += cost_of_product * 1.5 * width * width;
    }
    return cost;
}

static int lifetime_of(const struct coarse_space *s) {
    if (s->model->dynamic) return LIFETIME;
    double iteration = cost_of_iteration * s->model->particles;
    return 1 + (int)(LIFETIME_STATIC * cost_of_matrix(s) / iteration);
}

static int smaller(int a, int b) { return a < b ? a : b; }

static int max_nodes(const pdyn_model *model) {
    int n = model->particles;
    if (model->dynamic) return smaller(n / PARTICLES_PER_NODE, MAX_NODES);
    int few = smaller(n / PARTICLES_PER_NODE_FEW, FEW_NODES);
    int many = smaller(n / PARTICLES_PER_NODE_STATIC, MAX_NODES_STATIC);
    return few < many ? many : few;
}

/* ---- life ------------------------------------------------------------------------------------ */

pdyn_status coarse_space_create(struct coarse_space *s, pdyn_model *model) {
    const pdyn_services *c = model->services;
    s->model = model;
    pdyn_status status = amg_setup(&s->interpolation, model, max_nodes(model));
    if (status == PDYN_OK && s->interpolation.nodes) status = create_matrix(s);
    if (status != PDYN_OK || !s->interpolation.nodes) return status;
    s->lifetime = lifetime_of(s);
    s->x = NEW(c, 3 * s->interpolation.nodes + 1, double);
    if (model->dynamic) s->dynamic = NEW(c, 6 * (size_t)model->particles, double);
    return s->x && (s->dynamic || !model->dynamic) ? PDYN_OK : PDYN_NO_MEMORY;
}

void coarse_space_free(struct coarse_space *s) {
    if (!s->model) return;
    const pdyn_services *c = s->model->services;
    size_t blocks = s->a.start ? s->a.start[s->a.nodes] : 0;
    for (int k = 0; s->part && k < s->model->elements_count; k++) {
        struct coarse_rows *f = &s->part[k];
        FREE(c, f->row_element, rows_of(f->now.rows));
        sparse_free(&f->rows), sparse_free(&f->transpose), sparse_free(&f->terms);
    }
    FREE(c, s->part, s->model->elements_count);
    FREE(c, s->stiffness, blocks);
    FREE(c, s->mass, blocks);
    skyline_free(&s->a);
    FREE(c, s->x, 3 * s->interpolation.nodes + 1);
    FREE(c, s->dynamic, 6 * (size_t)s->model->particles);
    amg_free(&s->interpolation);
}
