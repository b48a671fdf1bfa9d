#include "groups.h"

#include "../core/simd.h"

#include <math.h>
#include <string.h>

/* The matrix is made anew after so many products with its inverse: making it takes as long as some
 * ten of them and of those with H, and twice that with tets. Until then it is that of another H,
 * which will do. */
enum { WORTH = 200 };

enum { GRAIN = 128 }; /* groups: worth waking a thread for */

/* Rows of a fluid or a contact tie some particles of a group together, of which the block diagonal
 * knows nothing: a group feels them up to this many times as much. */
static const double together = 4.0;

/* ---- the matrix ------------------------------------------------------------------------------ */

static int entry_of(const pdyn_batch *v, int element) {
    return v->row_entry[v->element_row[element]];
}

/* An element reaches from its lowest group to all others. */
static void reach(const struct groups *s, const pdyn_batch *v, int *first) {
    for (int e = 0; e < v->elements; e++) {
        int lowest = s->clusters.count;
        for (int k = entry_of(v, e); k < entry_of(v, e + 1); k++)
            if (s->clusters.of[v->column[k]] < lowest) lowest = s->clusters.of[v->column[k]];
        for (int k = entry_of(v, e); k < entry_of(v, e + 1); k++)
            for (int a = 0, g = s->clusters.of[v->column[k]]; a < 3; a++)
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
    int group = s->clusters.of[v->column[entry_of(v, e)]];
    for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++) {
        double sum = 0.0, size = 0.0;
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++) {
            if (s->clusters.of[v->column[k]] != group) return false;
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
                int i = s->clusters.of[v->column[k]], j = s->clusters.of[v->column[m]];
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
        if (!batch_is_static(sys->batch[b])) batch_diagonal(sys->batch[b], s->rest);
    for (int g = 0; g < s->clusters.count; g++) {
        double D[6] = {0}, inertia = 0.0;
        for (int k = s->clusters.first[g]; k < s->clusters.first[g + 1]; k++) {
            for (int a = 0; a < 6; a++)
                D[a] += together * s->rest[6 * (size_t)s->clusters.member[k] + a];
            inertia += system_inertia(sys, s->clusters.member[k]);
        }
        add_block(s, g, g, 1.0,
                  (double[9]){D[0] + inertia, D[1], D[2], D[1], D[3] + inertia, D[4], D[2], D[4],
                              D[5] + inertia});
    }
}

void groups_prepare(struct groups *s) {
    struct system *sys = s->system;
    if (!s->clusters.count || s->left > 0) return;
    memcpy(s->a.value, s->constant, s->a.start[s->a.rows] * sizeof *s->constant);
    for (int b = 0; b < sys->batches; b++)
        if (batch_is_static(sys->batch[b]) && !sys->batch[b]->stiffness)
            add_batch(s, sys->batch[b]);
    add_diagonals(s);
    s->left = skyline_factor(&s->a) ? WORTH : 0;
}

static pdyn_status make_matrix(struct groups *s) {
    struct system *sys = s->system;
    int rows = 3 * s->clusters.count, *first = NEW_ARRAY(sys->context, rows, int);
    if (rows && !first) return PDYN_NO_MEMORY;
    for (int i = 0; i < rows; i++) first[i] = i - i % 3;
    for (int b = 0; b < sys->batches; b++)
        if (batch_is_static(sys->batch[b])) reach(s, &sys->batch[b]->view, first);
    pdyn_status status = skyline_create(&s->a, sys->context, rows, first);
    FREE_ARRAY(sys->context, first, rows);
    if (status != PDYN_OK) return status;
    size_t values = s->a.start[rows];
    s->constant = NEW_ARRAY(sys->context, values, double);
    if (values && !s->constant) return PDYN_NO_MEMORY;
    for (int b = 0; b < sys->batches; b++)
        if (batch_is_static(sys->batch[b]) && sys->batch[b]->stiffness) add_batch(s, sys->batch[b]);
    if (values) memcpy(s->constant, s->a.value, values * sizeof *s->constant);
    return PDYN_OK;
}

pdyn_status groups_create(struct groups *s, struct system *system) {
    size_t n = (size_t)system->particles;
    s->system = system;
    s->rest = NEW_ARRAY(system->context, 6 * n, double);
    if (n && !s->rest) return PDYN_NO_MEMORY;
    pdyn_status status = clusters_create(&s->clusters, system);
    if (status == PDYN_OK) status = make_matrix(s);
    if (status != PDYN_OK) return status;
    s->x = NEW_ARRAY(system->context, 3 * s->clusters.count, double);
    s->sum = NEW_ARRAY(system->context, 3 * s->clusters.count, double);
    s->moved = NEW_ARRAY(system->context, 4 * s->clusters.count, float);
    return s->clusters.count && (!s->x || !s->sum || !s->moved) ? PDYN_NO_MEMORY : PDYN_OK;
}

void groups_free(struct groups *s) {
    if (!s->system) return;
    pdyn_context *context = s->system->context;
    size_t n = (size_t)s->system->particles;
    if (s->a.start) FREE_ARRAY(context, s->constant, s->a.start[s->a.rows]);
    skyline_free(&s->a);
    FREE_ARRAY(context, s->x, 3 * s->clusters.count);
    FREE_ARRAY(context, s->sum, 3 * s->clusters.count);
    FREE_ARRAY(context, s->moved, 4 * s->clusters.count);
    FREE_ARRAY(context, s->rest, 6 * n);
    clusters_free(&s->clusters);
}

void groups_persist(struct groups *s, pdyn_archive *archive) {
    archive->bytes(archive, &s->left, sizeof s->left);
    archive->bytes(archive, s->a.value, s->a.start[s->a.rows] * sizeof *s->a.value);
}

/* ---- a product ------------------------------------------------------------------------------- */

static void sum_groups(void *arg, int first, int last, int block) {
    (void)block;
    const struct groups *s = arg;
    for (int g = first; g < last; g++) {
        double sum[3] = {0};
        for (int k = s->clusters.first[g]; k < s->clusters.first[g + 1]; k++)
            for (int a = 0; a < 3; a++) sum[a] += s->r[3 * (size_t)s->clusters.member[k] + a];
        memcpy(s->x + 3 * g, sum, sizeof sum);
    }
}

WIDE static void sum_groups_single(void *arg, int first, int last, int block) {
    (void)block;
    const struct groups *s = arg;
    for (int g = first; g < last; g++) {
        v4 sum = {0};
        for (int k = s->clusters.first[g]; k < s->clusters.first[g + 1]; k++) {
            v4f r;
            v4f_load(&r, s->single, s->clusters.member[k]);
            sum += __builtin_convertvector(r, v4);
        }
        memcpy(s->x + 3 * g, &sum, 3 * sizeof *s->x);
    }
}

static void move_groups(void *arg, int first, int last, int block) {
    (void)block;
    const struct groups *s = arg;
    for (int k = s->clusters.first[first]; k < s->clusters.first[last]; k++) {
        const double *x = s->x + 3 * s->clusters.of[s->clusters.member[k]];
        for (int a = 0; a < 3; a++) s->z[3 * (size_t)s->clusters.member[k] + a] += x[a];
    }
}

void groups_solve_single(struct groups *s, const float *r) {
    s->single = r, s->left--;
    pool_for(s->system->context->pool, s->clusters.count, GRAIN, sum_groups_single, s);
    skyline_solve(&s->a, s->x);
    for (int g = 0; g < s->clusters.count; g++)
        for (int a = 0; a < 3; a++) s->moved[4 * g + a] = (float)s->x[3 * g + a];
}

double groups_add(struct groups *s, const double *r, double *z) {
    struct pool *pool = s->system->context->pool;
    double rz = 0.0;
    if (!s->clusters.count) return 0.0;
    s->r = r, s->z = z, s->left--;
    pool_for(pool, s->clusters.count, GRAIN, sum_groups, s);
    memcpy(s->sum, s->x, 3 * (size_t)s->clusters.count * sizeof *s->x);
    skyline_solve(&s->a, s->x);
    for (int k = 0; k < 3 * s->clusters.count; k++) rz += s->sum[k] * s->x[k];
    pool_for(pool, s->clusters.count, GRAIN, move_groups, s);
    return rz;
}
