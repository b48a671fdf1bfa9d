#include "groups.h"

#include <math.h>
#include <string.h>

/* Members of a group: so few that what they do among themselves is left to 3 x 3 blocks; more where
 * the factor would take too long otherwise. */
enum { MEMBERS = 16, MOST_GROUPS = 300 };

/* The matrix is made anew after so many products with its inverse: making it takes as long as some
 * ten of them and of those with H. Until then it is that of another H, which will do. */
enum { WORTH = 100 };

enum { GRAIN = 128 }; /* groups: worth waking a thread for */

/* Rows of a fluid or a contact tie some particles of a group together, of which the block diagonal
 * knows nothing: a group feels them up to this many times as much. */
static const double together = 4.0;

static bool is_static(const struct batch *b) { return !b->op && !b->changing; }

/* ---- graphs: who shares a row with whom ------------------------------------------------------ */

struct graph {
    pdyn_context *context;
    int nodes, links;
    int *start, *link; /* nodes + 1; links: neighbours of each node, ascending */
};

static void graph_free(struct graph *g) {
    if (!g->context) return;
    FREE_ARRAY(g->context, g->start, g->nodes + 1);
    FREE_ARRAY(g->context, g->link, g->links);
}

/* Of the particles, by the pattern of the static rows. */
static pdyn_status graph_of_pattern(struct graph *g, const struct matrix *m) {
    int n = m->particles;
    g->context = m->context, g->nodes = n, g->links = 2 * (m->block_start[n] - n);
    g->start = NEW_ARRAY(g->context, n + 1, int);
    g->link = NEW_ARRAY(g->context, g->links, int);
    if (!g->start || (g->links && !g->link)) return PDYN_NO_MEMORY;
    for (int j = 0; j < n; j++)
        for (int k = m->block_start[j] + 1; k < m->block_start[j + 1]; k++)
            g->start[j]++, g->start[m->block_row[k]]++;
    for (int i = 0, sum = 0; i <= n; i++) {
        int own = i < n ? g->start[i] : 0;
        g->start[i] = sum, sum += own;
    }
    for (int j = 0; j < n; j++)
        for (int k = m->block_start[j] + 1; k < m->block_start[j + 1]; k++) {
            int i = m->block_row[k];
            g->link[g->start[j]++] = i, g->link[g->start[i]++] = j;
        }
    memmove(g->start + 1, g->start, (size_t)n * sizeof *g->start);
    g->start[0] = 0;
    return PDYN_OK;
}

/* Marks what is linked to a node and marked below `below`, near before far, at most so many; queue:
 * in this order. Returns how many. */
static int walk(const struct graph *g, int from, int most, int below, int mark, int *marks,
                int *queue) {
    int found = 1;
    queue[0] = from, marks[from] = mark;
    for (int k = 0; k < found; k++)
        for (int l = g->start[queue[k]]; l < g->start[queue[k] + 1] && found < most; l++) {
            int to = g->link[l];
            if (marks[to] >= below) continue;
            marks[to] = mark;
            queue[found++] = to;
        }
    return found;
}

/* ---- making groups --------------------------------------------------------------------------- */

/* The held ones (marks -1) of each connected piece, from one of its ends to the other. Returns how
 * many. */
static int put_in_order(const struct graph *g, int *marks, int *order) {
    int done = 0;
    for (int i = 0; i < g->nodes; i++) {
        if (marks[i] >= 0) continue;
        int found = walk(g, i, g->nodes, 0, 0, marks, order + done);
        walk(g, order[done + found - 1], g->nodes, 1, 1, marks, order + done);
        done += found;
    }
    return done;
}

/* In this order, so that groups that are linked have near numbers. */
static void grow(struct groups *s, const struct graph *g, const int *order, int held) {
    int members = held / MOST_GROUPS > MEMBERS ? held / MOST_GROUPS : MEMBERS, found = 0;
    for (int k = 0; k < held; k++)
        if (s->group[order[k]] < 0)
            found += walk(g, order[k], members, 0, s->count++, s->group, s->member + found);
}

static pdyn_status make_groups(struct groups *s, const struct graph *g) {
    struct system *sys = s->system;
    int n = sys->particles, *marks = NEW_ARRAY(sys->context, n, int),
        *order = NEW_ARRAY(sys->context, n, int);
    if (marks && order) {
        for (int i = 0; i < n; i++) marks[i] = 1, s->group[i] = -1;
        for (int b = 0; b < sys->batches; b++) {
            const struct batch *batch = sys->batch[b];
            for (int i = 0; is_static(batch) && i < batch->touch_count; i++)
                if (batch->touch_start[i + 1] > batch->touch_start[i])
                    marks[batch->touch_first + i] = -1;
        }
        grow(s, g, order, put_in_order(g, marks, order));
    }
    bool good = marks && order;
    FREE_ARRAY(sys->context, marks, n);
    FREE_ARRAY(sys->context, order, n);
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

/* Members of each group, one group after the other. */
static pdyn_status index_members(struct groups *s) {
    s->first = NEW_ARRAY(s->system->context, s->count + 1, int);
    if (!s->first) return PDYN_NO_MEMORY;
    for (int i = 0; i < s->system->particles; i++)
        if (s->group[i] >= 0) s->first[s->group[i] + 1]++;
    for (int g = 0; g < s->count; g++) s->first[g + 1] += s->first[g];
    return PDYN_OK;
}

static pdyn_status find_groups(struct groups *s) {
    struct system *sys = s->system;
    struct batch **rows = NEW_ARRAY(sys->context, sys->batches, struct batch *);
    struct matrix pattern = {0};
    struct graph graph = {0};
    if (sys->batches && !rows) return PDYN_NO_MEMORY;
    for (int b = 0; b < sys->batches; b++)
        if (is_static(sys->batch[b])) rows[b] = sys->batch[b];
    pdyn_status status = matrix_pattern(&pattern, sys, rows, 1);
    if (status == PDYN_OK) status = graph_of_pattern(&graph, &pattern);
    if (status == PDYN_OK) status = make_groups(s, &graph);
    if (status == PDYN_OK) status = index_members(s);
    FREE_ARRAY(sys->context, rows, sys->batches);
    matrix_free(&pattern);
    graph_free(&graph);
    return status;
}

/* ---- the matrix ------------------------------------------------------------------------------ */

static int entry_of(const pdyn_batch *v, int element) {
    return v->row_entry[v->element_row[element]];
}

/* An element reaches from its lowest group to all others. */
static void reach(const struct groups *s, const pdyn_batch *v, int *first) {
    for (int e = 0; e < v->elements; e++) {
        int lowest = s->count;
        for (int k = entry_of(v, e); k < entry_of(v, e + 1); k++)
            if (s->group[v->column[k]] < lowest) lowest = s->group[v->column[k]];
        for (int k = entry_of(v, e); k < entry_of(v, e + 1); k++)
            for (int a = 0, g = s->group[v->column[k]]; a < 3; a++)
                if (3 * lowest < first[3 * g + a]) first[3 * g + a] = 3 * lowest;
    }
}

static void add_block(struct groups *s, int i, int j, double c, const double B[9]) {
    for (int p = 0; p < 3; p++) {
        double *row = skyline_at(&s->a, 3 * i + p, 3 * j);
        for (int q = 0; q < (i == j ? p + 1 : 3); q++) row[q] += c * B[3 * p + q];
    }
}

/* Whether the element stays as it is where each group moves as one. */
static bool is_inside(const struct groups *s, const pdyn_batch *v, int e) {
    int group = s->group[v->column[entry_of(v, e)]];
    for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++) {
        double sum = 0.0, size = 0.0;
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++) {
            if (s->group[v->column[k]] != group) return false;
            sum += v->coefficient[k], size += fabs(v->coefficient[k]);
        }
        if (fabs(sum) > 1e-9 * size) return false;
    }
    return true;
}

static void add_batch(struct groups *s, const struct batch *b) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < v->elements; e++) {
        if (is_inside(s, v, e)) continue;
        for (int k = entry_of(v, e); k < entry_of(v, e + 1); k++)
            for (int m = entry_of(v, e); m < entry_of(v, e + 1); m++) {
                int i = s->group[v->column[k]], j = s->group[v->column[m]];
                double B[9];
                if (i < j) continue;
                batch_block(b, k, m, B);
                add_block(s, i, j, v->coefficient[k] * v->coefficient[m], B);
            }
    }
}

/* Inertia, and what is not static. */
static void add_diagonals(struct groups *s) {
    struct system *sys = s->system;
    memset(s->rest, 0, 6 * (size_t)sys->particles * sizeof *s->rest);
    for (int b = 0; b < sys->batches; b++)
        if (!is_static(sys->batch[b])) batch_diagonal(sys->batch[b], s->rest);
    for (int g = 0; g < s->count; g++) {
        double D[6] = {0}, inertia = 0.0;
        for (int k = s->first[g]; k < s->first[g + 1]; k++) {
            for (int a = 0; a < 6; a++) D[a] += together * s->rest[6 * (size_t)s->member[k] + a];
            inertia += system_inertia(sys, s->member[k]);
        }
        add_block(s, g, g, 1.0,
                  (double[9]){D[0] + inertia, D[1], D[2], D[1], D[3] + inertia, D[4], D[2], D[4],
                              D[5] + inertia});
    }
}

void groups_prepare(struct groups *s) {
    struct system *sys = s->system;
    if (!s->count || (s->made && s->used < WORTH)) return;
    s->made = true, s->used = 0;
    memcpy(s->a.value, s->constant, s->a.start[s->a.rows] * sizeof *s->constant);
    for (int b = 0; b < sys->batches; b++)
        if (is_static(sys->batch[b]) && !sys->batch[b]->stiffness) add_batch(s, sys->batch[b]);
    add_diagonals(s);
    skyline_factor(&s->a);
}

static pdyn_status make_matrix(struct groups *s) {
    struct system *sys = s->system;
    int rows = 3 * s->count, *first = NEW_ARRAY(sys->context, rows, int);
    if (rows && !first) return PDYN_NO_MEMORY;
    for (int i = 0; i < rows; i++) first[i] = i - i % 3;
    for (int b = 0; b < sys->batches; b++)
        if (is_static(sys->batch[b])) reach(s, &sys->batch[b]->view, first);
    pdyn_status status = skyline_create(&s->a, sys->context, rows, first);
    FREE_ARRAY(sys->context, first, rows);
    if (status != PDYN_OK) return status;
    size_t values = s->a.start[rows];
    s->constant = NEW_ARRAY(sys->context, values, double);
    if (values && !s->constant) return PDYN_NO_MEMORY;
    for (int b = 0; b < sys->batches; b++)
        if (is_static(sys->batch[b]) && sys->batch[b]->stiffness) add_batch(s, sys->batch[b]);
    if (values) memcpy(s->constant, s->a.value, values * sizeof *s->constant);
    return PDYN_OK;
}

pdyn_status groups_create(struct groups *s, struct system *system) {
    size_t n = (size_t)system->particles;
    s->system = system;
    s->group = NEW_ARRAY(system->context, n, int);
    s->member = NEW_ARRAY(system->context, n, int);
    s->rest = NEW_ARRAY(system->context, 6 * n, double);
    if (n && (!s->group || !s->member || !s->rest)) return PDYN_NO_MEMORY;
    pdyn_status status = find_groups(s);
    if (status == PDYN_OK) status = make_matrix(s);
    if (status != PDYN_OK) return status;
    s->x = NEW_ARRAY(system->context, 3 * s->count, double);
    s->sum = NEW_ARRAY(system->context, 3 * s->count, double);
    return s->count && (!s->x || !s->sum) ? PDYN_NO_MEMORY : PDYN_OK;
}

void groups_free(struct groups *s) {
    if (!s->system) return;
    pdyn_context *context = s->system->context;
    size_t n = (size_t)s->system->particles;
    if (s->a.start) FREE_ARRAY(context, s->constant, s->a.start[s->a.rows]);
    skyline_free(&s->a);
    FREE_ARRAY(context, s->x, 3 * s->count);
    FREE_ARRAY(context, s->sum, 3 * s->count);
    FREE_ARRAY(context, s->first, s->count + 1);
    FREE_ARRAY(context, s->rest, 6 * n);
    FREE_ARRAY(context, s->member, n);
    FREE_ARRAY(context, s->group, n);
}

void groups_persist(struct groups *s, pdyn_archive *archive) {
    archive->bytes(archive, &s->made, sizeof s->made);
    archive->bytes(archive, &s->used, sizeof s->used);
    archive->bytes(archive, s->a.value, s->a.start[s->a.rows] * sizeof *s->a.value);
}

/* ---- a product ------------------------------------------------------------------------------- */

static void sum_groups(void *arg, int first, int last, int block) {
    (void)block;
    const struct groups *s = arg;
    for (int g = first; g < last; g++) {
        double sum[3] = {0};
        for (int k = s->first[g]; k < s->first[g + 1]; k++)
            for (int a = 0; a < 3; a++) sum[a] += s->r[3 * (size_t)s->member[k] + a];
        memcpy(s->x + 3 * g, sum, sizeof sum);
    }
}

static void move_groups(void *arg, int first, int last, int block) {
    (void)block;
    const struct groups *s = arg;
    for (int k = s->first[first]; k < s->first[last]; k++) {
        const double *x = s->x + 3 * s->group[s->member[k]];
        for (int a = 0; a < 3; a++) s->z[3 * (size_t)s->member[k] + a] += x[a];
    }
}

double groups_add(struct groups *s, const double *r, double *z) {
    struct pool *pool = s->system->context->pool;
    double rz = 0.0;
    if (!s->count) return 0.0;
    s->r = r, s->z = z, s->used++;
    pool_for(pool, s->count, GRAIN, sum_groups, s);
    memcpy(s->sum, s->x, 3 * (size_t)s->count * sizeof *s->x);
    skyline_solve(&s->a, s->x);
    for (int k = 0; k < 3 * s->count; k++) rz += s->sum[k] * s->x[k];
    pool_for(pool, s->count, GRAIN, move_groups, s);
    return rz;
}
