#include "single_turn.h"

#include "../core/fours.h"

#include <math.h>

/* Of a direction's curvature, what those before it must leave. */
static const double distinct = 1e-5;
/* What rounding may leave of r.p, of p.q. */
static const double lost = 1e-3;

enum { RUN = 32 }; /* particles whose products are added up in floats */
_Static_assert(SYSTEM_GRAIN % 2 == 0 && RUN % 2 == 0, "particles are taken by two");

struct call {
    struct single_cg *s;
    double *y;
    double size, part[SPAN]; /* of each direction */
};

struct span { /* of two particles: directions, H times these, and r */
    v8f along[SPAN], image[SPAN + 1];
};

static void for_particles(struct call *call, pdyn_range_fn *fn) {
    struct system *sys = call->s->system;
    pool_for(sys->context->pool, sys->particles, SYSTEM_GRAIN, fn, call);
}

INLINE void load_two(v8f *to, const float *from, int i) {
    memcpy(to, from + 4 * (size_t)i, sizeof *to);
}
INLINE void store_two(float *to, int i, const v8f *from) {
    memcpy(to + 4 * (size_t)i, from, sizeof *from);
}

/* Of particles i and i + 1, which beyond the last is 0. */
INLINE void load_span(struct span *at, const struct single_cg *s, int i) {
    load_two(&at->along[0], s->t, i), load_two(&at->image[0], s->ht, i);
    load_two(&at->along[1], s->z, i), load_two(&at->image[1], s->hz, i);
    load_two(&at->along[2], s->u, i), load_two(&at->image[2], s->hu, i);
    load_two(&at->along[3], s->p, i), load_two(&at->image[3], s->q, i);
    load_two(&at->image[SPAN], s->r, i);
}

INLINE void halves(v4f out[2], const v8f *x) {
    out[0] = __builtin_shufflevector(*x, *x, 0, 1, 2, 3);
    out[1] = __builtin_shufflevector(*x, *x, 4, 5, 6, 7);
}

INLINE void add_eight(v4 *sum, const v8f *x) {
    v4f half[2];
    halves(half, x);
    *sum += __builtin_convertvector(half[0] + half[1], v4);
}

/* u = omega D^-1 w */
WIDE static void block_after(void *arg, int first, int last, int block) {
    (void)block;
    const struct single_cg *s = ((const struct call *)arg)->s;
    for (int i = first; i < last; i++) {
        v4f w, u;
        v4f_load(&w, s->w, i);
        single_cg_block(s, i, &w, &u);
        v4f_store(s->u, i, &u);
    }
}

WIDE static void sum_products(void *arg, int first, int last, int block) {
    const struct single_cg *s = ((const struct call *)arg)->s;
    v4 sum[SPAN][SPAN + 1] = {0};
    for (int i = first, end; i < last; i = end) {
        v8f part[SPAN][SPAN + 1] = {0};
        for (end = i + RUN < last ? i + RUN : last; i < end; i += 2) {
            struct span at;
            load_span(&at, s, i);
            for (int a = 0; a < SPAN; a++)
                for (int b = a; b <= SPAN; b++) part[a][b] += at.along[a] * at.image[b];
        }
        for (int a = 0; a < SPAN; a++)
            for (int b = a; b <= SPAN; b++) add_eight(&sum[a][b], &part[a][b]);
    }
    for (int a = 0; a < SPAN; a++)
        for (int b = a; b <= SPAN; b++) s->turn_sums[block].product[a][b] = v4_sum(&sum[a][b]);
}

/* z = omega D^-1 r of particle i, y += size p */
INLINE void end_particle(const struct call *c, int i, const v4f *r, const v4f *p) {
    v4f z;
    single_cg_block(c->s, i, r, &z);
    v4f_store(c->s->z, i, &z);
    v4 step = c->size * __builtin_convertvector(*p, v4);
    v4_add_to(c->y + 3 * (size_t)i, &step);
}

/* p, q = parts of all; r -= q, y += size p, z = omega D^-1 r; sums: r.r */
WIDE static void go_there(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const struct single_cg *s = c->s;
    float part[SPAN];
    v4 rr = {0};
    for (int k = 0; k < SPAN; k++) part[k] = (float)c->part[k];
    for (int i = first; i < last; i += 2) {
        struct span at;
        v8f p = {0}, q = {0};
        v4f r[2], step[2];
        load_span(&at, s, i);
        for (int k = 0; k < SPAN; k++) p += part[k] * at.along[k], q += part[k] * at.image[k];
        at.image[SPAN] -= q;
        store_two(s->p, i, &p), store_two(s->q, i, &q), store_two(s->r, i, &at.image[SPAN]);
        halves(r, &at.image[SPAN]), halves(step, &p);
        rr += __builtin_convertvector(r[0] * r[0] + r[1] * r[1], v4);
        end_particle(c, i, &r[0], &step[0]);
        if (i + 1 < last) end_particle(c, i + 1, &r[1], &step[1]);
    }
    s->turn_sums[block].rr = v4_sum(&rr);
}

/* The minimum over the directions, but for those that depend on the ones before them: L d L' = G.
 * Returns twice what the model falls by. */
static double find_minimum(const struct turn_sums *sums, double part[SPAN]) {
    double L[SPAN][SPAN], d[SPAN], falls = 0.0;
    for (int k = 0; k < SPAN; k++) {
        double own = sums->product[k][k], y = sums->product[k][SPAN];
        d[k] = own;
        for (int j = 0; j < k; j++) d[k] -= L[k][j] * L[k][j] * d[j], y -= L[k][j] * d[j] * part[j];
        bool depends = d[k] <= distinct * own;
        for (int i = k + 1; i < SPAN; i++) {
            double rest = sums->product[k][i];
            for (int j = 0; j < k; j++) rest -= L[i][j] * d[j] * L[k][j];
            L[i][k] = depends ? 0.0 : rest / d[k];
        }
        part[k] = depends ? 0.0 : y / d[k];
        falls += y * part[k];
    }
    for (int k = SPAN - 1; k >= 0; k--)
        for (int i = k + 1; i < SPAN; i++) part[k] -= L[i][k] * part[i];
    return falls;
}

static struct turn_sums add_up(const struct single_cg *s) {
    struct turn_sums all = {0};
    for (int k = 0; k < pool_blocks(s->system->particles, SYSTEM_GRAIN); k++) {
        const struct turn_sums *part = &s->turn_sums[k];
        for (int a = 0; a < SPAN; a++) {
            for (int b = a; b <= SPAN; b++) all.product[a][b] += part->product[a][b];
        }
        all.rr += part->rr;
    }
    return all;
}

double single_turn(struct single_cg *s, double size, double *y, bool minimum, double *rr) {
    struct call call = {.s = s, .y = y, .size = size};
    single_subtract(&s->product, s->z, s->hz, s->r, s->w);
    backbone_solve(s->backbone, s->w, s->t);
    single_subtract(&s->product, s->t, s->ht, s->w, s->w);
    for_particles(&call, block_after);
    single_apply(&s->product, s->u, s->hu);
    for_particles(&call, sum_products);
    struct turn_sums sums = add_up(s);
    double falls = find_minimum(&sums, call.part);
    bool at_minimum = fabs(sums.product[LAST][SPAN]) <= lost * sums.product[LAST][LAST];
    if (!(falls > 0.0 && isfinite(falls)) || (minimum && !at_minimum)) return 0.0;
    for_particles(&call, go_there);
    *rr = add_up(s).rr;
    return isfinite(*rr) ? falls : 0.0;
}
