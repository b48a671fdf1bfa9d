#include "interpolation.h"

#include "objective/assembly.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SWEEPS = 50 }; /* of means of neighbours, in the order of nodes */

/* Entries of A's rows that count, of the largest. */
static const float strong = 0.25F;
/* A particle is held in place where that is so many times what pulls at it. */
static const float held = 10.0F;
/* Weights of at most this leave out more nodes than accuracy. */
static const float little = 0.05F;

/* ---- the matrix of a level ------------------------------------------------------------------- */

/* What holds each particle in place: the sums of A's rows but for inertia. */
static void take_held(const struct objective *sys, float *sum) {
    for (int b = 0; b < sys->batches; b++) {
        const struct batch *batch = sys->batch[b];
        const pdyn_batch *v = &batch->view;
        if (!batch_is_static(batch)) continue;
        for (int k = 0; k < batch->entries; k++) {
            double all = 0.0;
            for (int m = v->row_entry[batch->entry_row[k]];
                 m < v->row_entry[batch->entry_row[k] + 1]; m++)
                all += v->coefficient[m];
            double own = v->weight[batch->entry_element[k]] * v->coefficient[k] * all;
            if (fabs(all) > 1e-6 * fabs(v->coefficient[k])) sum[v->column[k]] += (float)own;
        }
    }
}

/* Both triangles of m's attractions, and diagonals that balance these and `sum`. */
static pdyn_status take_matrix(const struct matrix *m, const float *sum, struct sparse *out) {
    int n = m->particles, *counts = NEW_ARRAY(m->context, n, int);
    if (n && !counts) return PDYN_NO_MEMORY;
    for (int j = 0; j < n; j++)
        for (int k = m->block_start[j]; k < m->block_start[j + 1]; k++) {
            int i = m->block_row[k];
            if (i == j) counts[i]++;
            else if (m->value[k] < 0.0) counts[i]++, counts[j]++;
        }
    pdyn_status status = sparse_create(out, m->context, n, n, counts);
    if (status == PDYN_OK) {
        for (int i = 0; i < n; i++) {
            counts[i] = out->start[i] + 1;
            out->entry[out->start[i]] = (struct entry){i, sum[i]};
        }
        for (int j = 0; j < n; j++)
            for (int k = m->block_start[j] + 1; k < m->block_start[j + 1]; k++) {
                int i = m->block_row[k];
                float value = (float)m->value[k];
                if (!(m->value[k] < 0.0)) continue;
                out->entry[counts[i]++] = (struct entry){j, value};
                out->entry[counts[j]++] = (struct entry){i, value};
                out->entry[out->start[i]].value -= value;
                out->entry[out->start[j]].value -= value;
            }
    }
    FREE_ARRAY(m->context, counts, n);
    return status;
}

/* A of static rows, as x, y and z see it. */
static pdyn_status first_level(struct objective *sys, struct sparse *out) {
    pdyn_context *c = sys->context;
    struct matrix m = {0};
    struct batch **rows = NEW_ARRAY(c, sys->batches, struct batch *);
    float *sum = NEW_ARRAY(c, sys->particles, float);
    bool good = (rows || !sys->batches) && (sum || !sys->particles);
    for (int b = 0; good && b < sys->batches; b++)
        rows[b] = batch_is_static(sys->batch[b]) ? sys->batch[b] : NULL;
    pdyn_status status = good ? matrix_pattern(&m, sys, rows, 1) : PDYN_NO_MEMORY;
    if (status == PDYN_OK) {
        matrix_values(&m, sys, rows);
        take_held(sys, sum);
        status = take_matrix(&m, sum, out);
    }
    matrix_free(&m);
    FREE_ARRAY(c, rows, sys->batches);
    FREE_ARRAY(c, sum, sys->particles);
    return status;
}

/* P' A P */
static pdyn_status next_level(const struct sparse *a, const struct sparse *p, struct sparse *out) {
    struct sparse half = {0}, back = {0};
    pdyn_status status = sparse_multiply(a, p, 0.0F, &half);
    if (status == PDYN_OK) status = sparse_transpose(p, &back);
    if (status == PDYN_OK) status = sparse_multiply(&back, &half, 0.0F, out);
    sparse_free(&half), sparse_free(&back);
    return status;
}

/* ---- nodes ----------------------------------------------------------------------------------- */

enum { FREE = -1, FOLLOWS = -2, HELD = -3, ALONE = -4 }; /* what is no node */

/* The largest attraction of a row; *all: the sum of them; *diagonal. */
static float strongest(const struct sparse *a, int i, float *all, float *diagonal) {
    float most = 0.0F;
    *all = *diagonal = 0.0F;
    for (int k = a->start[i]; k < a->start[i + 1]; k++) {
        float pull = -a->entry[k].value;
        if (a->entry[k].column == i) *diagonal = -pull;
        else if (pull > 0.0F) most = fmaxf(most, pull), *all += pull;
    }
    return most;
}

static bool counts(const struct sparse *a, int i, int k, const float *most) {
    return a->entry[k].column != i && -a->entry[k].value >= strong * most[i] && most[i] > 0.0F;
}

/* role[i]: its node, or what it is instead; most: the largest attraction of each. In the order of
 * numbers, which neighbours mostly follow: nodes lie close together then, and on borders, too.
 * Returns how many there are. */
static int choose_nodes(const struct sparse *a, const float *most, int *role) {
    int nodes = 0;
    for (int i = 0; i < a->rows; i++) {
        if (role[i] != FREE) continue;
        role[i] = nodes++;
        for (int k = a->start[i]; k < a->start[i + 1]; k++) {
            int j = a->entry[k].column;
            bool both = counts(a, i, k, most) && -a->entry[k].value >= strong * most[j];
            if (both && role[j] == FREE) role[j] = FOLLOWS;
        }
    }
    return nodes;
}

/* The nodes that particle i follows, with what is held in place as one of no number; to: NULL, or
 * where these go. Returns how many. */
static int follow(const struct sparse *a, int i, const int *role, const float *most,
                  struct entry *to) {
    float sum = 0.0F;
    int count = 0;
    if (role[i] >= 0 && to) to[0] = (struct entry){role[i], 1.0F};
    if (role[i] != FOLLOWS) return role[i] >= 0;
    for (int k = a->start[i]; k < a->start[i + 1]; k++) {
        int whose = role[a->entry[k].column];
        if (!counts(a, i, k, most) || whose == FOLLOWS) continue;
        sum -= a->entry[k].value;
        if (whose < 0) continue;
        if (to) to[count] = (struct entry){whose, -a->entry[k].value};
        count++;
    }
    for (int k = 0; to && k < count; k++) to[k].value /= sum;
    return count;
}

/* What nothing ties stays a node; among particles, none of them is one. */
static int role_of(float diagonal, float all, bool particles) {
    if (diagonal - all > held * all) return HELD;
    return particles && !(all > 0.0F) ? ALONE : FREE;
}

/* P from the nodes of a level to all of it. */
static pdyn_status interpolate(const struct sparse *a, bool particles, struct sparse *out) {
    int n = a->rows;
    pdyn_context *c = a->context;
    int *role = NEW_ARRAY(c, n, int), *number = NEW_ARRAY(c, n, int);
    float *most = NEW_ARRAY(c, n, float);
    bool good = (!n || (role && number && most));
    for (int i = 0; good && i < n; i++) {
        float all, diagonal;
        most[i] = strongest(a, i, &all, &diagonal);
        role[i] = role_of(diagonal, all, particles);
    }
    int nodes = good ? choose_nodes(a, most, role) : 0;
    for (int i = 0; good && i < n; i++) number[i] = follow(a, i, role, most, NULL);
    pdyn_status status = good ? sparse_create(out, c, n, nodes, number) : PDYN_NO_MEMORY;
    for (int i = 0; status == PDYN_OK && i < n; i++)
        follow(a, i, role, most, out->entry + out->start[i]);
    FREE_ARRAY(c, role, n);
    FREE_ARRAY(c, number, n);
    FREE_ARRAY(c, most, n);
    return status;
}

/* ---- level upon level ------------------------------------------------------------------------ */

/* Leaves out small weights; the rest makes up for them. */
static void trim(struct sparse *p) {
    int kept = 0;
    for (int i = 0; i < p->rows; i++) {
        int first = kept;
        float all = 0.0F, sum = 0.0F;
        for (int k = p->start[i]; k < p->start[i + 1]; k++) {
            all += p->entry[k].value;
            if (p->entry[k].value > little)
                sum += p->entry[k].value, p->entry[kept++] = p->entry[k];
        }
        p->start[i] = first;
        for (int k = first; k < kept; k++) p->entry[k].value *= all / sum;
    }
    p->start[p->rows] = kept;
}

/* P = P Q, and A that of its nodes. */
static pdyn_status go_up(struct sparse *a, struct sparse *p, const struct sparse *q) {
    struct sparse next = {0}, all = {0};
    pdyn_status status = next_level(a, q, &next);
    if (status == PDYN_OK) status = sparse_multiply(p, q, 0.0F, &all);
    sparse_free(a), sparse_free(p);
    *a = next, *p = all;
    if (status == PDYN_OK) trim(p);
    return status;
}

/* Until there are at most so many nodes, or no fewer. */
static pdyn_status climb(struct sparse *a, struct sparse *p, int most) {
    struct sparse next = {0};
    pdyn_status status = interpolate(a, true, p);
    if (status == PDYN_OK) status = next_level(a, p, &next);
    sparse_free(a);
    *a = next;
    for (int before = INT32_MAX; status == PDYN_OK && a->rows > most && a->rows < before;) {
        struct sparse q = {0};
        before = a->rows;
        status = interpolate(a, false, &q);
        if (status == PDYN_OK) status = go_up(a, p, &q);
        sparse_free(&q);
    }
    return status;
}

/* ---- the order of nodes ---------------------------------------------------------------------- */

/* What is tied to a node, near before far; seen: turns to `mark`. Returns how many. */
static int walk(const struct sparse *a, int from, bool *seen, bool mark, int *queue) {
    int found = 1;
    queue[0] = from, seen[from] = mark;
    for (int k = 0; k < found; k++)
        for (int l = a->start[queue[k]]; l < a->start[queue[k] + 1]; l++) {
            int to = a->entry[l].column;
            if (seen[to] == mark) continue;
            seen[to] = mark;
            queue[found++] = to;
        }
    return found;
}

/* All of a level, each connected piece from one of its ends to the other. */
static bool put_in_line(const struct sparse *a, int *line) {
    bool *seen = NEW_ARRAY(a->context, a->rows, bool), good = seen || !a->rows;
    int done = 0;
    for (int i = 0; good && i < a->rows; i++) {
        if (seen[i]) continue;
        int found = walk(a, i, seen, true, line + done);
        walk(a, line[done + found - 1], seen, false, line + done);
        for (int k = 0; k < found; k++) seen[line[done++]] = true;
    }
    FREE_ARRAY(a->context, seen, a->rows);
    return good;
}

/* Where along its piece a node is. */
struct spot {
    int node;
    double place;
};

static int compare_spots(const void *a, const void *b) {
    const struct spot *x = a, *y = b;
    if (x->place != y->place) return x->place < y->place ? -1 : 1;
    return x->node - y->node;
}

/* Places become the means of those around them: fronts across a piece become straight, and short.
 */
static void straighten(const struct sparse *a, struct spot *spot, double *mean) {
    for (int i = 0; i < a->rows; i++) {
        double sum = 0.0, all = 0.0;
        for (int k = a->start[i]; k < a->start[i + 1]; k++) {
            double pull = fabs((double)a->entry[k].value);
            sum += pull * spot[a->entry[k].column].place, all += pull;
        }
        mean[i] = all > 0.0 ? sum / all : spot[i].place;
    }
    for (int i = 0; i < a->rows; i++) spot[i].place = mean[i];
}

/* How far rows reach to the left of the diagonal, all of them. */
static long profile(const struct sparse *a, const int *number) {
    long sum = 0;
    for (int i = 0; i < a->rows; i++) {
        int first = number[i];
        for (int k = a->start[i]; k < a->start[i + 1]; k++)
            if (number[a->entry[k].column] < first) first = number[a->entry[k].column];
        sum += number[i] - first;
    }
    return sum;
}

/* Nodes that are tied get near numbers: those along their pieces, or those they have. */
static pdyn_status put_in_order(const struct sparse *a, struct sparse *p) {
    pdyn_context *c = a->context;
    int n = a->rows, *number = NEW_ARRAY(c, n, int);
    struct spot *spot = NEW_ARRAY(c, n, struct spot);
    double *mean = NEW_ARRAY(c, n, double);
    bool good = (!n || (number && spot && mean)) && put_in_line(a, number);
    if (good && n) {
        for (int k = 0; k < n; k++) spot[number[k]] = (struct spot){number[k], (double)k};
        for (int k = 0; k < SWEEPS; k++) straighten(a, spot, mean);
        qsort(spot, (size_t)n, sizeof *spot, compare_spots);
        for (int k = 0; k < n; k++) number[k] = k;
        long own = profile(a, number);
        for (int k = 0; k < n; k++) number[spot[k].node] = k;
        bool along = profile(a, number) < own;
        for (int k = 0; along && k < p->start[p->rows]; k++)
            p->entry[k].column = number[p->entry[k].column];
    }
    FREE_ARRAY(c, number, n);
    FREE_ARRAY(c, spot, n);
    FREE_ARRAY(c, mean, n);
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status interpolation_create(struct interpolation *p, struct objective *sys, int most) {
    struct sparse a = {0};
    pdyn_status status = first_level(sys, &a);
    if (status == PDYN_OK) status = climb(&a, &p->particles, most);
    if (status == PDYN_OK) status = put_in_order(&a, &p->particles);
    if (status == PDYN_OK) status = sparse_transpose(&p->particles, &p->followers);
    sparse_free(&a);
    p->nodes = status == PDYN_OK ? p->followers.rows : 0;
    return status;
}

void interpolation_free(struct interpolation *p) {
    sparse_free(&p->particles), sparse_free(&p->followers);
}
