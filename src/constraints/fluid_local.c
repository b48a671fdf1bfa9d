/* Local step of the fluid operator: at positions x it computes, for each fluid particle, C_i, grad
 * C_i and the energy (fluid.c), and stores the kernel's gradient and value of each pair.
 *
 * With damping tau, pressure is k (C + tau dC/dt). In a step of length h this is a constraint of
 * the same kind, with another stiffness and another rest state (C^n: at the beginning of the step):
 *
 *     k (C + tau (C - C^n) / h) = factor k (C - part C^n),
 *     factor = 1 + tau / h,  part = tau / (h + tau)
 *
 * C^n counts where it is positive: the fluid does not resist before it is compressed. */
#include "fluid_chunk.h"

#include "projdyn/vec3.h"

struct sum {            /* sums over the neighbours of one particle i */
    double c;           /* C_i, of either sign */
    double gradient[3]; /* grad C_i with respect to x_i, 1/m */
    double squares;     /* |grad C_i|^2 over the moving particles, 1/m^2 */
    int members;        /* fluid particles among them */
};

/* Adds value, gradient and squares of a chunk, up to `padded`. */
INLINE void add_chunk(const struct chunk *near, int padded, struct sum *sum) {
    v4 c = {0}, g[3] = {{0}}, squares = {0};
    for (int k = 0; k < padded; k += 4) {
        v4 x, y, z, value, volume;
        memcpy(&x, near->x + k, sizeof x), memcpy(&y, near->y + k, sizeof y);
        memcpy(&z, near->z + k, sizeof z), memcpy(&value, near->value + k, sizeof value);
        memcpy(&volume, near->volume + k, sizeof volume);
        c -= volume * value;
        g[0] += x, g[1] += y, g[2] += z;
        squares += x * x + y * y + z * z;
    }
    sum->c += v4_sum(&c);
    for (int a = 0; a < 3; a++) sum->gradient[a] += v4_sum(&g[a]);
    sum->squares += v4_sum(&squares);
}

/* Stores the selected points as pairs from `pair` on. */
INLINE void store_pairs(struct fluid *f, const struct chunk *near, int inside, int pair,
                        struct sum *sum) {
    for (int k = 0; k < inside; k++) {
        float *to = f->pair + 4 * (size_t)(pair + k);
        to[0] = (float)near->x[k], to[1] = (float)near->y[k], to[2] = (float)near->z[k];
        to[3] = (float)near->value[k];
        f->pair_index[pair + k] = near->index[k];
        sum->members += is_fluid(f, near->index[k]);
    }
}

struct pass { /* over the neighbours of the particles of a block, one particle after the other */
    struct fluid *f;
    struct chunk *near;
    int front;      /* the next pair that is stored */
    v4 at;          /* of the current particle: position, and what `differences` makes of at[3] */
    struct sum sum; /* over its neighbours */
};

/* Adds `count` points to the sums. Those that move are stored as pairs; boundary points are not,
 * and do not count in |grad C_i|^2. */
INLINE void add_points(struct pass *p, bool moving, const int *list, int count, double reach,
                       evaluate_fn *evaluate) {
    double squares = p->sum.squares;
    for (int s = 0; s < count; s += CHUNK) {
        int inside =
            evaluate_near(p->f, &p->at, list + s, chunk_of(count, s), reach, evaluate, p->near);
        add_chunk(p->near, (inside + 3) / 4 * 4, &p->sum);
        if (!moving) continue;
        store_pairs(p->f, p->near, inside, p->front, &p->sum);
        p->front += inside;
    }
    if (!moving) p->sum.squares = squares;
}

/* Adds the listed points first to last - 1. */
INLINE void add_neighbours(struct pass *p, bool moving, int first, int last, double reach,
                           evaluate_fn *evaluate) {
    add_points(p, moving, p->f->lists->index + first, last - first, reach, evaluate);
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* Stores constraint i; returns its energy. */
INLINE double store_constraint(struct fluid *f, int i, const struct sum *sum) {
    v4 gradient = {sum->gradient[0], sum->gradient[1], sum->gradient[2], 0.0};
    memcpy(f->gradient + 4 * i, &gradient, sizeof gradient);
    f->value[i] = sum->c - f->part * f->value_before[i], f->squares[i] = sum->squares;
    if (f->stiffness[i] == 0.0) f->stiffness[i] = fluid_stiffness_at(f, sum->squares);
    f->flux[i] = f->value[i] > 0.0 ? f->stiffness[i] * f->value[i] : 0.0;
    return 0.5 * f->flux[i] * f->value[i];
}

/* Computes and stores constraint i and its pairs; returns its energy. */
INLINE double project_fluid(struct pass *p, int i) {
    struct fluid *f = p->f;
    const pdyn_neighbours *l = f->lists;
    double rest = 1.0 + (l->granted ? l->granted[i] : 0.0);
    p->sum = (struct sum){.c = f->x[4 * (size_t)i + 3] * f->kernel.value - rest, .members = 1};
    v4_set(&p->at, f->x + 4 * (size_t)i, 0.0);
    add_neighbours(p, true, l->start[i], l->surface_start[i], l->support, evaluate_particles);
    add_neighbours(p, true, l->surface_start[i], l->boundary_start[i], l->surface_support,
                   evaluate_surface);
    add_neighbours(p, false, l->boundary_start[i], l->patch_start[i], l->support,
                   evaluate_particles);
    add_neighbours(p, false, l->patch_start[i], l->end[i], l->surface_support, evaluate_areas);
    f->weight_sum[i] = f->params.stiffness * p->sum.members;
    p->sum.squares += vec3_dot(p->sum.gradient, p->sum.gradient);
    return store_constraint(f, i, &p->sum);
}

/* own = the particles of this fluid among the listed ones from *s on, at most CHUNK; returns their
 * number. */
INLINE int select_own(const struct fluid *f, int *s, int last, int own[CHUNK]) {
    int count = 0;
    for (; *s < last && count < CHUNK; ++*s) {
        own[count] = f->lists->index[*s];
        count += is_fluid(f, own[count]);
    }
    return count;
}

/* Stores the pairs of a point i that has no constraint of this operator: a sample, or a particle of
 * another fluid. These pairs count with the relative volume V of i. `differences` subtracts the
 * relative volume of the neighbour, which is 1 because it is a particle of the fluid, from at[3]:
 * with at[3] = 1 - V it gives -V, as chunk.volume is. */
INLINE void project_other(struct pass *p, int i) {
    struct fluid *f = p->f;
    const pdyn_neighbours *l = f->lists;
    bool sample = i >= l->particles - l->samples;
    int own[CHUNK];
    p->sum = (struct sum){0};
    v4_set(&p->at, f->x + 4 * (size_t)i, 1.0 - f->x[4 * (size_t)i + 3]);
    for (int s = l->start[i], count; (count = select_own(f, &s, l->surface_start[i], own)) > 0;)
        if (sample) add_points(p, true, own, count, l->surface_support, evaluate_surface);
        else add_points(p, true, own, count, l->support, evaluate_particles);
    f->weight_sum[i] = f->params.stiffness * p->sum.members;
}

WIDE static void project_block(void *arg, int first, int last, int block) {
    struct fluid *f = ((const struct fluid_call *)arg)->f;
    struct chunk near;
    struct pass pass = {.f = f, .near = &near, .front = f->block_start[block]};
    double energy = 0.0;
    f->partial[block] = 0.0;
    if (!takes_part(f, first, last, block)) return;
    for (int i = first; i < last; i++) {
        f->pair_start[i] = pass.front;
        if (is_fluid(f, i)) energy += project_fluid(&pass, i);
        else project_other(&pass, i);
        f->pair_end[i] = pass.front;
    }
    f->partial[block] = energy;
}

/* The relative volume of a sample at x, and its gradient. */
static void set_volume(struct fluid *f, int sample, const double *x) {
    const pdyn_neighbours *l = f->lists;
    const double *corner[3];
    for (int m = 0; m < 3; m++) corner[m] = x + 3 * (size_t)l->sample_vertex[3 * sample + m];
    f->x[4 * (size_t)(f->particles - f->samples + sample) + 3] = fluid_sample_volume(
        l->sample_share[sample] / f->particle_volume, corner, f->growth + 9 * (size_t)sample);
}

static void set_positions(void *arg, int first, int last, int block) {
    const struct fluid_call *c = arg;
    struct fluid *f = c->f;
    const int first_sample = f->particles - f->samples;
    if (!takes_part(f, first, last, block)) return;
    for (int i = first; i < last; i++) {
        memcpy(f->x + 4 * i, c->in + 3 * i, 3 * sizeof *c->in);
        if (i >= first_sample && f->lists->end[i] > f->lists->start[i])
            set_volume(f, i - first_sample, c->in);
    }
}

double fluid_project(struct fluid *f, const double *x) {
    double sum = 0.0;
    for_particles(f, f->particles, set_positions, x, NULL);
    for_particles(f, f->particles, project_block, NULL, NULL);
    for (int b = 0; b * FLUID_GRAIN < f->particles; b++) sum += f->partial[b];
    return sum;
}
