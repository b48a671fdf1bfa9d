/* Rows of a one-sided type: the part of their forces that stops an impact (one_sided.h). */
#include "rigid_map.h"
#include "row_loops.h"

#include "base/groups.h"
#include "projdyn/vec3.h"

#include <math.h>

struct impacts { /* the arguments of a parallel loop */
    struct batch *batch;
    const struct velocity_change *change;
};

static double yield_of(const struct velocity_change *change, int particle) {
    return change->yield ? change->yield[particle] : 1.0;
}

/* The sum of a row's coefficients; 0 where it joins particles alone: nothing else has a part in it.
 */
static double sum_of_row(const struct batch *b, int r) {
    double sum = 0.0, size = 0.0;
    for (int k = b->view.row_entry[r]; k < b->view.row_entry[r + 1]; k++)
        sum += b->view.coefficient[k], size += fabs(b->view.coefficient[k]);
    return fabs(sum) > 1e-9 * size ? sum : 0.0;
}

/* The rate of the length of a string before the step, m/s, along its direction then, less that of
 * the same velocities along its direction after the step. The string turns in the step: without
 * this difference the force that keeps a body on a circle would be an impact. The row of a string
 * always exists, has coefficients whose sum is 0, and a force along u. 0 for other rows. */
static double rate_by_turn(const struct batch *b, int r, const struct velocity_change *change,
                           const v4 *flux, const v4 *slowed) {
    v4 u = {0}, start, before;
    if (!batch_is_static(b) || sum_of_row(b, r) != 0.0) return 0.0;
    memcpy(&u, b->view.u + 3 * (size_t)r, 3 * sizeof(double));
    gather_row(b, r, change->start, &start), gather_row(b, r, change->after, &before);
    before += *slowed;
    double force = sqrt(v4_dot(flux, flux)), length = sqrt(v4_dot(&start, &start));
    double along = v4_dot(flux, &u) / (force * sqrt(v4_dot(&u, &u)));
    if (!(fabs(along) > 1.0 - 1e-9 && length > 0.0)) return 0.0;
    return along * v4_dot(&start, &before) / length - v4_dot(flux, &before) / force;
}

/* The acceleration along n by the force n on row r of the particle of entry k, times its
 * coefficient, 1/kg. The force moves a rigid body as a whole, by all entries of the body. With the
 * roots of their yields the sum of these accelerations is never negative. */
static double softness_at(const struct batch *b, int r, int k, const struct velocity_change *change,
                          const double *n) {
    const pdyn_batch *v = &b->view;
    const struct rigid_map *map = change->rigid;
    int i = v->column[k], body = map ? map->owner[i] : -1;
    double yield = yield_of(change, i), sum = 0.0;
    if (body < 0) return yield * v->coefficient[k] * v->coefficient[k] / change->mass[i];
    for (int m = v->row_entry[r]; m < v->row_entry[r + 1]; m++) {
        int j = v->column[m];
        if (map->owner[j] != body) continue;
        sum += sqrt(yield * yield_of(change, j)) * v->coefficient[k] * v->coefficient[m] *
               rigid_body_mobility(&map->body[body], i, j, n);
    }
    return sum;
}

/* The part of the force of row r that stops an impact. As in one_sided.c, the change of velocity
 * is the larger of two: by this row alone, and by all rows, because the contacts of a point share
 * the force that stops it. */
static double impact_of(const struct batch *b, int r, const struct velocity_change *change,
                        const v4 *flux) {
    const pdyn_batch *v = &b->view;
    v4 slowed, acceleration;
    double force = sqrt(v4_dot(flux, flux)), softness = 0.0, h = change->h;
    if (!(force > 0.0)) return 0.0;
    gather_row(b, r, change->slowed, &slowed);
    gather_row(b, r, change->acceleration, &acceleration);
    const double n[3] = {(*flux)[0] / force, (*flux)[1] / force, (*flux)[2] / force};
    for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
        softness += softness_at(b, r, k, change, n);
    double weight = v->weight[b->entry_element[v->row_entry[r]]];
    double all = v4_dot(flux, &acceleration) / force;
    double stopped = v4_dot(flux, &slowed) / force + rate_by_turn(b, r, change, flux, &slowed);
    return impact_part(stopped, h * fmax(all, force * softness), h * h * weight * softness);
}

/* Replaces the flux of each row by its impact part. */
static void keep_impact_parts(void *arg, int first, int last, int block) {
    const struct impacts *c = arg;
    struct batch *b = c->batch;
    double count = 0.0;
    for (int r = b->view.element_row[first]; r < b->view.element_row[last]; r++) {
        v4 flux;
        v4_load(&flux, b->flux, r);
        double part = impact_of(b, r, c->change, &flux);
        flux *= part;
        v4_store(b->flux, r, &flux);
        count += part > 0.5;
    }
    b->partial[block] = count;
}

void rows_keep_impacts(struct batch *b, const double *kept) {
    const pdyn_batch *v = &b->view;
    for (int r = 0; r < v->element_row[v->elements]; r++) {
        double sum = sum_of_row(b, r), part = 0.0;
        if (sum == 0.0) continue;
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
            part += v->coefficient[k] / sum * kept[v->column[k]];
        for (int a = 0; a < 3; a++) b->flux[4 * (size_t)r + (size_t)a] *= part;
    }
}

void rows_scatter_between(const struct batch *b, double *y) {
    const pdyn_batch *v = &b->view;
    for (int r = 0; r < v->element_row[v->elements]; r++) {
        if (sum_of_row(b, r) != 0.0) continue;
        for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
            vec3_add(y + 3 * (size_t)v->column[k], v->coefficient[k], b->flux + 4 * (size_t)r);
    }
}

void rows_join(const struct batch *b, int first, int last, int *group) {
    for (int k = b->view.row_entry[first] + 1; k < b->view.row_entry[last]; k++)
        if (b->entry_row[k] == b->entry_row[k - 1])
            groups_join(group, b->view.column[k - 1], b->view.column[k]);
}

void rows_join_between(const struct batch *b, int *group) {
    for (int r = 0; r < b->view.element_row[b->view.elements]; r++)
        if (vec3_length(b->flux + 4 * (size_t)r) > 0.0 && sum_of_row(b, r) == 0.0)
            rows_join(b, r, r + 1, group);
}

int rows_impacts(struct batch *b, const struct velocity_change *change, double *force) {
    struct impacts impacts = {b, change};
    double count = 0.0;
    pool_for(b->context->pool, b->view.elements, b->grain, keep_impact_parts, &impacts);
    for (int k = 0; k < pool_blocks(b->view.elements, b->grain); k++) count += b->partial[k];
    rows_scatter(b, force);
    return (int)count;
}
