/* The local step of the fluid: from positions to constraints, their gradients and energies. */
#include "fluid_pairs.h"

#include "projdyn/vec3.h"

enum { CHUNK = 64 }; /* neighbours looked at side by side */

struct near { /* neighbours inside the support, side by side */
    int index[CHUNK + 4];
    double squared[CHUNK + 4];
    double x[CHUNK], y[CHUNK], z[CHUNK]; /* distance vector, then the pair's gradient */
    double volume[CHUNK];                /* of the one that is no fluid, relative to a particle's */
    double value[CHUNK], slope[CHUNK];
};

struct sum {            /* over the neighbours of one particle i */
    double c;           /* C_i, not clipped */
    double gradient[3]; /* of C_i with respect to x_i, 1/m */
    double squares;     /* |grad C_i|^2 over the moving neighbours, 1/m^2 */
    int members;        /* fluid particles among these */
};

INLINE void difference(const double *x, const v4 *at, int index, v4 *out) {
    v4 row;
    memcpy(&row, x + 4 * (size_t)index, sizeof row);
    *out = *at - row;
}

/* Four points' differences from `at`, by lanes: x, y, z, volume. */
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

/* The last four of a list that is no multiple of four long go on with its last one. */
INLINE const int *four(const int *list, int k, int count, int filled[4]) {
    if (k + 4 <= count) return list + k;
    for (int a = 0; a < 4; a++) filled[a] = list[k + a < count ? k + a : count - 1];
    return filled;
}

/* Those of `count` points that lie closer than `reach` to `at` go to near->index. No branch depends
 * on which: it would be guessed wrong half the time. */
INLINE int pick_near(const struct fluid *f, const v4 *at, const int *list, int count, double reach,
                     struct near *near) {
    double limit = reach * reach;
    int filled[4], inside = 0;
    for (int k = 0; k < count; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four(list, k, count, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
    }
    for (int k = 0; k < count; k++) {
        near->index[inside] = list[k];
        inside += near->squared[k] < limit;
    }
    return inside;
}

/* Distances to those inside; up to the next four beyond, the last one's again. */
INLINE void load_near(const struct fluid *f, const v4 *at, int inside, struct near *near) {
    int filled[4];
    for (int k = 0; k < inside; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four(near->index, k, inside, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
        memcpy(near->x + k, &d[0], sizeof d[0]);
        memcpy(near->y + k, &d[1], sizeof d[1]);
        memcpy(near->z + k, &d[2], sizeof d[2]);
        memcpy(near->volume + k, &d[3], sizeof d[3]);
    }
}

/* Kernel and slope: of fluid and fluid, or of fluid and a surface; 0 beyond `inside`. */
typedef void evaluate_fn(const struct fluid *f, int inside, struct near *near);

INLINE void evaluate_particles(const struct fluid *f, int inside, struct near *near) {
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

INLINE void evaluate_areas(const struct fluid *f, int inside, struct near *near) {
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

INLINE void evaluate_surface(const struct fluid *f, int inside, struct near *near) {
    if (f->lists->has_volumes) evaluate_particles(f, inside, near);
    else evaluate_areas(f, inside, near);
}

/* What is kept of a number in a pair. */
INLINE void round_lanes(double *x, double scale[4]) {
    for (int a = 0; a < 4; a++) x[a] = (double)(float)(scale[a] * x[a]);
}

INLINE void add_lanes(const struct near *near, int padded, struct sum *sum) {
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

INLINE void keep_pairs(struct fluid *f, const struct near *near, int inside, int pair,
                       struct sum *sum) {
    for (int k = 0; k < inside; k++) {
        float *to = f->pair + 4 * (size_t)(pair + k);
        to[0] = (float)near->x[k], to[1] = (float)near->y[k], to[2] = (float)near->z[k];
        to[3] = (float)near->value[k];
        f->pair_index[pair + k] = near->index[k];
        sum->members += is_fluid(f, near->index[k]);
    }
}

/* Distance vectors become gradients, rounded as pairs are kept. */
INLINE void round_gradients(struct near *near, int inside) {
    for (int k = 0; k < inside; k += 4) {
        round_lanes(near->x + k, near->slope + k);
        round_lanes(near->y + k, near->slope + k);
        round_lanes(near->z + k, near->slope + k);
    }
}

/* Those of `count` points that lie closer than `reach` to `at`, with their values and gradients.
 * Returns how many. */
INLINE int evaluate_near(const struct fluid *f, const v4 *at, const int *list, int count,
                         double reach, evaluate_fn *evaluate, struct near *near) {
    int inside = pick_near(f, at, list, count, reach, near);
    load_near(f, at, inside, near);
    evaluate(f, inside, near);
    for (int k = 0; k < inside; k++) near->slope[k] *= -near->volume[k];
    round_gradients(near, inside);
    return inside;
}

INLINE int chunk_of(int count, int s) { return count - s < CHUNK ? count - s : CHUNK; }

/* A part of the list of a point. Moving neighbours are kept as its pairs from *front on; boundary
 * points, where front is NULL, are not, and have no squares. */
INLINE void add_neighbours(struct fluid *f, const v4 *at, int first, int last, double reach,
                           evaluate_fn *evaluate, struct near *near, int *front, struct sum *sum) {
    const int *list = f->lists->index + first;
    int count = last - first;
    double squares = sum->squares;
    for (int s = 0; s < count; s += CHUNK) {
        int inside = evaluate_near(f, at, list + s, chunk_of(count, s), reach, evaluate, near);
        add_lanes(near, (inside + 3) / 4 * 4, sum);
        if (!front) continue;
        keep_pairs(f, near, inside, *front, sum);
        *front += inside;
    }
    if (!front) sum->squares = squares;
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* Keeps what constraint i is at x; returns its energy. */
INLINE double keep_constraint(struct fluid *f, int i, const struct sum *sum) {
    v4 gradient = {sum->gradient[0], sum->gradient[1], sum->gradient[2], 0.0};
    memcpy(f->gradient + 4 * i, &gradient, sizeof gradient);
    f->value[i] = sum->c, f->squares[i] = sum->squares;
    if (f->stiffness[i] == 0.0) f->stiffness[i] = fluid_stiffness_at(f, i);
    f->flux[i] = sum->c > 0.0 ? f->stiffness[i] * sum->c : 0.0;
    return 0.5 * f->flux[i] * sum->c;
}

/* C_i and its gradient at x. Keeps the pairs of i from *front on. Returns the energy. */
INLINE double project_fluid(struct fluid *f, int i, struct near *near, int *front) {
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
    f->held[i] = f->params.stiffness * sum.members;
    sum.squares += vec3_dot(sum.gradient, sum.gradient);
    return keep_constraint(f, i, &sum);
}

/* Keeps the pairs of sample i, which has no constraint of its own. Volumes are those of the second
 * point of a pair: 1 - volume makes it that of the sample. */
INLINE void project_sample(struct fluid *f, int i, struct near *near, int *front) {
    const pdyn_neighbours *l = f->lists;
    struct sum sum = {0};
    v4 at;
    v4_set(&at, f->x + 4 * (size_t)i, 1.0 - f->x[4 * (size_t)i + 3]);
    add_neighbours(f, &at, l->start[i], l->surface_start[i], l->surface_support, evaluate_surface,
                   near, front, &sum);
    f->pair_end[i] = *front;
    f->held[i] = f->params.stiffness * sum.members;
}

WIDE static void project_block(void *arg, int first, int last, int block) {
    struct fluid *f = ((const struct fluid_call *)arg)->f;
    struct near near;
    double energy = 0.0;
    int front = f->block_start[block];
    for (int i = first; i < last; i++) {
        f->pair_start[i] = front;
        if (is_fluid(f, i)) energy += project_fluid(f, i, &near, &front);
        else project_sample(f, i, &near, &front);
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

/* Of the constraint of the particle at `at` on a part of its list. flux: its multiplier, N m. */
INLINE void push_points(const struct fluid *f, const v4 *at, int first, int last, double reach,
                        evaluate_fn *evaluate, double flux, double *force) {
    const int *list = f->lists->index + first;
    struct near near;
    for (int s = 0; s < last - first; s += CHUNK) {
        int count = chunk_of(last - first, s);
        int inside = evaluate_near(f, at, list + s, count, reach, evaluate, &near);
        for (int k = 0; k < inside; k++) {
            double *to = force + 3 * (size_t)(near.index[k] - f->particles);
            to[0] += flux * near.x[k], to[1] += flux * near.y[k], to[2] += flux * near.z[k];
        }
    }
}

/* C_i depends on x_i - x_b alone: its gradient with respect to x_b is minus that of the pair with
 * respect to x_i, as the local step has it, to the last bit. Serial, in the order of particles: the
 * sums do not depend on the number of threads. */
WIDE static void push_boundary(const struct fluid *f, double *force) {
    const pdyn_neighbours *l = f->lists;
    for (int i = f->first; i < f->first + f->count; i++) {
        v4 at;
        if (f->flux[i] == 0.0) continue;
        v4_set(&at, f->x + 4 * (size_t)i, 0.0);
        push_points(f, &at, l->boundary_start[i], l->patch_start[i], l->support, evaluate_particles,
                    f->flux[i], force);
        push_points(f, &at, l->patch_start[i], l->end[i], l->surface_support, evaluate_areas,
                    f->flux[i], force);
    }
}

void fluid_boundary_force(void *self, double *force) { push_boundary(self, force); }
