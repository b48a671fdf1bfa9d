#include "single_turn.h"

#include <math.h>

/* Of a direction's curvature, what those before it must leave. */
static const double distinct = 1e-5;
/* What rounding may leave of r.p, of p.q. */
static const double lost = 1e-3;

struct call {
    struct single_cg *s;
    double *y;
    double size, part[SPAN]; /* of each direction */
};

struct span {                     /* of a particle */
    v4f along[SPAN], image[SPAN]; /* directions, H times these */
};

static void for_particles(struct call *call, pdyn_range_fn *fn) {
    struct system *sys = call->s->system;
    pool_for(sys->context->pool, sys->particles, SYSTEM_GRAIN, fn, call);
}

INLINE void load_span(struct span *at, const struct single_cg *s, int i) {
    v4f_load(&at->along[0], s->t, i), v4f_load(&at->image[0], s->ht, i);
    v4f_load(&at->along[1], s->z, i), v4f_load(&at->image[1], s->hz, i);
    v4f_load(&at->along[2], s->u, i), v4f_load(&at->image[2], s->hu, i);
    v4f_load(&at->along[3], s->p, i), v4f_load(&at->image[3], s->q, i);
}

INLINE void add_product(v4 *sum, const v4f *a, const v4f *b) {
    *sum += __builtin_convertvector(*a * *b, v4);
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
    struct turn_sums *out = s->turn_sums + block;
    v4 product[SPAN][SPAN] = {0}, slope[SPAN] = {0};
    for (int i = first; i < last; i++) {
        struct span at;
        v4f r;
        load_span(&at, s, i), v4f_load(&r, s->r, i);
        for (int a = 0; a < SPAN; a++) {
            add_product(&slope[a], &r, &at.along[a]);
            for (int b = a; b < SPAN; b++) add_product(&product[a][b], &at.along[a], &at.image[b]);
        }
    }
    for (int a = 0; a < SPAN; a++) {
        out->slope[a] = v4_sum(&slope[a]);
        for (int b = a; b < SPAN; b++) out->product[a][b] = v4_sum(&product[a][b]);
    }
}

/* p, q = parts of all; r -= q, y += size p, z = omega D^-1 r; sums: r.r */
WIDE static void go_there(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const struct single_cg *s = c->s;
    float part[SPAN];
    v4 rr = {0};
    for (int k = 0; k < SPAN; k++) part[k] = (float)c->part[k];
    for (int i = first; i < last; i++) {
        struct span at;
        v4f r, z, p = {0}, q = {0};
        load_span(&at, s, i), v4f_load(&r, s->r, i);
        for (int k = 0; k < SPAN; k++) p += part[k] * at.along[k], q += part[k] * at.image[k];
        r -= q;
        single_cg_block(s, i, &r, &z);
        v4f_store(s->p, i, &p), v4f_store(s->q, i, &q);
        v4f_store(s->r, i, &r), v4f_store(s->z, i, &z);
        add_product(&rr, &r, &r);
        v4 step = c->size * __builtin_convertvector(p, v4);
        v4_add_to(c->y + 3 * (size_t)i, &step);
    }
    s->turn_sums[block].rr = v4_sum(&rr);
}

/* The minimum over the directions, but for those that depend on the ones before them: L d L' = G.
 * Returns twice what the model falls by. */
static double find_minimum(const struct turn_sums *sums, double part[SPAN]) {
    double L[SPAN][SPAN], d[SPAN], falls = 0.0;
    for (int k = 0; k < SPAN; k++) {
        double own = sums->product[k][k], y = sums->slope[k];
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
            all.slope[a] += part->slope[a];
            for (int b = a; b < SPAN; b++) all.product[a][b] += part->product[a][b];
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
    bool at_minimum = fabs(sums.slope[LAST]) <= lost * sums.product[LAST][LAST];
    if (!(falls > 0.0 && isfinite(falls)) || (minimum && !at_minimum)) return 0.0;
    for_particles(&call, go_there);
    *rr = add_up(s).rr;
    return isfinite(*rr) ? falls : 0.0;
}
