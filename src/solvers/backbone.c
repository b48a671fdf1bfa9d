#include "backbone.h"

#include <math.h>

/* A step that differs from that of the factor by more than this ratio is what another factor would
 * help; that pays after about as many iterations. */
static const double same_step = 1.5;
enum { WORTH_FACTOR = 30 };

/* Rows of more than two particles that hold none of them in place are left out where they make up
 * at most so much of A's trace beside others like them: A is then too soft for the roughest motions
 * by about as much. */
static const double little = 0.3;

pdyn_status backbone_create(struct backbone *s, struct system *system) {
    s->system = system;
    factor_start(&s->factor, system->context, true);
    s->rows = NEW_ARRAY(system->context, system->batches, struct batch *);
    s->t = NEW_ARRAY(system->context, 4 * (size_t)system->particles, float);
    return (!system->batches || s->rows) && s->t ? PDYN_OK : PDYN_NO_MEMORY;
}

void backbone_free(struct backbone *s) {
    if (!s->system) return;
    matrix_free(&s->matrix);
    factor_free(&s->factor);
    FREE_ARRAY(s->system->context, s->rows, s->system->batches);
    FREE_ARRAY(s->system->context, s->t, 4 * (size_t)s->system->particles);
}

/* ---- the matrix ------------------------------------------------------------------------------ */

/* What the rows of a batch put on the diagonal of A for the i-th particle that they touch. */
static double diagonal_of(const struct batch *b, int i) {
    double sum = 0.0;
    for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
        const struct touch *at = &b->touch[t];
        sum += b->view.weight[b->entry_element[at->entry]] * at->coefficient * at->coefficient;
    }
    return sum;
}

/* Its rows are not indifferent to moving all of their particles alike. */
static bool holds_particles(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    for (int r = 0; r < b->rows; r++) {
        double sum = 0.0, size = 0.0;
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
            sum += v->coefficient[k], size += fabs(v->coefficient[k]);
        if (fabs(sum) > 1e-6 * size) return true;
    }
    return false;
}

/* diagonal: of A, particles, from all batches that hold none of these. */
static bool adds_little(const struct batch *b, const double *diagonal) {
    double trace = 0.0, all = 0.0;
    if (b->entries <= 2 * b->rows || holds_particles(b)) return false;
    for (int i = 0; i < b->touch_count; i++) {
        double own = diagonal_of(b, i);
        if (own > 0.0) trace += own, all += diagonal[b->touch_first + i];
    }
    return trace <= little * (all - trace);
}

/* *other: other batches are in A than before. */
static pdyn_status choose_rows(struct backbone *s, bool *other) {
    struct system *sys = s->system;
    double *diagonal = NEW_ARRAY(sys->context, sys->particles, double);
    if (!diagonal) return PDYN_NO_MEMORY;
    for (int b = 0; b < sys->batches; b++) {
        const struct batch *batch = sys->batch[b];
        if (holds_particles(batch)) continue;
        for (int i = 0; i < batch->touch_count; i++)
            diagonal[batch->touch_first + i] += diagonal_of(batch, i);
    }
    *other = !s->matrix.particles;
    for (int b = 0; b < sys->batches; b++) {
        struct batch *kept = adds_little(sys->batch[b], diagonal) ? NULL : sys->batch[b];
        *other |= kept != s->rows[b];
        s->rows[b] = kept;
    }
    FREE_ARRAY(sys->context, diagonal, sys->particles);
    return PDYN_OK;
}

/* ---- the factor ------------------------------------------------------------------------------ */

static void weigh(struct system *sys, double h) {
    sys->h = h;
    for (int b = 0; b < sys->batches; b++) batch_weigh(sys->batch[b], h);
}

/* A for steps of length h; *other: its pattern is not that of before. */
static pdyn_status fill_matrix(struct backbone *s, double h, bool *other) {
    struct system *sys = s->system;
    double now = sys->h;
    weigh(sys, h);
    pdyn_status status = choose_rows(s, other);
    if (status == PDYN_OK && *other) status = matrix_pattern(&s->matrix, sys, s->rows, 1);
    if (status == PDYN_OK) matrix_values(&s->matrix, sys, s->rows);
    weigh(sys, now);
    return status;
}

static pdyn_status make_factor(struct backbone *s, double h) {
    bool other;
    pdyn_status status = fill_matrix(s, h, &other);
    if (status == PDYN_OK && other) status = factor_analyse(&s->factor, &s->matrix, true);
    if (status == PDYN_OK) status = factor_numbers(&s->factor, &s->matrix);
    s->h = s->made = h;
    return status;
}

static bool is_strange(const struct backbone *s) {
    double h = s->system->h;
    return fmax(h / s->h, s->h / h) > same_step;
}

pdyn_status backbone_update(struct backbone *s) {
    bool other = s->h == 0.0 || (is_strange(s) && s->strange >= WORTH_FACTOR);
    if (other) s->strange = 0;
    if (!other && s->made == s->h) return PDYN_OK;
    return make_factor(s, other ? s->system->h : s->h);
}

void backbone_note(struct backbone *s, int iterations) {
    if (is_strange(s)) s->strange += iterations;
}

void backbone_persist(struct backbone *s, pdyn_archive *archive) {
    archive->bytes(archive, &s->h, sizeof s->h);
    archive->bytes(archive, &s->strange, sizeof s->strange);
}

void backbone_solve(struct backbone *s, const float *r, float *z) {
    factor_solve_single(&s->factor, r, z);
}

double backbone_add(struct backbone *s, const double *r, double *z) {
    double sum = 0.0;
    int n = s->system->particles;
    for (int i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) s->t[4 * (size_t)i + a] = (float)r[3 * i + a];
    backbone_solve(s, s->t, s->t);
    for (int i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) {
            double t = (double)s->t[4 * (size_t)i + a];
            z[3 * i + a] += t, sum += r[3 * i + a] * t;
        }
    return sum;
}
