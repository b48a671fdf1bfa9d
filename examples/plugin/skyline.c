/* A global solver: Cholesky factorisation of the assembled matrix in skyline storage, which keeps
 * of each row all entries from the first nonzero to the diagonal (Jennings 1966; George and Liu
 * 1981, section 4.2). Efficient if neighbours have similar indices, as in a grid. */
#include <projdyn/module.h>

#include <math.h>
#include <string.h>

struct skyline {
    pdyn_model *model;
    int size;
    unsigned pattern, values; /* revisions of the factored matrix */
    int *first;               /* size: first column of each row */
    size_t *start;            /* size + 1: row i is L[start[i]] to L[start[i + 1] - 1] */
    double *L;
};

static void *resize(struct skyline *s, void *array, size_t old_bytes, size_t bytes) {
    return s->model->services->allocate(s->model->services->core, array, old_bytes, bytes);
}

static void release_rows(struct skyline *s) {
    size_t n = (size_t)s->size;
    if (s->start) s->L = (double *)resize(s, s->L, s->L ? s->start[n] * sizeof *s->L : 0, 0);
    s->first = (int *)resize(s, s->first, s->first ? n * sizeof *s->first : 0, 0);
    s->start = (size_t *)resize(s, s->start, s->start ? (n + 1) * sizeof *s->start : 0, 0);
}

static void release(void *self) {
    struct skyline *s = (struct skyline *)self;
    if (s->model) release_rows(s);
}

static pdyn_status create(void *self, pdyn_model *model) {
    ((struct skyline *)self)->model = model;
    return PDYN_OK;
}

/* Computes the extent of each row and allocates the factor. */
static pdyn_status allocate_rows(struct skyline *s, const pdyn_matrix *m) {
    size_t n = (size_t)m->size;
    release_rows(s);
    s->size = m->size;
    s->first = (int *)resize(s, NULL, 0, n * sizeof *s->first);
    s->start = (size_t *)resize(s, NULL, 0, (n + 1) * sizeof *s->start);
    if (!s->first || !s->start) return PDYN_NO_MEMORY;
    for (int i = 0; i < m->size; i++) s->first[i] = i;
    for (int c = m->size - 1; c >= 0; c--)
        for (int k = m->start[c]; k < m->start[c + 1]; k++)
            if (m->row[k] > c) s->first[m->row[k]] = c;
    for (int i = 0; i < m->size; i++) s->start[i + 1] = s->start[i] + (size_t)(i - s->first[i]) + 1;
    s->L = (double *)resize(s, NULL, 0, s->start[n] * sizeof *s->L);
    return s->L ? PDYN_OK : PDYN_NO_MEMORY;
}

/* row(s, i)[j] is entry (i, j). */
static double *row(const struct skyline *s, int i) { return s->L + s->start[i] - s->first[i]; }

/* H = L L', row by row */
static pdyn_status factor(struct skyline *s, const pdyn_matrix *m) {
    memset(s->L, 0, s->start[m->size] * sizeof *s->L);
    for (int c = 0; c < m->size; c++)
        for (int k = m->start[c]; k < m->start[c + 1]; k++)
            if (m->row[k] >= c) row(s, m->row[k])[c] = m->value[k];
    for (int i = 0; i < m->size; i++) {
        double *Li = row(s, i);
        for (int j = s->first[i]; j <= i; j++) {
            const double *Lj = row(s, j);
            int from = s->first[i] > s->first[j] ? s->first[i] : s->first[j];
            for (int k = from; k < j; k++) Li[j] -= Li[k] * Lj[k];
            if (j < i) Li[j] /= Lj[j];
        }
        if (!(Li[i] > 0.0))
            return s->model->services->set_error(s->model->services->core, PDYN_SOLVER_FAILED,
                                                 "skyline: H is not positive definite");
        Li[i] = sqrt(Li[i]);
    }
    return PDYN_OK;
}

/* y = (L L')^-1 b for right-hand side a of `copies` interleaved ones. */
static void substitute(const struct skyline *s, const double *b, double *y, int copies, int a) {
    for (int i = 0; i < s->size; i++) {
        const double *L = row(s, i);
        double sum = b[copies * i + a];
        for (int k = s->first[i]; k < i; k++) sum -= L[k] * y[copies * k + a];
        y[copies * i + a] = sum / L[i];
    }
    for (int i = s->size - 1; i >= 0; i--) {
        const double *L = row(s, i);
        y[copies * i + a] /= L[i];
        for (int k = s->first[i]; k < i; k++) y[copies * k + a] -= L[k] * y[copies * i + a];
    }
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct skyline *s = (struct skyline *)self;
    pdyn_matrix m;
    (void)stop;
    pdyn_status status = s->model->matrix(s->model, &m);
    if (status == PDYN_OK && (!s->L || s->pattern != m.pattern)) status = allocate_rows(s, &m);
    if (status == PDYN_OK && s->values != m.values) status = factor(s, &m);
    if (status != PDYN_OK) return status;
    s->pattern = m.pattern, s->values = m.values, *iterations = 1;
    for (int a = 0; a < 3 / m.dim; a++) substitute(s, b, y, 3 / m.dim, a);
    memset(b, 0, 3 * (size_t)s->model->particles * sizeof *b); /* the residual is rounding */
    return PDYN_OK;
}

static const pdyn_global_solver solver = {
    .name = "skyline",
    .summary = "a Cholesky factor that keeps the rows' envelopes; for small grids",
    .direct = true,
    .state_size = sizeof(struct skyline),
    .create = create,
    .solve = solve,
    .free = release,
};

static const pdyn_global_solver *const solvers[] = {&solver, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "skyline", NULL, solvers};
