#include "single_cg.h"

#include "blocks.h"

#include <math.h>
#include <string.h>

struct single_sums { /* of a block of particles */
    double rz, zq, rp, rr;
};

struct call {
    struct single_cg *s;
    const double *b;
    double *y;
    double scale; /* of what is added */
    bool coarse;
};

pdyn_status single_cg_create(struct single_cg *s, struct objective *objective,
                             struct jacobi *jacobi, struct coarse *coarse) {
    pdyn_context *c = objective->context;
    float **vector[] = {&s->r, &s->z, &s->p, &s->q};
    int blocks = pool_blocks(objective->particles, PARTICLE_GRAIN);
    bool good = true;
    s->objective = objective, s->jacobi = jacobi, s->coarse = coarse;
    for (size_t k = 0; k < sizeof vector / sizeof *vector; k++)
        good &= (*vector[k] = NEW_ARRAY(c, single_size(objective), float)) != NULL;
    s->inverse = NEW_ARRAY(c, 9 * (size_t)objective->particles + 1, float);
    s->sums = NEW_ARRAY(c, blocks, struct single_sums);
    good &= s->inverse && (!blocks || s->sums);
    return good ? single_create(&s->product, objective) : PDYN_NO_MEMORY;
}

void single_cg_free(struct single_cg *s) {
    if (!s->objective) return;
    pdyn_context *c = s->objective->context;
    float *vector[] = {s->r, s->z, s->p, s->q};
    for (size_t k = 0; k < sizeof vector / sizeof *vector; k++)
        FREE_ARRAY(c, vector[k], single_size(s->objective));
    FREE_ARRAY(c, s->inverse, 9 * (size_t)s->objective->particles + 1);
    FREE_ARRAY(c, s->sums, pool_blocks(s->objective->particles, PARTICLE_GRAIN));
    single_free(&s->product);
}

/* ---- passes over the particles --------------------------------------------------------------- */

static struct single_sums for_particles(struct single_cg *s, pdyn_range_fn *fn, struct call *call) {
    struct single_sums all = {0};
    call->s = s;
    pool_for(s->objective->context->pool, s->objective->particles, PARTICLE_GRAIN, fn, call);
    for (int k = 0; k < pool_blocks(s->objective->particles, PARTICLE_GRAIN); k++) {
        const struct single_sums *part = &s->sums[k];
        all.rz += part->rz, all.zq += part->zq, all.rp += part->rp, all.rr += part->rr;
    }
    return all;
}

INLINE void add_product(v4 *sum, const v4f *a, const v4f *b) {
    *sum += __builtin_convertvector(*a * *b, v4);
}

/* r = scale b, z = D^-1 r */
WIDE static void begin_single(void *arg, int first, int last, int block) {
    (void)block;
    static const int packed[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const struct call *c = arg;
    struct single_cg *s = c->s;
    for (int i = first; i < last; i++) {
        const double *D = s->jacobi->inverse + 6 * (size_t)i, *b = c->b + 3 * (size_t)i;
        for (int a = 0; a < 9; a++) s->inverse[9 * (size_t)i + (size_t)a] = (float)D[packed[a]];
        double scaled[3] = {b[0] * c->scale, b[1] * c->scale, b[2] * c->scale}, first_part[3];
        block_multiply(first_part, D, scaled);
        v4f r = {(float)scaled[0], (float)scaled[1], (float)scaled[2]};
        v4f z = {(float)first_part[0], (float)first_part[1], (float)first_part[2]};
        v4f_store(s->r, i, &r), v4f_store(s->z, i, &z);
    }
}

/* z += what particle i's nodes do */
INLINE void follow_nodes(const struct single_cg *s, int i, v4f *z) {
    const struct sparse *P = &s->coarse->p.particles;
    for (int k = P->start[i]; k < P->start[i + 1]; k++) {
        v4f node;
        v4f_load(&node, s->coarse->moved, P->entry[k].column);
        *z += P->entry[k].value * node;
    }
}

/* z = D^-1 r of particle i */
INLINE void divide_by_block(const struct single_cg *s, int i, const v4f *r, v4f *z) {
    v4f column[3];
    for (int a = 0; a < 3; a++)
        memcpy(&column[a], s->inverse + 9 * (size_t)i + 3 * a, sizeof column[a]);
    *z = (*r)[0] * column[0] + (*r)[1] * column[1] + (*r)[2] * column[2];
    (*z)[3] = 0.0F;
}

/* z += what its nodes do, if they do; sums: r.z, z.q, r.p */
WIDE static void end_coarse(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct single_cg *s = c->s;
    v4 rz = {0}, zq = {0}, rp = {0};
    for (int i = first; i < last; i++) {
        v4f r, z, p, q;
        v4f_load(&r, s->r, i), v4f_load(&z, s->z, i);
        v4f_load(&p, s->p, i), v4f_load(&q, s->q, i);
        if (c->coarse) follow_nodes(s, i, &z), v4f_store(s->z, i, &z);
        add_product(&rz, &r, &z), add_product(&zq, &z, &q), add_product(&rp, &r, &p);
    }
    s->sums[block] = (struct single_sums){.rz = v4_sum(&rz), .zq = v4_sum(&zq), .rp = v4_sum(&rp)};
}

/* p = z + scale p */
WIDE static void turn_single(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct single_cg *s = c->s;
    float scale = (float)c->scale;
    for (int i = first; i < last; i++) {
        v4f z, p;
        v4f_load(&z, s->z, i), v4f_load(&p, s->p, i);
        p = z + scale * p;
        v4f_store(s->p, i, &p);
    }
}

/* r -= scale q, y += |b| scale p, z = D^-1 r of particles first to last of one body; rr += r.r */
INLINE void advance(const struct call *c, int first, int last, v4 *rr) {
    struct single_cg *s = c->s;
    float scale = (float)c->scale;
    double length = s->length * c->scale;
    for (int i = first; i < last; i++) {
        v4f r, z, p, q;
        v4f_load(&r, s->r, i), v4f_load(&p, s->p, i), v4f_load(&q, s->q, i);
        r -= scale * q;
        divide_by_block(s, i, &r, &z);
        v4f_store(s->r, i, &r), v4f_store(s->z, i, &z);
        add_product(rr, &r, &r);
        v4 step = length * __builtin_convertvector(p, v4);
        v4_add_to(c->y + 3 * (size_t)i, &step);
    }
}

/* The same of all bodies; sums: of |r|, as objective_norm */
WIDE static void go_on(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const struct objective *sys = c->s->objective;
    double sum = 0.0;
    for (int b = objective_body_of(sys, first), end; first < last; first = end, b++) {
        const struct objective_body *body = &sys->body[b];
        v4 rr = {0};
        end = body->first + body->count < last ? body->first + body->count : last;
        advance(c, first, end, &rr);
        sum += v4_sum(&rr) / (body->weight * body->weight);
    }
    c->s->sums[block] = (struct single_sums){.rr = sum};
}

/* ---- conjugate gradients --------------------------------------------------------------------- */

/* From r and z = D^-1 r, the direction that goes on from the last one, in the metric of H as
 * it was along that: also from the last one of the solve before, whose model differed little.
 * Returns r.p. */
static double next_direction(struct single_cg *s, bool coarse) {
    if (coarse) coarse_solve_single(s->coarse, s->r);
    struct single_sums sums = for_particles(s, end_coarse, &(struct call){.coarse = coarse});
    struct call call = {.scale = s->curvature > 0.0 ? -sums.zq / s->curvature : 0.0};
    double rp = sums.rz + call.scale * sums.rp;
    if (!(rp > 0.0)) call.scale = 0.0, rp = sums.rz;
    for_particles(s, turn_single, &call);
    return rp;
}

/* Goes along it. Returns r.p, by half of which the model falls, for the p that is added; 0: floats
 * are at their end. */
static double go_along(struct single_cg *s, struct call *call, bool coarse, double *rr) {
    double rp = next_direction(s, coarse);
    s->curvature = single_apply(&s->product, s->p, s->q);
    if (!(s->curvature > 0.0)) return 0.0;
    call->scale = rp / s->curvature;
    *rr = for_particles(s, go_on, call).rr;
    return isfinite(*rr) ? rp * call->scale : 0.0;
}

/* ---- solves ---------------------------------------------------------------------------------- */

void single_cg_prepare(struct single_cg *s) { single_prepare(&s->product); }

static void begin(struct single_cg *s, struct call *call, const pdyn_stop *stop) {
    single_diagonal(&s->product, s->jacobi->inverse);
    jacobi_invert(s->jacobi);
    for_particles(s, begin_single, call);
    coarse_prepare(s->coarse, stop->first_of_step);
    if (stop->first_of_step) s->curvature = 0.0;
}

/* `gain` of the last iteration, `gained` by those that count. */
static bool is_enough(const pdyn_stop *stop, int iterations, double gain, double gained) {
    int count = stop->min_iterations > 0 ? iterations - 1 : iterations;
    return iterations >= stop->min_iterations && gain * count < stop->min_progress * gained;
}

/* Most of what few iterations leave is stiff motion between nodes: a step by blocks alone, which
 * takes a product but no solve with the coarse level, does away with much of it. Where H changes, a
 * product is dear. */
static enum single_end cut_short(struct single_cg *s, struct call *call) {
    double rr;
    if (!s->objective->dynamic_rows) go_along(s, call, false, &rr);
    return SINGLE_ENOUGH;
}

enum single_end single_cg_solve(struct single_cg *s, const double *b, double *y,
                                const pdyn_stop *stop, int *iterations) {
    s->length = sqrt(objective_dot(s->objective, b, b));
    struct call call = {.b = b, .y = y};
    double relative = s->length / objective_norm(s->objective, b), rr = 1.0, gained = 0.0,
           gain = INFINITY;
    *iterations = 0;
    if (!(s->length > 0.0)) return SINGLE_SOLVED;
    call.scale = 1.0 / s->length;
    begin(s, &call, stop);
    while (*iterations < stop->min_iterations || rr > stop->rel_tol * stop->rel_tol) {
        if (*iterations >= stop->max_iterations) return cut_short(s, &call);
        if (is_enough(stop, *iterations, gain, gained)) return SINGLE_ENOUGH;
        gain = go_along(s, &call, true, &rr);
        if (!(gain > 0.0)) return SINGLE_EXHAUSTED;
        rr *= relative * relative;
        if (*iterations > 0 || stop->min_iterations == 0) gained += gain;
        ++*iterations;
    }
    return SINGLE_SOLVED;
}

WIDE static void scale_residual(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++)
        for (int a = 0; a < 3; a++)
            c->y[3 * (size_t)i + a] = c->s->length * (double)c->s->r[4 * (size_t)i + a];
}

void single_cg_residual(struct single_cg *s, double *r) {
    for_particles(s, scale_residual, &(struct call){.y = r});
}
