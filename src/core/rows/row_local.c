/* Rows: u = G x, projection, and the flux w (u - p), which goes back to the particles. */
#include "row_loops.h"

#include "base/registry.h"

WIDE static void gather_rows(const struct batch *b, int first, int last, const double *x) {
    for (int r = first; r < last; r++) {
        v4 u;
        gather_row(b, r, x, &u);
        memcpy((double *)b->view.u + 3 * (size_t)r, &u, 3 * sizeof(double));
    }
}

/* out += G' flux, by particles, so that threads write to different places */
WIDE static void scatter_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        v4 sum = {0};
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            v4 flux;
            memcpy(&flux, b->flux + 4 * (size_t)b->touch[t].row, sizeof flux);
            sum += b->touch[t].coefficient * flux;
        }
        v4_add_to(c->out + 3 * (size_t)(b->touch_first + i), &sum);
    }
}

void rows_scatter(struct batch *b, double *y) { rows_for_particles(b, scatter_rows, y); }

/* flux = w (u - p) in row r; adds twice the energy of the row. size: of the loads, four numbers, or
 * three in the last element of a block, since the next one may be of another thread. */
INLINE void set_flux(const struct batch *b, int r, double w, size_t size, v4 *energy) {
    v4 u = {0}, p = {0}, f; /* fourth lanes are undefined */
    memcpy(&u, b->view.u + 3 * (size_t)r, size);
    memcpy(&p, b->view.p + 3 * (size_t)r, size);
    u -= p;
    f = w * u;
    *energy += f * u;
    memcpy(b->flux + 4 * (size_t)r, &f, sizeof f);
}

INLINE void set_flux_of(struct batch *b, int first, int last, size_t size, v4 *energy) {
    const pdyn_batch *v = &b->view;
    for (int e = first; e < last; e++)
        if (b->single) set_flux(b, e, v->weight[e], size, energy);
        else
            for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++)
                set_flux(b, r, v->weight[e], size, energy);
}

/* flux of the elements [first, last). Returns their energy w/2 |u - p|^2. */
WIDE static double compute_flux(struct batch *b, int first, int last) {
    v4 energy = {0};
    set_flux_of(b, first, last - 1, sizeof energy, &energy);
    if (first < last) set_flux_of(b, last - 1, last, 3 * sizeof(double), &energy);
    return 0.5 * (energy[0] + energy[1] + energy[2]);
}

/* Works in pieces whose u, p and flux stay in the L1 cache. */
static void project_rows(void *arg, int first, int last, int block) {
    const struct row_loop *c = arg;
    struct batch *b = c->batch;
    const pdyn_batch *v = &b->view;
    double energy = 0.0;
    for (int e = first, end; e < last; e = end) {
        end = last - e > ROWS_PIECE ? e + ROWS_PIECE : last;
        gather_rows(b, v->element_row[e], v->element_row[end], c->in);
        b->type->project(b->params, v, e, end);
        double squares = compute_flux(b, e, end);
        energy += b->type->energy && !b->off ? b->type->energy(b->params, v, e, end) : squares;
    }
    b->partial[block] = energy;
}

double rows_project(struct batch *b, const double *x) {
    double energy = 0.0;
    rows_for_elements(b, project_rows, x);
    for (int k = 0; k < pool_blocks(b->view.elements, b->grain); k++) energy += b->partial[k];
    return energy;
}

/* ---- the beginning of a step ----------------------------------------------------------------- */

struct begin { /* the arguments of a parallel loop */
    struct batch *batch;
    const struct step_start *start;
};

/* u and the rest shape of a damper's elements [first, last) at x. */
static void set_rest_at(struct batch *b, int first, int last, const double *x) {
    gather_rows(b, b->view.element_row[first], b->view.element_row[last], x);
    b->type->damping_rest(b->params, &b->view, first, last);
}

/* value + part (value - before), of the sign of value: a length stays one */
static double extrapolate(double value, double before, double part) {
    double next = value + part * (value - before);
    return next * value > 0.0 ? next : 0.0;
}

/* Rest shapes are extrapolated, not positions: the extrapolated positions of a rotating element are
 * too long, and a stiff damper would give them energy in every step. */
static void set_damper_rest(void *arg, int first, int last, int block) {
    (void)block;
    const struct begin *c = arg;
    struct batch *b = c->batch;
    double before[DAMPED_DATA_MAX], part = b->view.extrapolation;
    int size = (int)(b->type->data_size / sizeof *before),
        step = DAMPED_DATA_MAX / (size > 0 ? size : 1);
    for (int e = first, end; e < last; e = end) {
        end = last - e > step ? e + step : last;
        double *data = (double *)b->view.data + (size_t)e * (size_t)size;
        int numbers = (end - e) * size;
        if (part > 0.0) set_rest_at(b, e, end, c->start->x_before);
        memcpy(before, data, (size_t)numbers * sizeof *before);
        set_rest_at(b, e, end, c->start->x);
        for (int k = 0; part > 0.0 && k < numbers; k++)
            data[k] = extrapolate(data[k], before[k], part);
    }
}

static void weigh_damper(void *arg, int first, int last, int block) {
    (void)block;
    struct batch *b = arg;
    double part = b->type->damping(b->params) / b->view.h;
    rows_weigh(b, first, last);
    for (int e = first; e < last; e++) b->view.weight[e] *= part;
}

/* u = G x and p = G v */
static void gather_start(void *arg, int first, int last, int block) {
    (void)block;
    const struct begin *c = arg;
    struct batch *b = c->batch;
    int row = b->view.element_row[first], end = b->view.element_row[last];
    gather_rows(b, row, end, c->start->v_base);
    memcpy(b->view.p + 3 * (size_t)row, b->view.u + 3 * (size_t)row,
           3 * (size_t)(end - row) * sizeof(double));
    gather_rows(b, row, end, c->start->x_base);
}

/* Begins the step of the elements [first, last) and computes weights that may change in steps.
 * Returns whether one of these changes. */
static bool begin_elements(struct batch *b, int first, int last) {
    enum { GROUP = 64 };
    double before[GROUP];
    bool changes = false;
    for (int e = first; e < last; e += GROUP) {
        int end = last - e > GROUP ? e + GROUP : last;
        size_t bytes = (size_t)(end - e) * sizeof *before;
        memcpy(before, b->view.weight + e, bytes); /* begin may write weights */
        b->type->begin(b->params, &b->view, e, end);
        if (type_weighs_in_steps(b->type)) rows_weigh(b, e, end);
        changes |= memcmp(before, b->view.weight + e, bytes) != 0;
    }
    return changes;
}

static void begin_rows(void *arg, int first, int last, int block) {
    struct batch *b = arg;
    b->partial[block] = begin_elements(b, first, last);
}

void rows_begin_damper(struct batch *b, const struct step_start *start) {
    struct pool *pool = b->context->pool;
    pool_for(pool, b->view.elements, b->grain, set_damper_rest, &(struct begin){b, start});
    pool_for(pool, b->view.elements, b->grain, weigh_damper, b);
}

void rows_begin(struct batch *b, const struct step_start *start) {
    struct pool *pool = b->context->pool;
    pool_for(pool, b->view.elements, b->grain, gather_start, &(struct begin){b, start});
    pool_for(pool, b->view.elements, b->grain, begin_rows, b);
    b->weights_change = b->type->update != NULL;
    for (int k = 0; k < pool_blocks(b->view.elements, b->grain); k++)
        b->weights_change |= b->partial[k] != 0.0;
}
