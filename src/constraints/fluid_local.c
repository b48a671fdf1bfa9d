/* Local step of the fluid operator: at positions x it computes, for each fluid particle, C_i, grad
 * C_i and the energy (fluid.c), and stores the kernel's gradient and value of each pair. Neighbours
 * are processed in chunks, in arrays of four lanes. Also the forces on boundary points. */
#include "fluid_pairs.h"

#include "projdyn/vec3.h"

enum { CHUNK = 64 }; /* neighbours per chunk */

struct chunk { /* the neighbours of one chunk that lie within the support */
    int index[CHUNK + 4];
    double squared[CHUNK + 4];           /* squared distance, m^2 */
    double x[CHUNK], y[CHUNK], z[CHUNK]; /* x_i - x_j, m; round_gradients: V grad W, 1/m */
    double volume[CHUNK];                /* minus the relative volume V, see project_other */
    double value[CHUNK], slope[CHUNK];   /* W times the volume of a particle; (dW/dr) / r */
};

struct sum {            /* sums over the neighbours of one particle i */
    double c;           /* C_i, of either sign */
    double gradient[3]; /* grad C_i with respect to x_i, 1/m */
    double squares;     /* |grad C_i|^2 over the moving particles, 1/m^2 */
    int members;        /* fluid particles among them */
};

/* out = at - (point `index` of x) */
INLINE void difference(const double *x, const v4 *at, int index, v4 *out) {
    v4 row;
    memcpy(&row, x + 4 * (size_t)index, sizeof row);
    *out = *at - row;
}

/* Four differences, transposed: out[0] has the x of the four, then y, z and at[3] - volume. */
INLINE void differences(const double *x, const v4 *at, const int *index, v4 out[4]) {
    v4 a, b, c, d;
    difference(x, at, index[0], &a);
    difference(x, at, index[1], &b);
    difference(x, at, index[2], &c);
    difference(x, at, index[3], &d);
    v4 xz = __builtin_shufflevector(a, b, 0, 4, 2, 6),
       yv = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    v4 xz2 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    v4 yv2 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    out[0] = __builtin_shufflevector(xz, xz2, 0, 1, 4, 5);
    out[1] = __builtin_shufflevector(yv, yv2, 0, 1, 4, 5);
    out[2] = __builtin_shufflevector(xz, xz2, 2, 3, 6, 7);
    out[3] = __builtin_shufflevector(yv, yv2, 2, 3, 6, 7);
}

/* Returns four indices from list[k] on; past the end of the list its last index is repeated. */
INLINE const int *four_indices(const int *list, int k, int count, int filled[4]) {
    if (k + 4 <= count) return list + k;
    for (int a = 0; a < 4; a++) filled[a] = list[k + a < count ? k + a : count - 1];
    return filled;
}

/* near->index = those of `count` points at a distance below `reach` from `at`; returns their
 * number. Without a branch on the distance: it would be mispredicted about half the time. */
INLINE int select_near(const struct fluid *f, const v4 *at, const int *list, int count,
                       double reach, struct chunk *near) {
    double limit = reach * reach;
    int filled[4], inside = 0;
    for (int k = 0; k < count; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four_indices(list, k, count, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
    }
    for (int k = 0; k < count; k++) {
        near->index[inside] = list[k];
        inside += near->squared[k] < limit;
    }
    return inside;
}

/* Sets squared, x, y, z, volume of the selected points, up to a multiple of four. */
INLINE void load_near(const struct fluid *f, const v4 *at, int inside, struct chunk *near) {
    int filled[4];
    for (int k = 0; k < inside; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four_indices(near->index, k, inside, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
        memcpy(near->x + k, &d[0], sizeof d[0]);
        memcpy(near->y + k, &d[1], sizeof d[1]);
        memcpy(near->z + k, &d[2], sizeof d[2]);
        memcpy(near->volume + k, &d[3], sizeof d[3]);
    }
}

/* Sets value and slope of the selected points, 0 from `inside` to the next multiple of four. */
typedef void evaluate_fn(const struct fluid *f, int inside, struct chunk *near);

/* The cubic spline, kernel.h */
INLINE void evaluate_particles(const struct fluid *f, int inside, struct chunk *near) {
    const struct kernel *kernel = &f->kernel;
    int padded = (inside + 3) / 4 * 4;
    for (int k = 0; k < padded; k++) {
        double q = sqrt(near->squared[k]) * kernel->inverse, rest = 1.0 - q;
        double value = q <= 0.5 ? 1.0 - 6.0 * q * q * rest : 2.0 * rest * rest * rest;
        double slope = q <= 0.5 ? 3.0 * q - 2.0 : -rest * rest / q;
        near->value[k] = kernel->value * value;
        near->slope[k] = kernel->slope * slope;
    }
    for (int k = inside; k < padded; k++) near->value[k] = near->slope[k] = 0.0;
}

/* The surface kernel, kernel.h */
INLINE void evaluate_areas(const struct fluid *f, int inside, struct chunk *near) {
    const struct surface_kernel *kernel = &f->surface;
    int padded = (inside + 3) / 4 * 4;
    for (int k = 0; k < padded; k++) {
        double q = sqrt(near->squared[k] + kernel->soft), rest = 1.0 - q * kernel->inverse;
        double scale = kernel->value * rest * rest / q;
        near->value[k] = scale * rest;
        near->slope[k] = -scale * (1.0 + 2.0 * q * kernel->inverse) / (q * q);
    }
    for (int k = inside; k < padded; k++) near->value[k] = near->slope[k] = 0.0;
}

INLINE void evaluate_surface(const struct fluid *f, int inside, struct chunk *near) {
    if (f->lists->has_volumes) evaluate_particles(f, inside, near);
    else evaluate_areas(f, inside, near);
}

/* x_a = scale_a x_a rounded to float, as pairs are stored */
INLINE void round_lanes(double *x, double scale[4]) {
    for (int a = 0; a < 4; a++) x[a] = (double)(float)(scale[a] * x[a]);
}

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

/* x, y, z = V grad W, from the distance vector and the slope */
INLINE void round_gradients(struct chunk *near, int inside) {
    for (int k = 0; k < inside; k += 4) {
        round_lanes(near->x + k, near->slope + k);
        round_lanes(near->y + k, near->slope + k);
        round_lanes(near->z + k, near->slope + k);
    }
}

/* Selects those of `count` points at a distance below `reach` from `at`, with values and gradients;
 * returns their number. */
INLINE int evaluate_near(const struct fluid *f, const v4 *at, const int *list, int count,
                         double reach, evaluate_fn *evaluate, struct chunk *near) {
    int inside = select_near(f, at, list, count, reach, near);
    load_near(f, at, inside, near);
    evaluate(f, inside, near);
    for (int k = 0; k < inside; k++) near->slope[k] *= -near->volume[k];
    round_gradients(near, inside);
    return inside;
}

INLINE int chunk_of(int count, int s) { return count - s < CHUNK ? count - s : CHUNK; }

/* Adds `count` points to the sums. Moving neighbours are stored as pairs from *front on. front
 * NULL: boundary points, which are not stored and do not count in |grad C_i|^2. */
INLINE void add_points(struct fluid *f, const v4 *at, const int *list, int count, double reach,
                       evaluate_fn *evaluate, struct chunk *near, int *front, struct sum *sum) {
    double squares = sum->squares;
    for (int s = 0; s < count; s += CHUNK) {
        int inside = evaluate_near(f, at, list + s, chunk_of(count, s), reach, evaluate, near);
        add_chunk(near, (inside + 3) / 4 * 4, sum);
        if (!front) continue;
        store_pairs(f, near, inside, *front, sum);
        *front += inside;
    }
    if (!front) sum->squares = squares;
}

/* Adds the listed points first to last - 1. */
INLINE void add_neighbours(struct fluid *f, const v4 *at, int first, int last, double reach,
                           evaluate_fn *evaluate, struct chunk *near, int *front, struct sum *sum) {
    add_points(f, at, f->lists->index + first, last - first, reach, evaluate, near, front, sum);
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* Stores constraint i; returns its energy. */
INLINE double store_constraint(struct fluid *f, int i, const struct sum *sum) {
    v4 gradient = {sum->gradient[0], sum->gradient[1], sum->gradient[2], 0.0};
    memcpy(f->gradient + 4 * i, &gradient, sizeof gradient);
    f->value[i] = sum->c, f->squares[i] = sum->squares;
    if (f->stiffness[i] == 0.0) f->stiffness[i] = fluid_stiffness_at(f, i);
    f->flux[i] = sum->c > 0.0 ? f->stiffness[i] * sum->c : 0.0;
    return 0.5 * f->flux[i] * sum->c;
}

/* Computes and stores constraint i, with its pairs from *front on; returns its energy. */
INLINE double project_fluid(struct fluid *f, int i, struct chunk *near, int *front) {
    const pdyn_neighbours *l = f->lists;
    double rest = 1.0 + (l->granted ? l->granted[i] : 0.0);
    struct sum sum = {.c = f->x[4 * (size_t)i + 3] * f->kernel.value - rest, .members = 1};
    v4 at;
    v4_set(&at, f->x + 4 * (size_t)i, 0.0);
    add_neighbours(f, &at, l->start[i], l->surface_start[i], l->support, evaluate_particles, near,
                   front, &sum);
    add_neighbours(f, &at, l->surface_start[i], l->boundary_start[i], l->surface_support,
                   evaluate_surface, near, front, &sum);
    add_neighbours(f, &at, l->boundary_start[i], l->patch_start[i], l->support, evaluate_particles,
                   near, NULL, &sum);
    add_neighbours(f, &at, l->patch_start[i], l->end[i], l->surface_support, evaluate_areas, near,
                   NULL, &sum);
    f->pair_end[i] = *front;
    f->weight_sum[i] = f->params.stiffness * sum.members;
    sum.squares += vec3_dot(sum.gradient, sum.gradient);
    return store_constraint(f, i, &sum);
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

/* Stores the pairs of a point i without a constraint of this operator: a sample, or a particle of
 * another fluid. A pair has the volume V of i, not that of the fluid particle j, 1: at[3] - 1 = -V
 * for at[3] = 1 - V. */
INLINE void project_other(struct fluid *f, int i, struct chunk *near, int *front) {
    const pdyn_neighbours *l = f->lists;
    bool sample = i >= l->particles - l->samples;
    struct sum sum = {0};
    int own[CHUNK];
    v4 at;
    v4_set(&at, f->x + 4 * (size_t)i, 1.0 - f->x[4 * (size_t)i + 3]);
    for (int s = l->start[i], count; (count = select_own(f, &s, l->surface_start[i], own)) > 0;)
        if (sample)
            add_points(f, &at, own, count, l->surface_support, evaluate_surface, near, front, &sum);
        else add_points(f, &at, own, count, l->support, evaluate_particles, near, front, &sum);
    f->pair_end[i] = *front;
    f->weight_sum[i] = f->params.stiffness * sum.members;
}

WIDE static void project_block(void *arg, int first, int last, int block) {
    struct fluid *f = ((const struct fluid_call *)arg)->f;
    struct chunk near;
    double energy = 0.0;
    int front = f->block_start[block];
    for (int i = first; i < last; i++) {
        f->pair_start[i] = front;
        if (is_fluid(f, i)) energy += project_fluid(f, i, &near, &front);
        else project_other(f, i, &near, &front);
    }
    f->partial[block] = energy;
}

static void set_positions(void *arg, int first, int last, int block) {
    (void)block;
    const struct fluid_call *c = arg;
    for (int i = first; i < last; i++) memcpy(c->f->x + 4 * i, c->in + 3 * i, 3 * sizeof *c->in);
}

double fluid_project(struct fluid *f, const double *x) {
    double sum = 0.0;
    for_particles(f, f->particles, set_positions, x, NULL);
    for_particles(f, f->particles, project_block, NULL, NULL);
    for (int b = 0; b * FLUID_GRAIN < f->particles; b++) sum += f->partial[b];
    return sum;
}

/* ---- forces on boundary points --------------------------------------------------------------- */

/* Adds the forces that the constraint of a particle at `at` puts on the listed boundary points
 * first to last - 1. flux: its multiplier, N m; force: (points - particles) x 3, N. */
INLINE void push_points(const struct fluid *f, const v4 *at, int first, int last, double reach,
                        evaluate_fn *evaluate, double flux, double *force) {
    const int *list = f->lists->index + first;
    struct chunk near;
    for (int s = 0; s < last - first; s += CHUNK) {
        int count = chunk_of(last - first, s);
        int inside = evaluate_near(f, at, list + s, count, reach, evaluate, &near);
        for (int k = 0; k < inside; k++) {
            double *to = force + 3 * (size_t)(near.index[k] - f->particles);
            to[0] += flux * near.x[k], to[1] += flux * near.y[k], to[2] += flux * near.z[k];
        }
    }
}

/* The force on boundary point b is multiplier_i V grad W(x_i - x_b): C_i depends on x_i - x_b, so
 * its gradients with respect to x_b and x_i are opposite, to the last bit of the local step. The
 * loop is serial: sums have the same bits for any number of threads. */
WIDE static void push_boundary(const struct fluid *f, double *force) {
    const pdyn_neighbours *l = f->lists;
    for (int i = f->first; i < f->first + f->count; i++) {
        v4 at;
        if (f->multiplier[i] == 0.0) continue;
        v4_set(&at, f->x + 4 * (size_t)i, 0.0);
        push_points(f, &at, l->boundary_start[i], l->patch_start[i], l->support, evaluate_particles,
                    f->multiplier[i], force);
        push_points(f, &at, l->patch_start[i], l->end[i], l->surface_support, evaluate_areas,
                    f->multiplier[i], force);
    }
}

void fluid_boundary_force(void *self, double *force) { push_boundary(self, force); }
