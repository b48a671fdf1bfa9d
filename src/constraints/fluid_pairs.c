/* Passes of the fluid operator over the stored pairs of each particle: rate (divergence), force
 * (pressure gradient), block diagonal, viscosity. */
#include "fluid_operator.h"

#include "projdyn/vec3.h"

/* Gradient and value of a pair, in double. */
INLINE void load_pair(const struct fluid *f, int pair, v4 *out) {
    v4_widen(out, f->pair + 4 * (size_t)pair);
}

/* Independent partial sums: an addition does not wait for the previous one. */
enum { LANES = 4 };

/* Adds the contribution of a pair; values: of the neighbours. */
typedef void add_fn(const struct fluid *f, int pair, const double *values, v4 *sum);

/* out = sum of `add` over the pairs pair_start[i] to end - 1 of particle i */
INLINE void sum_pairs(const struct fluid *f, int i, int end, add_fn *add, const double *values,
                      v4 *out) {
    v4 sum[LANES] = {{0}};
    int s = f->pair_start[i];
    for (; s + LANES <= end; s += LANES)
        for (int k = 0; k < LANES; k++) add(f, s + k, values, &sum[k]);
    for (; s < end; s++) add(f, s, values, &sum[0]);
    *out = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* The rate of the relative volume of a sample, for the values u of the particles. */
static double volume_rate(const struct fluid *f, int sample, const double *u) {
    const int *corner = f->lists->sample_vertex + 3 * (size_t)sample;
    const double *growth = f->growth + 9 * (size_t)sample;
    double sum = 0.0;
    for (int m = 0; m < 3; m++) sum += vec3_dot(growth + 3 * m, u + 3 * (size_t)corner[m]);
    return sum;
}

/* vector = (in, 0), or (in, -rate of the volume) for samples, for the particles of a block. */
static void copy_vectors(void *arg, int first, int last, int block) {
    const struct fluid_call *c = arg;
    struct fluid *f = c->f;
    const int first_sample = f->particles - f->samples;
    if (!takes_part(f, first, last, block)) return;
    for (int i = first; i < last; i++) {
        memcpy(f->vector + 4 * i, c->in + 3 * i, 3 * sizeof *c->in);
        f->vector[4 * i + 3] = 0.0;
    }
    for (int i = first > first_sample ? first : first_sample; i < last; i++)
        if (f->pair_end[i] > f->pair_start[i])
            f->vector[4 * i + 3] = -volume_rate(f, i - first_sample, c->in);
}

/* ---- rate: the SPH divergence rate_i = grad C_i . u ------------------------------------------ */

INLINE void add_product(const struct fluid *f, int pair, const double *vector, v4 *sum) {
    v4 g, v;
    load_pair(f, pair, &g);
    memcpy(&v, vector + 4 * (size_t)f->pair_index[pair], sizeof v);
    *sum += g * v;
}

/* rate_i = grad_i C_i . u_i - sum_j (V grad W)_ij . u_j + sum over samples of W_ij dV_j/dt */
WIDE static void divergence(void *arg, int first, int last, int block) {
    (void)block;
    const struct fluid_call *c = arg;
    const struct fluid *f = c->f;
    for (int k = first; k < last; k++) {
        int i = f->first + k;
        v4 sum = {0}, own, at;
        if (c->which[k]) sum_pairs(f, i, f->pair_end[i], add_product, f->vector, &sum);
        memcpy(&own, f->gradient + 4 * i, sizeof own);
        memcpy(&at, f->vector + 4 * i, sizeof at);
        own *= at;
        c->out[k] = c->which[k] ? (own[0] + own[1] + own[2]) - v4_sum(&sum) : 0.0;
    }
}

void fluid_rate(void *self, const bool *which, const double *u, double *rate) {
    struct fluid *f = self;
    struct fluid_call call = {f, NULL, rate, which};
    for_particles(f, f->particles, copy_vectors, u, NULL);
    f->services->parallel_for(f->services->core, f->count, FLUID_GRAIN, divergence, &call);
}

/* ---- force: the pressure gradient y += sum_i multiplier_i grad C_i --------------------------- */

INLINE void add_flux(const struct fluid *f, int pair, const double *flux, v4 *sum) {
    v4 g;
    load_pair(f, pair, &g);
    *sum += flux[f->pair_index[pair]] * g;
}

WIDE static void gradients(void *arg, int first, int last, int block) {
    const struct fluid_call *c = arg;
    const struct fluid *f = c->f;
    const int first_sample = f->particles - f->samples;
    if (!takes_part(f, first, last, block)) return;
    for (int i = first; i < last; i++) {
        v4 sum, own;
        sum_pairs(f, i, f->pair_end[i], add_flux, c->in, &sum);
        if (i >= first_sample) f->tension[i - first_sample] = sum[3];
        memcpy(&own, f->gradient + 4 * i, sizeof own);
        sum += c->in[i] * own;
        v4_add_to(c->out + 3 * i, &sum);
    }
}

/* The force of the volume of a sample on the corners of its triangle. One thread: triangles share
 * corners, and samples with pairs are few. */
static void add_tensions(const struct fluid *f, double *y) {
    for (int n = 0; n < f->listed; n++) {
        int k = f->listed_sample[n], i = f->particles - f->samples + k;
        if (f->pair_end[i] <= f->pair_start[i]) continue;
        for (int m = 0; m < 3; m++)
            vec3_add(y + 3 * (size_t)f->lists->sample_vertex[3 * k + m], f->tension[k],
                     f->growth + 9 * (size_t)k + 3 * m);
    }
}

void fluid_add_gradients(struct fluid *f, const double *multiplier, double *y) {
    for_particles(f, f->particles, gradients, multiplier, y);
    add_tensions(f, y);
}

static void spread(void *arg, int first, int last, int block) {
    (void)block;
    const struct fluid_call *c = arg;
    memcpy(c->out + first, c->in + first, (size_t)(last - first) * sizeof *c->in);
}

void fluid_force(void *self, const double *multiplier, double *y) {
    struct fluid *f = self;
    for_particles(f, f->count, spread, multiplier, f->multiplier + f->first);
    fluid_add_gradients(f, f->multiplier, y);
}

/* ---- block diagonal -------------------------------------------------------------------------- */

INLINE void add_outer_product(v4 sum[3], double scale, const v4 *a) {
    for (int k = 0; k < 3; k++) sum[k] += scale * (*a)[k] * *a;
}

WIDE static void diagonal_blocks(void *arg, int first, int last, int block) {
    const struct fluid_call *c = arg;
    const struct fluid *f = c->f;
    if (!takes_part(f, first, last, block)) return;
    for (int i = first; i < last; i++) {
        v4 sum[3] = {{0}}, g;
        for (int s = f->pair_start[i]; s < f->pair_end[i]; s++) {
            load_pair(f, s, &g);
            add_outer_product(sum, c->in[f->pair_index[s]], &g);
        }
        memcpy(&g, f->gradient + 4 * i, sizeof g);
        add_outer_product(sum, c->in[i], &g);
        double *D = c->out + 6 * i;
        D[0] += sum[0][0], D[1] += sum[0][1], D[2] += sum[0][2];
        D[3] += sum[1][1], D[4] += sum[1][2], D[5] += sum[2][2];
    }
}

void fluid_diagonal(void *self, const double *stiffness, double *blocks) {
    struct fluid *f = self;
    for_particles(f, f->count, spread, stiffness, f->multiplier + f->first);
    for_particles(f, f->particles, diagonal_blocks, f->multiplier, blocks);
}

/* ---- viscosity ------------------------------------------------------------------------------- */

/* sum += change of the velocity `own` of the first particle of pair s, before the factor 3
 * viscosity: W_ij ((v_j - v_i) . n) n, n along grad W; 0 unless both are fluid. */
INLINE void add_exchange(const struct fluid *f, int s, const v4 *own, v4 *sum) {
    v4 g, v;
    load_pair(f, s, &g);
    memcpy(&v, f->vector + 4 * (size_t)f->pair_index[s], sizeof v);
    double weight = g[3] * v[3];
    g[3] = 0.0, v -= *own;
    double squared = v4_dot(&g, &g);
    if (squared > 0.0) *sum += weight * v4_dot(&v, &g) / squared * g;
}

/* XSPH viscosity (Schechter & Bridson 2012) between fluid particles, with their rest volumes:
 *
 *     v_i += 3 viscosity sum_j V W_ij ((v_j - v_i) . n_ij) n_ij
 *
 * Only the part of the velocity difference along the line n_ij between the particles counts
 * (Monaghan 1992); the factor 3 restores the mean over all directions. The exchange of a pair is
 * symmetric and central, so momentum and angular momentum are conserved. */
WIDE static void add_viscosity(void *arg, int first, int last, int block) {
    (void)block;
    const struct fluid_call *c = arg;
    const struct fluid *f = c->f;
    for (int i = f->first + first; i < f->first + last; i++) {
        v4 sum = {0}, own;
        v4_set(&own, c->out + 3 * i, 0.0);
        for (int s = f->pair_start[i]; s < f->pair_end[i]; s++) add_exchange(f, s, &own, &sum);
        sum *= 3.0 * f->params.viscosity;
        v4_add_to(c->out + 3 * i, &sum);
    }
}

/* vector = (v, 1) for fluid particles, 0 for the others */
static void copy_velocities(void *arg, int first, int last, int block) {
    const struct fluid_call *c = arg;
    if (!takes_part(c->f, first, last, block)) return;
    for (int i = first; i < last; i++) {
        v4 v = {0};
        if (is_fluid(c->f, i)) v4_set(&v, c->in + 3 * i, 1.0);
        memcpy(c->f->vector + 4 * i, &v, sizeof v);
    }
}

void fluid_viscosity(void *self, double *v) {
    struct fluid *f = self;
    if (f->params.viscosity == 0.0) return;
    for_particles(f, f->particles, copy_velocities, v, NULL);
    for_particles(f, f->count, add_viscosity, NULL, v);
}
