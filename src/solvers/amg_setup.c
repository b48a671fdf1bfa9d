#include "amg_setup.h"

#include "memory.h"

#include <math.h>

/* A coupling is strong from this part of the largest one in its row (Ruge and Stueben: 0.25). */
static const float strong_coupling = 0.25F;
/* A point is fixed (Dirichlet) where its own stiffness is this many times its couplings. */
static const float dirichlet_ratio = 10.0F;
/* Interpolation weights up to this are truncated. */
static const float truncation = 0.05F;

/* ---- the matrix of the first level ----------------------------------------------------------- */

/* Row sums of the graph: what holds each particle in place, N/m. Sums that are rounding are 0. */
static void sum_rows(const pdyn_matrix *m, double *sum, double *size) {
    for (int j = 0; j < m->size; j++)
        for (int k = m->start[j]; k < m->start[j + 1]; k++) {
            int i = m->row[k];
            sum[i] += m->value[k], size[i] += fabs(m->value[k]);
            if (i != j) sum[j] += m->value[k], size[j] += fabs(m->value[k]);
        }
    for (int i = 0; i < m->size; i++)
        if (fabs(sum[i]) <= 1e-9 * size[i]) sum[i] = 0.0;
}

/* Both triangles of the graph's negative couplings, and diagonals that balance these and `sum`. */
static pdyn_status copy_couplings(const pdyn_services *c, const pdyn_matrix *m, const double *sum,
                                  struct sparse *out) {
    int n = m->size, *counts = NEW(c, n, int);
    if (n && !counts) return PDYN_NO_MEMORY;
    for (int j = 0; j < n; j++)
        for (int k = m->start[j]; k < m->start[j + 1]; k++) {
            int i = m->row[k];
            if (i == j) counts[i]++;
            else if (m->value[k] < 0.0) counts[i]++, counts[j]++;
        }
    pdyn_status status = sparse_create(out, c, n, n, counts);
    for (int i = 0; status == PDYN_OK && i < n; i++) {
        counts[i] = out->start[i] + 1;
        out->entry[out->start[i]] = (struct entry){i, (float)sum[i]};
    }
    for (int j = 0; status == PDYN_OK && j < n; j++)
        for (int k = m->start[j]; k < m->start[j + 1]; k++) {
            int i = m->row[k];
            float value = (float)m->value[k];
            if (i == j || !(m->value[k] < 0.0)) continue;
            out->entry[counts[i]++] = (struct entry){j, value};
            out->entry[counts[j]++] = (struct entry){i, value};
            out->entry[out->start[i]].value -= value;
            out->entry[out->start[j]].value -= value;
        }
    FREE(c, counts, n);
    return status;
}

static pdyn_status first_level(pdyn_model *model, struct sparse *out) {
    const pdyn_services *c = model->services;
    int n = model->particles;
    pdyn_matrix m;
    pdyn_status status = model->graph(model, &m);
    if (status != PDYN_OK) return status;
    double *sum = NEW(c, n, double), *size = NEW(c, n, double);
    if (n && (!sum || !size)) status = PDYN_NO_MEMORY;
    if (status == PDYN_OK) {
        sum_rows(&m, sum, size);
        status = copy_couplings(c, &m, sum, out);
    }
    FREE(c, sum, n);
    FREE(c, size, n);
    return status;
}

/* I' A I */
static pdyn_status next_level(const struct sparse *a, const struct sparse *I, struct sparse *out) {
    struct sparse half = {0}, transpose = {0};
    pdyn_status status = sparse_multiply(a, I, 0.0F, &half);
    if (status == PDYN_OK) status = sparse_transpose(I, &transpose);
    if (status == PDYN_OK) status = sparse_multiply(&transpose, &half, 0.0F, out);
    sparse_free(&half), sparse_free(&transpose);
    return status;
}

/* ---- C-points and F-points ------------------------------------------------------------------- */

/* role[i]: the index of C-point i, or one of these. DIRICHLET: fixed, it stays where it is.
 * ISOLATED: not coupled to anything. */
enum { UNDECIDED = -1, F_POINT = -2, DIRICHLET = -3, ISOLATED = -4 };

/* The largest coupling of row i; *sum: of all its couplings; *diagonal. */
static float max_coupling(const struct sparse *a, int i, float *sum, float *diagonal) {
    float largest = 0.0F;
    *sum = *diagonal = 0.0F;
    for (int k = a->start[i]; k < a->start[i + 1]; k++) {
        float coupling = -a->entry[k].value;
        if (a->entry[k].column == i) *diagonal = -coupling;
        else if (coupling > 0.0F) largest = fmaxf(largest, coupling), *sum += coupling;
    }
    return largest;
}

/* Is entry k of row i a strong coupling? */
static bool is_strong(const struct sparse *a, int i, int k, const float *largest) {
    return a->entry[k].column != i && -a->entry[k].value >= strong_coupling * largest[i] &&
           largest[i] > 0.0F;
}

/* C-points are a greedy maximal independent set of the strong couplings, in index order: neighbours
 * mostly have close indices, so C-points lie close together, and on borders, too. Returns their
 * number. */
static int choose_c_points(const struct sparse *a, const float *largest, int *role) {
    int nodes = 0;
    for (int i = 0; i < a->rows; i++) {
        if (role[i] != UNDECIDED) continue;
        role[i] = nodes++;
        for (int k = a->start[i]; k < a->start[i + 1]; k++) {
            int j = a->entry[k].column;
            bool both =
                is_strong(a, i, k, largest) && -a->entry[k].value >= strong_coupling * largest[j];
            if (both && role[j] == UNDECIDED) role[j] = F_POINT;
        }
    }
    return nodes;
}

/* Interpolation weights of point i from its strong C-points; fixed points count in their sum. to:
 * NULL, or where the weights go. Returns their number. */
static int interpolate_point(const struct sparse *a, int i, const int *role, const float *largest,
                             struct entry *to) {
    float sum = 0.0F;
    int count = 0;
    if (role[i] >= 0 && to) to[0] = (struct entry){role[i], 1.0F};
    if (role[i] != F_POINT) return role[i] >= 0;
    for (int k = a->start[i]; k < a->start[i + 1]; k++) {
        int from = role[a->entry[k].column];
        if (!is_strong(a, i, k, largest) || from == F_POINT) continue;
        sum -= a->entry[k].value;
        if (from < 0) continue;
        if (to) to[count] = (struct entry){from, -a->entry[k].value};
        count++;
    }
    for (int k = 0; to && k < count; k++) to[k].value /= sum;
    return count;
}

/* An uncoupled particle belongs to no node; an uncoupled node of a higher level stays one. */
static int first_role(float diagonal, float sum, bool particles) {
    if (diagonal - sum > dirichlet_ratio * sum) return DIRICHLET;
    return particles && !(sum > 0.0F) ? ISOLATED : UNDECIDED;
}

/* Interpolation from the C-points of a level to all its points. */
static pdyn_status interpolate(const struct sparse *a, bool particles, struct sparse *out) {
    const pdyn_services *c = a->services;
    int n = a->rows, *role = NEW(c, n, int), *counts = NEW(c, n, int);
    float *largest = NEW(c, n, float);
    bool good = !n || (role && counts && largest);
    for (int i = 0; good && i < n; i++) {
        float sum, diagonal;
        largest[i] = max_coupling(a, i, &sum, &diagonal);
        role[i] = first_role(diagonal, sum, particles);
    }
    int nodes = good ? choose_c_points(a, largest, role) : 0;
    for (int i = 0; good && i < n; i++) counts[i] = interpolate_point(a, i, role, largest, NULL);
    pdyn_status status = good ? sparse_create(out, c, n, nodes, counts) : PDYN_NO_MEMORY;
    for (int i = 0; status == PDYN_OK && i < n; i++)
        interpolate_point(a, i, role, largest, out->entry + out->start[i]);
    FREE(c, role, n);
    FREE(c, counts, n);
    FREE(c, largest, n);
    return status;
}

/* ---- levels ---------------------------------------------------------------------------------- */

/* Drops small weights and scales the others to the same sum. */
static void truncate_weights(struct sparse *I) {
    int kept = 0;
    for (int i = 0; i < I->rows; i++) {
        int first = kept;
        float all = 0.0F, sum = 0.0F;
        for (int k = I->start[i]; k < I->start[i + 1]; k++) {
            all += I->entry[k].value;
            if (I->entry[k].value > truncation)
                sum += I->entry[k].value, I->entry[kept++] = I->entry[k];
        }
        I->start[i] = first;
        for (int k = first; k < kept; k++) I->entry[k].value *= all / sum;
    }
    I->start[I->rows] = kept;
}

/* One level more: I becomes I Q, a the matrix of its nodes. */
static pdyn_status add_level(struct sparse *a, struct sparse *I, const struct sparse *Q) {
    struct sparse next = {0}, product = {0};
    pdyn_status status = next_level(a, Q, &next);
    if (status == PDYN_OK) status = sparse_multiply(I, Q, 0.0F, &product);
    sparse_free(a), sparse_free(I);
    *a = next, *I = product;
    if (status == PDYN_OK) truncate_weights(I);
    return status;
}

/* Adds levels until there are at most max_nodes, or no fewer than on the level before. */
static pdyn_status add_levels(struct sparse *a, struct sparse *I, int max_nodes) {
    struct sparse next = {0};
    pdyn_status status = interpolate(a, true, I);
    if (status == PDYN_OK) status = next_level(a, I, &next);
    sparse_free(a);
    *a = next;
    for (int before = INT32_MAX; status == PDYN_OK && a->rows > max_nodes && a->rows < before;) {
        struct sparse Q = {0};
        before = a->rows;
        status = interpolate(a, false, &Q);
        if (status == PDYN_OK) status = add_level(a, I, &Q);
        sparse_free(&Q);
    }
    return status;
}

/* ---- the order of nodes ---------------------------------------------------------------------- */

/* Breadth-first search from a node over nodes whose mark differs; marks them. Returns how many. */
static int search(const struct sparse *a, int from, bool *marks, bool mark, int *queue) {
    int found = 1;
    queue[0] = from, marks[from] = mark;
    for (int k = 0; k < found; k++)
        for (int l = a->start[queue[k]]; l < a->start[queue[k] + 1]; l++) {
            int to = a->entry[l].column;
            if (marks[to] == mark) continue;
            marks[to] = mark;
            queue[found++] = to;
        }
    return found;
}

/* order: all nodes, each connected piece from one of its ends to the other. false: no memory. */
static bool order_pieces(const struct sparse *a, int *order) {
    bool *marks = NEW(a->services, a->rows, bool), good = marks || !a->rows;
    int done = 0;
    for (int i = 0; good && i < a->rows; i++) {
        if (marks[i]) continue;
        int found = search(a, i, marks, true, order + done);
        search(a, order[done + found - 1], marks, false, order + done);
        for (int k = 0; k < found; k++) marks[order[done++]] = true;
    }
    FREE(a->services, marks, a->rows);
    return good;
}

/* The size of a skyline factor with these indices, in blocks. */
static long profile_of(const struct sparse *a, const int *index) {
    long sum = 0;
    for (int i = 0; i < a->rows; i++) {
        int first = index[i];
        for (int k = a->start[i]; k < a->start[i + 1]; k++)
            if (index[a->entry[k].column] < first) first = index[a->entry[k].column];
        sum += index[i] - first;
    }
    return sum;
}

/* Gives coupled nodes close indices: along their pieces, if that makes the profile smaller. */
static pdyn_status order_nodes(const struct sparse *a, struct sparse *I) {
    const pdyn_services *c = a->services;
    int n = a->rows, *order = NEW(c, n, int), *index = NEW(c, n, int);
    bool good = (!n || (order && index)) && order_pieces(a, order);
    if (good) {
        for (int k = 0; k < n; k++) index[k] = k;
        long before = profile_of(a, index);
        for (int k = 0; k < n; k++) index[order[k]] = k;
        bool better = profile_of(a, index) < before;
        for (int k = 0; better && k < I->start[I->rows]; k++)
            I->entry[k].column = index[I->entry[k].column];
    }
    FREE(c, order, n);
    FREE(c, index, n);
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status amg_setup(struct amg_interpolation *out, pdyn_model *model, int max_nodes) {
    struct sparse a = {0};
    pdyn_status status = first_level(model, &a);
    if (status == PDYN_OK) status = add_levels(&a, &out->prolongation, max_nodes);
    if (status == PDYN_OK) status = order_nodes(&a, &out->prolongation);
    if (status == PDYN_OK) status = sparse_transpose(&out->prolongation, &out->restriction);
    sparse_free(&a);
    out->nodes = status == PDYN_OK ? out->restriction.rows : 0;
    return status;
}

void amg_free(struct amg_interpolation *p) {
    sparse_free(&p->prolongation), sparse_free(&p->restriction);
}
