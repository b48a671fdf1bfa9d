/* The matrix of the motions of rigid bodies: blocks from H, its factor, and the solve. */
#include "rigid_matrix.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

enum { SIZE = RIGID_SIZE, BLOCK = RIGID_BLOCK };
enum { MAX_ITERATIONS = 500 };

/* Reduction of the residual in the norm of the preconditioner: exact beside the solve of a fluid.
 */
static const double tolerance = 1e-10;

/* ---- creation -------------------------------------------------------------------------------- */

static bool resize(struct rigid_matrix *m, enum array_action action) {
    size_t n = SIZE * (size_t)m->map->bodies;
    const struct array_entry table[] = {
        ARRAY(m->body, m->map->bodies),
        ARRAY(m->x, n),
        ARRAY(m->r, n),
        ARRAY(m->p, n),
        ARRAY(m->q, n),
        ARRAY(m->z, n),
    };
    return context_arrays(m->map->context, table, ARRAY_ROWS(table), action);
}

pdyn_status rigid_matrix_create(const struct rigid_map *map, struct rigid_matrix **out) {
    struct rigid_matrix *m = *out = NEW_ARRAY(map->context, 1, struct rigid_matrix);
    if (!m) return PDYN_NO_MEMORY;
    m->map = map;
    return resize(m, ARRAYS_ALLOCATE) ? PDYN_OK : PDYN_NO_MEMORY;
}

void rigid_matrix_free(struct rigid_matrix *m) {
    if (!m) return;
    pdyn_context *c = m->map->context;
    resize(m, ARRAYS_FREE);
    FREE_ARRAY(c, m->pair, m->room);
    FREE_ARRAY(c, m, 1);
}

struct loop { /* the arguments of a parallel loop over bodies */
    const struct rigid_matrix *matrix;
    const double *in;
    double *out;
};

static void for_bodies(const struct rigid_matrix *m, pdyn_range_fn *fn, const double *in,
                       double *out) {
    struct loop loop = {m, in, out};
    pool_for(m->map->context->pool, m->map->bodies, RIGID_GRAIN, fn, &loop);
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* P += scale G_i' D G_j for particles with the arms ri and rj, G = (I, -[r]x); D: 3 x 3 */
static void add_block(double *P, double scale, const double *ri, const double *D,
                      const double *rj) {
    for (int c = 0; c < SIZE; c++) {
        double unit[3] = {0}, u[3], force[3], moment[3];
        unit[c % 3] = scale;
        if (c < 3) memcpy(u, unit, sizeof u);
        else vec3_cross(u, unit, rj);
        vec3_multiply(force, D, u);
        vec3_cross(moment, ri, force);
        for (int a = 0; a < 3; a++) P[SIZE * a + c] += force[a], P[SIZE * (3 + a) + c] += moment[a];
    }
}

static void add(double *P, const double *Q) {
    for (int k = 0; k < BLOCK; k++) P[k] += Q[k];
}

static void add_transposed(double *P, const double *Q) {
    for (int k = 0; k < BLOCK; k++) P[k] += Q[SIZE * (k % SIZE) + k / SIZE];
}

/* The block of bodies a < b; a new one is 0. NULL: no memory. */
static double *pair_block(struct rigid_matrix *m, int a, int b) {
    struct rigid_part *body = &m->body[a];
    for (int p = body->last_pair; p >= 0; p = m->pair[p].before)
        if (m->pair[p].b == b) return m->pair[p].block;
    struct rigid_pair *grown =
        context_grow(m->map->context, m->pair, &m->room, (size_t)m->pairs + 1, sizeof *grown);
    if (!grown) return NULL;
    m->pair = grown;
    grown[m->pairs] = (struct rigid_pair){.a = a, .b = b, .before = body->last_pair};
    body->last_pair = m->pairs;
    return grown[m->pairs++].block;
}

/* The arm of a particle of body b. */
static const double *arm_of(const struct rigid_body *b, int particle) {
    return b->arm + 3 * (size_t)(particle - b->first);
}

/* Adds the part of H between entries k and m of an element, which select particles of bodies. */
static pdyn_status couple_entries(struct rigid_matrix *matrix, const struct batch *batch, int k,
                                  int m) {
    const struct rigid_map *map = matrix->map;
    int i = batch->view.column[k], j = batch->view.column[m];
    int a = map->owner[i], b = map->owner[j];
    double D[9], P[BLOCK] = {0}, c = batch->view.coefficient[k] * batch->view.coefficient[m];
    if (i == j || c == 0.0) return PDYN_OK; /* of the block diagonal; nothing */
    batch_block(batch, k, m, D);
    add_block(P, c, arm_of(&map->body[a], i), D, arm_of(&map->body[b], j));
    double *to =
        a == b ? matrix->body[a].coupled : pair_block(matrix, a < b ? a : b, a < b ? b : a);
    if (!to) return PDYN_NO_MEMORY;
    if (a >= b) add_transposed(to, P);
    if (a <= b) add(to, P);
    return PDYN_OK;
}

static pdyn_status couple_element(struct rigid_matrix *matrix, const struct batch *batch, int e) {
    const int *owner = matrix->map->owner;
    const pdyn_batch *v = &batch->view;
    int first = v->row_entry[v->element_row[e]], last = v->row_entry[v->element_row[e + 1]];
    pdyn_status status = PDYN_OK;
    for (int k = first; k < last; k++) {
        bool owned = owner[v->column[k]] >= 0;
        matrix->closed &= owned || v->coefficient[k] == 0.0;
        for (int m = first; owned && m < k && status == PDYN_OK; m++)
            if (owner[v->column[m]] >= 0) status = couple_entries(matrix, batch, k, m);
    }
    return status;
}

pdyn_status rigid_matrix_couple(struct rigid_matrix *m, struct batch *const *batch, int batches) {
    pdyn_status status = PDYN_OK;
    m->closed = true, m->pairs = 0;
    for (int k = 0; k < m->map->bodies; k++) {
        m->body[k].last_pair = -1;
        memset(m->body[k].coupled, 0, sizeof m->body[k].coupled);
    }
    for (int b = 0; b < batches; b++) {
        if (!batch_comes_and_goes(batch[b])) continue;
        for (int e = 0; e < batch[b]->view.elements && status == PDYN_OK; e++)
            status = couple_element(m, batch[b], e);
    }
    return status;
}

/* L becomes the Cholesky factor of B, B = L L', in its lower triangle. */
static void factor(const double *B, double *L) {
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j <= i; j++) {
            double sum = B[SIZE * i + j];
            for (int k = 0; k < j; k++) sum -= L[SIZE * i + k] * L[SIZE * j + k];
            L[SIZE * i + j] = i == j ? sqrt(sum) : sum / L[SIZE * j + j];
        }
}

static void factor_bodies(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++) {
        const struct rigid_body *b = &c->matrix->map->body[k];
        struct rigid_part *part = &c->matrix->body[k];
        memcpy(part->block, part->coupled, sizeof part->block);
        for (int i = b->first; i < rigid_body_end(b); i++) {
            const double *p = c->in + 6 * (size_t)i, *r = arm_of(b, i);
            const double D[9] = {p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5]};
            add_block(part->block, 1.0, r, D, r);
        }
        factor(part->block, part->factor);
    }
}

void rigid_matrix_factor(struct rigid_matrix *m, const double *blocks) {
    for_bodies(m, factor_bodies, blocks, NULL);
}

/* ---- the solve ------------------------------------------------------------------------------- */

/* q becomes B^-1 q. */
static void substitute(const double *L, double *q) {
    for (int i = 0; i < SIZE; i++) {
        for (int k = 0; k < i; k++) q[i] -= L[SIZE * i + k] * q[k];
        q[i] /= L[SIZE * i + i];
    }
    for (int i = SIZE - 1; i >= 0; i--) {
        for (int k = i + 1; k < SIZE; k++) q[i] -= L[SIZE * k + i] * q[k];
        q[i] /= L[SIZE * i + i];
    }
}

/* y += B x, y += B' x for one block */
static void multiply(const double *B, const double *x, double *y) {
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) y[i] += B[SIZE * i + j] * x[j];
}

static void multiply_transposed(const double *B, const double *x, double *y) {
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) y[j] += B[SIZE * i + j] * x[i];
}

/* q = B p; returns p . q */
static double multiply_all(const struct rigid_matrix *m, const double *p, double *q) {
    double sum = 0.0;
    memset(q, 0, SIZE * (size_t)m->map->bodies * sizeof *q);
    for (int k = 0; k < m->map->bodies; k++) multiply(m->body[k].block, p + SIZE * k, q + SIZE * k);
    for (int k = 0; k < m->pairs; k++) {
        const struct rigid_pair *pair = &m->pair[k];
        multiply(pair->block, p + SIZE * pair->b, q + SIZE * pair->a);
        multiply_transposed(pair->block, p + SIZE * pair->a, q + SIZE * pair->b);
    }
    for (int k = 0; k < SIZE * m->map->bodies; k++) sum += p[k] * q[k];
    return sum;
}

/* p = P^-1 r + sum / before p with the diagonal blocks P of B; returns sum = r . P^-1 r. before:
 * the sum of the last direction; 0: there is none. */
static double turn_direction(const struct rigid_matrix *m, double before) {
    double *z = m->z, *p = m->p, sum = 0.0;
    int n = SIZE * m->map->bodies;
    memcpy(z, m->r, (size_t)n * sizeof *z);
    for (int k = 0; k < m->map->bodies; k++) substitute(m->body[k].factor, z + SIZE * k);
    for (int k = 0; k < n; k++) sum += z[k] * m->r[k];
    for (int k = 0; k < n; k++) p[k] = z[k] + (before > 0.0 ? sum / before * p[k] : 0.0);
    return sum;
}

/* x = B^-1 r */
static void solve_coupled(const struct rigid_matrix *m) {
    int size = SIZE * m->map->bodies;
    memset(m->x, 0, (size_t)size * sizeof *m->x);
    double rz = turn_direction(m, 0.0), end = tolerance * tolerance * rz;
    for (int n = 0; n < MAX_ITERATIONS && rz > end; n++) {
        double step = rz / multiply_all(m, m->p, m->q);
        for (int k = 0; k < size; k++) m->x[k] += step * m->p[k], m->r[k] -= step * m->q[k];
        rz = turn_direction(m, rz);
    }
}

static void gather(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++) {
        const struct rigid_body *b = &c->matrix->map->body[k];
        rigid_body_sum(b, b->vertices, c->in, c->matrix->r + SIZE * k);
    }
}

static void solve_alone(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    double *x = c->matrix->x;
    memcpy(x + SIZE * first, c->matrix->r + SIZE * first,
           SIZE * (size_t)(last - first) * sizeof *x);
    for (int k = first; k < last; k++) substitute(c->matrix->body[k].factor, x + SIZE * k);
}

static void spread(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++)
        rigid_body_move(&c->matrix->map->body[k], 0, c->matrix->x + SIZE * k, c->out);
}

void rigid_matrix_solve(const struct rigid_matrix *m, const double *r, double *z) {
    for_bodies(m, gather, r, NULL);
    if (m->pairs) solve_coupled(m);
    else for_bodies(m, solve_alone, NULL, NULL);
    for_bodies(m, spread, NULL, z);
}
