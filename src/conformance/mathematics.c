/* Checks of a type's projection, tangent, energy and Hessian: by their definitions and by finite
 * differences. */
#include "conformance.h"
#include "rows/eigen.h"
#include "rows/numeric_tangent.h"

#include <math.h>
#include <string.h>

/* Tangents are compared for up to PROBES elements of at most 12 rows (36 numbers). */
enum { MAX_NUMBERS = TANGENT_NUMBERS_MAX, PROBES = 100 };

static double *u_of(const struct batch *b) { return (double *)b->view.u; }

static size_t point_bytes(const struct batch *b) { return 3 * (size_t)b->rows * sizeof(double); }

/* A bound of the rounding error of the energy at u, J: where no element pulls, u and p differ by
 * rounding, and so do energy and force from 0. 0: of an operator, or u is not computed. */
static double rounding_of(const struct batch *b) {
    double sum = 0.0;
    for (int e = 0; e < b->view.elements && !b->op && !b->linear; e++) {
        int first = 3 * b->view.element_row[e], n = 3 * b->view.element_row[e + 1] - first;
        sum += b->view.weight[e] * trial_dot(b->view.u + first, b->view.u + first, n);
    }
    return 1e-14 * sum;
}

/* ---- projection ------------------------------------------------------------------------------ */

/* project(project(u)) = project(u), to 1e-6. Not required of matrix-free types, whose rows may
 * project to the linearised constraint, and of types with an energy E of their own, whose
 * p = u - dE/du / w is the end of a step along the gradient (check_gradient checks it). */
void check_projection(struct check *check, struct trial *t) {
    struct batch *b = t->rows;
    size_t bytes = point_bytes(b);
    if (check->type->matrix_free || check->type->energy) return;
    batch_local(b, t->x, t->y);
    double *once = NEW_ARRAY(t->context, 3 * (size_t)b->rows, double);
    if (!once) return;
    memcpy(once, b->view.p, bytes), memcpy(u_of(b), once, bytes);
    check->type->project(b->params, &b->view, 0, b->view.elements);
    double moved = trial_distance(once, b->view.p, 3 * b->rows);
    double size = 1e-9 + trial_norm(once, 3 * b->rows);
    if (moved > 1e-6 * size)
        fault(check, "project is no projection: projecting p moves it by %.3g of %.3g", moved,
              size);
    FREE_ARRAY(t->context, once, 3 * (size_t)b->rows);
}

/* The largest distance of p of an element to `closest`, over |u - closest|; rounding does not
 * count.
 */
static double largest_move(const struct batch *b, const double *u, const double *closest) {
    double largest = 0.0;
    for (int e = 0; e < b->view.elements; e++) {
        int first = 3 * b->view.element_row[e], n = 3 * b->view.element_row[e + 1] - first;
        double moved = trial_distance(closest + first, b->view.p + first, n);
        double pulled = trial_distance(closest + first, u + first, n);
        if (moved > 1e-9 * trial_norm(u + first, n)) largest = fmax(largest, moved / pulled);
    }
    return largest;
}

/* Reports a point between u and its closest point p that has another closest point. */
static void compare_between(struct check *check, struct batch *b, const double *u,
                            const double *closest) {
    static const double part[] = {0.97, 0.9, 0.5};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3 * b->rows; i++) u_of(b)[i] = u[i] + part[k] * (closest[i] - u[i]);
        check->type->project(b->params, &b->view, 0, b->view.elements);
        double moved = largest_move(b, u, closest);
        if (moved <= 0.05) continue;
        fault(check,
              "project is no projection to the closest point: u and u + %g (p - u) go to points "
              "that are %.3g |u - p| apart",
              part[k], moved);
        return;
    }
}

/* All points between u and its closest point p have the same closest point p, to 5 % of |u - p|: an
 * iterative projection gives it to second order only. Not required of matrix-free types, as above,
 * and of types with an energy of their own, whose p is another point. */
void check_closest(struct check *check, struct trial *t) {
    struct batch *b = t->rows;
    size_t n = 3 * (size_t)b->rows;
    if (check->type->matrix_free || check->type->energy) return;
    batch_local(b, t->x, t->y);
    double *u = NEW_ARRAY(t->context, n, double), *closest = NEW_ARRAY(t->context, n, double);
    if (u && closest) {
        memcpy(u, b->view.u, n * sizeof *u), memcpy(closest, b->view.p, n * sizeof *u);
        compare_between(check, b, u, closest);
    }
    FREE_ARRAY(t->context, u, n);
    FREE_ARRAY(t->context, closest, n);
}

/* PDYN_ONE_SIDED: an element that pulls at u has slack a little beyond p. Elements that come and go
 * may project where they have no slack, because they do not exist there. With an energy of its own,
 * p need not reach the shapes without force. */
void check_one_side(struct check *check, struct trial *t) {
    struct batch *b = t->rows;
    double *u = u_of(b), beyond = 1e-3;
    const pdyn_constraint_type *type = check->type;
    if (!type_is_one_sided(type, b->params) || type->update || type->matrix_free || type->energy)
        return;
    batch_local(b, t->x, t->y);
    double pulled = trial_distance(u, b->view.p, 3 * b->rows);
    for (int k = 0; k < 3 * b->rows; k++) u[k] = b->view.p[k] + beyond * (b->view.p[k] - u[k]);
    check->type->project(b->params, &b->view, 0, b->view.elements);
    double rounding = 1e-12 * trial_norm(u, 3 * b->rows);
    if (trial_distance(u, b->view.p, 3 * b->rows) > 0.1 * beyond * pulled + rounding)
        fault(check, "it pulls on both sides of p, although it says PDYN_ONE_SIDED or one_sided");
}

/* Whether element e pulls: |u - p| is more than rounding. */
static bool pulls(const struct batch *b, int e) {
    int first = 3 * b->view.element_row[e], n = 3 * b->view.element_row[e + 1] - first;
    const double *u = b->view.u + first;
    return trial_distance(u, b->view.p + first, n) > 1e-12 * trial_norm(u, n);
}

/* Counts the elements that pull at x. */
void check_activity(struct check *check, struct trial *t) {
    const struct batch *b = t->rows;
    batch_local(t->rows, t->x, t->y);
    check->found += b->view.elements;
    if (b->linear) check->active += b->energy > 0.0; /* p = 0; u is not computed */
    for (int e = 0; e < b->view.elements && !b->linear; e++) check->active += pulls(b, e);
}

/* After damping_rest, u is its own projection. */
void check_damping_rest(struct check *check, struct trial *t) {
    struct batch *b = t->rows;
    if (!check->type->damping_rest) return;
    batch_local(b, t->x, t->y);
    check->type->damping_rest(b->params, &b->view, 0, b->view.elements);
    check->type->project(b->params, &b->view, 0, b->view.elements);
    double moved = trial_distance(b->view.u, b->view.p, 3 * b->rows);
    double size = trial_norm(b->view.u, 3 * b->rows);
    if (!(moved <= 1e-9 * size))
        fault(check, "after damping_rest, u is not its own projection: it moves by %.3g of %.3g",
              moved, size);
}

/* ---- tangent --------------------------------------------------------------------------------- */

/* Returns a fault of J, n x n, as text: not symmetric, an eigenvalue outside of [0, 1];
 * NULL: none. */
static const char *tangent_fault(const double *J, int n) {
    double copy[MAX_NUMBERS * MAX_NUMBERS], value[MAX_NUMBERS], vector[MAX_NUMBERS * MAX_NUMBERS];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            if (fabs(J[i * n + j] - J[j * n + i]) > 1e-9) return "tangent gives an asymmetric J";
    memcpy(copy, J, (size_t)(n * n) * sizeof *J);
    eigen_symmetric(copy, n, value, vector);
    for (int k = 0; k < n; k++)
        if (value[k] < -1e-9 || value[k] > 1.0 + 1e-9)
            return "tangent gives a J with an eigenvalue outside of [0, 1]: clamp it";
    return NULL;
}

/* J of element e, n x n, from tangent, tangent_rank1 or differences. */
static void tangent_of(const pdyn_constraint_type *type, const struct batch *b, int e, int n,
                       double *J) {
    double axis[MAX_NUMBERS + 1];
    memset(J, 0, (size_t)(n * n) * sizeof *J);
    if (type->tangent) type->tangent(b->params, &b->view, e, e + 1, J);
    if (type->flags & PDYN_NUMERIC_TANGENT) tangent_numeric(b, e, J);
    if (!type->tangent_rank1) return;
    type->tangent_rank1(b->params, &b->view, e, e + 1, axis);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) J[n * i + j] = (i == j ? axis[n] : 0.0) - axis[i] * axis[j];
}

static void report_tangent(struct check *check, double error, int wrong, int compared, int acts) {
    const char *where = acts ? "pull" : "have slack";
    if (check->type->flags & PDYN_NUMERIC_TANGENT)
        fault(check,
              "project is too rough for PDYN_NUMERIC_TANGENT: with a tenth of the step of its "
              "differences, J differs by up to %.3g in %d of %d elements that %s",
              error, wrong, compared, where);
    else
        fault(check,
              "tangent is not that of project: by finite differences, clamped to [0, 1], J "
              "differs by up to %.3g in %d of %d elements that %s",
              error, wrong, compared, where);
}

/* J = dp/du by finite differences, to 0.02, among the elements that pull and among those that do
 * not. One element in five may differ: a projection may have a kink at u. With PDYN_NUMERIC_TANGENT
 * that compares differences of two steps, which shows a projection that iterates to few digits.
 * Not compared: rows of an operator, whose J is that of the linearised constraint (check_tiers
 * compares H). */
void check_tangent(struct check *check, struct trial *t) {
    struct batch *b = t->rows;
    double J[MAX_NUMBERS * MAX_NUMBERS], D[MAX_NUMBERS * MAX_NUMBERS], worst[2] = {0.0};
    int elements = b->view.elements, compared[2] = {0}, wrong[2] = {0};
    if (!type_has_tangent(check->type)) return;
    batch_local(b, t->x, t->y);
    for (int k = 0; k < PROBES && k < elements; k++) {
        int e = (int)((long)k * elements / (elements < PROBES ? elements : PROBES));
        int n = 3 * (b->view.element_row[e + 1] - b->view.element_row[e]), acts = pulls(b, e);
        if (n > MAX_NUMBERS || b->view.weight[e] == 0.0) continue; /* 0: J has no effect */
        tangent_of(check->type, b, e, n, J);
        const char *why = tangent_fault(J, n);
        if (why) {
            fault(check, "%s (element %d)", why, e);
            return;
        }
        if (check->type->matrix_free) continue;
        tangent_difference(b, e, 1e-6, D);
        tangent_clamp(D, n);
        double error = trial_distance(J, D, n * n);
        compared[acts]++, wrong[acts] += error > 0.02, worst[acts] = fmax(worst[acts], error);
    }
    for (int acts = 0; acts < 2; acts++)
        if (5 * wrong[acts] > compared[acts])
            report_tangent(check, worst[acts], wrong[acts], compared[acts], acts);
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* The gradient G' w (u - p) is the derivative of the energy along a direction, to 2 %, far from
 * rest to 30 %: an iterative projection gives the closest point to second order only. */
void check_gradient(struct check *check, struct trial *t) {
    double slope = 0.0, h = 1e-6, tolerance = check->strain == CRUMPLED ? 0.3 : 0.02;
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < t->n; k++) t->w[k] = t->x[k] + sign * h * t->u[k];
        batch_local(t->batch, t->w, t->y);
        slope += sign * t->batch->energy / (2.0 * h);
    }
    memset(t->y, 0, (size_t)t->n * sizeof *t->y);
    batch_local(t->batch, t->x, t->y);
    double expected = trial_dot(t->y, t->u, t->n);
    double rounding = 1e-7 * trial_norm(t->y, t->n) + rounding_of(t->batch) / h;
    if (!(fabs(slope - expected) <= tolerance * fabs(expected) + rounding))
        fault(check,
              "the gradient w (u - p) is not that of the energy: the energy's slope is %.6g, the "
              "gradient's %.6g; p is not the closest point, or energy is wrong",
              slope, expected);
}

/* The change of the energy from the rest shape to x is the work of the gradient on the way, to 10 %
 * (an iterative projection gives the closest point to second order only) and a part of a step: the
 * energy does not jump. */
void check_work(struct check *check, struct trial *t) {
    enum { STEPS = 200 };
    double work = 0.0, first = 0.0, largest = 0.0, part = 0.0;
    for (int k = 0; k < t->n; k++) t->w[k] = t->x[k] - t->sim->x[k];
    for (int step = 0; step <= STEPS; step++) {
        for (int k = 0; k < t->n; k++) t->z[k] = t->sim->x[k] + step * (t->w[k] / STEPS);
        memset(t->y, 0, (size_t)t->n * sizeof *t->y);
        if (batch_local(t->batch, t->z, t->y) != PDYN_OK) return;
        double slope = trial_dot(t->y, t->w, t->n) / STEPS;
        work += step % STEPS ? slope : 0.5 * slope;
        if (!step) first = t->batch->energy;
        largest = fmax(largest, fabs(t->batch->energy)), part = fmax(part, fabs(slope));
    }
    double change = t->batch->energy - first, rounding = rounding_of(t->batch);
    if (!(fabs(change - work) <= 0.1 * largest + 0.2 * part + rounding))
        fault(
            check,
            "from the rest shape to the trial the energy changes by %.6g J, which is not the work "
            "of w (u - p), %.6g J: the energy jumps, or p is not the closest point",
            change, work);
}

/* The first row whose coefficients do not sum to zero, and the sum; -1: none. */
static int find_anchored_row(const struct batch *b, double *sum) {
    const pdyn_batch *v = &b->view;
    for (int r = 0; r < b->rows; r++) {
        double size = 0.0;
        *sum = 0.0;
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
            *sum += v->coefficient[k], size += fabs(v->coefficient[k]);
        if (fabs(*sum) > 1e-12 * size) return r;
    }
    return -1;
}

static void report_momentum(struct check *check, const struct batch *rows, double force) {
    double sum;
    int row = find_anchored_row(rows, &sum);
    if (row < 0)
        fault(check, "its forces do not sum to zero, but to %.3g N: say PDYN_ANCHORED", force);
    else
        fault(
            check,
            "its forces do not sum to zero, but to %.3g N, because the coefficients of row %d sum "
            "to %.3g: say PDYN_ANCHORED if it holds a body in place, otherwise they should sum "
            "to 0",
            force, row, sum);
}

/* The forces of a type without PDYN_ANCHORED sum to zero. */
void check_momentum(struct check *check, struct trial *t) {
    double sum[3] = {0};
    if (check->type->flags & PDYN_ANCHORED) return;
    memset(t->y, 0, (size_t)t->n * sizeof *t->y);
    batch_local(t->batch, t->x, t->y);
    for (int k = 0; k < t->n; k++) sum[k % 3] += t->y[k];
    if (!(trial_norm(sum, 3) <= 1e-9 * sqrt(t->n) * trial_norm(t->y, t->n)))
        report_momentum(check, t->rows, trial_norm(sum, 3));
}

/* ---- H --------------------------------------------------------------------------------------- */

/* H is symmetric, at least M/h^2, and does not decrease with eps. */
void check_bounds(struct check *check, struct trial *t) {
    struct objective *objective = &t->sim->objective;
    uint64_t seed = 99;
    double last = 0.0;
    for (int k = 0; k < t->n; k++) last += objective_inertia(objective, k / 3) * t->u[k] * t->u[k];
    for (int k = 0; k <= 4; k++) {
        if (objective_linearise(objective, 0.25 * k) != PDYN_OK) return;
        for (int i = 0; i < t->n; i++) t->z[i] = trial_random(&seed);
        objective_apply(objective, t->u, t->y), objective_apply(objective, t->z, t->w);
        double zHu = trial_dot(t->z, t->y, t->n), uHz = trial_dot(t->u, t->w, t->n);
        if (!(fabs(zHu - uHz) <= 1e-10 * trial_norm(t->y, t->n) * trial_norm(t->z, t->n))) {
            fault(check, "H is not symmetric: z.H u = %.10g, u.H z = %.10g", zHu, uHz);
            return;
        }
        double quadratic = trial_dot(t->u, t->y, t->n);
        if (!(quadratic >= last * (1.0 - 1e-12))) {
            fault(check, "H is not above M/h^2, or falls with the damping: u.H u = %.6g after %.6g",
                  quadratic, last);
            return;
        }
        last = quadratic;
    }
}

/* The block diagonal is that of the product with unit vectors. */
void check_diagonal(struct check *check, struct trial *t) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    if (objective_linearise(&t->sim->objective, 0.3) != PDYN_OK) return;
    objective_diagonal(&t->sim->objective, PDYN_WHOLE, t->da);
    for (int i = 0; i < t->n; i++) {
        memset(t->z, 0, (size_t)t->n * sizeof *t->z);
        t->z[i] = 1.0;
        objective_apply(&t->sim->objective, t->z, t->y);
        for (int b = 0; b < 6; b++)
            if (column[b] == i % 3 &&
                !(fabs(t->y[i / 3 * 3 + row[b]] - t->da[i / 3 * 6 + b]) <= 1e-10 * fabs(t->y[i]))) {
                fault(check, "the block diagonal is not that of the product, at particle %d",
                      i / 3);
                return;
            }
    }
}
