/* The local step of the fluid: from positions to constraints, their gradients and projections. */
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

/* Those of `count` points that lie inside the support around `at` go to near->index. No branch
 * depends on which: it would be guessed wrong half the time. */
INLINE int pick_near(const struct fluid *f, const v4 *at, const int *list, int count,
                     struct near *near) {
    double limit = f->kernel.support * f->kernel.support;
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

/* Kernel and gradients of those inside; up to the next four beyond, zeros. */
INLINE void evaluate(const struct fluid *f, const v4 *at, int inside, struct near *near) {
    const struct kernel *kernel = &f->kernel;
    int filled[4], padded = (inside + 3) / 4 * 4;
    for (int k = 0; k < padded; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four(near->index, k, inside, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
        memcpy(near->x + k, &d[0], sizeof d[0]);
        memcpy(near->y + k, &d[1], sizeof d[1]);
        memcpy(near->z + k, &d[2], sizeof d[2]);
        memcpy(near->volume + k, &d[3], sizeof d[3]);
    }
    for (int k = 0; k < padded; k++) {
        double q = sqrt(near->squared[k]) * kernel->inverse, rest = 1.0 - q;
        double value = q <= 0.5 ? 1.0 - 6.0 * q * q * rest : 2.0 * rest * rest * rest;
        double slope = q <= 0.5 ? 3.0 * q - 2.0 : -rest * rest / q;
        near->value[k] = kernel->value * value;
        near->slope[k] = kernel->slope * slope;
    }
    for (int k = inside; k < padded; k++) near->value[k] = near->slope[k] = 0.0;
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

/* The moving neighbours of i, kept as its pairs from *front on. */
INLINE void add_moving(struct fluid *f, int i, const v4 *at, const int *list, int count,
                       struct near *near, int *front, struct sum *sum) {
    f->pair_start[i] = *front;
    for (int s = 0; s < count; s += CHUNK) {
        int inside = pick_near(f, at, list + s, count - s < CHUNK ? count - s : CHUNK, near);
        evaluate(f, at, inside, near);
        for (int k = 0; k < inside; k++) near->slope[k] *= -near->volume[k];
        round_gradients(near, inside);
        add_lanes(near, (inside + 3) / 4 * 4, sum);
        keep_pairs(f, near, inside, *front, sum);
        *front += inside;
    }
    f->pair_end[i] = f->pair_last[i] = *front;
}

/* Boundary points enter the density with their volume, and have no squares: they do not move. Their
 * pairs, kept from *front on, are for their own constraints. */
INLINE void add_boundary(struct fluid *f, int i, const v4 *at, struct near *near, int *front,
                         struct sum *sum) {
    const pdyn_neighbours *l = f->lists;
    double squares = sum->squares;
    for (int s = l->boundary_start[i]; s < l->end[i]; s += CHUNK) {
        int left = l->end[i] - s;
        int inside = pick_near(f, at, l->index + s, left < CHUNK ? left : CHUNK, near);
        evaluate(f, at, inside, near);
        round_gradients(near, inside);
        if (f->params.wall_pressure) {
            keep_pairs(f, near, inside, *front, sum);
            *front += inside, sum->members += inside;
        }
        for (int k = 0; k < inside; k++)
            near->x[k] *= -near->volume[k], near->y[k] *= -near->volume[k],
                near->z[k] *= -near->volume[k];
        add_lanes(near, (inside + 3) / 4 * 4, sum);
    }
    sum->squares = squares;
    f->pair_last[i] = *front;
}

/* ---- projection ------------------------------------------------------------------------------ */

struct line { /* p = u - t grad C of one constraint */
    const struct fluid *f;
    int i;
};

/* W of a neighbour at x_j + t shift, seen from `at`, times its volume. */
INLINE double value_at(const struct fluid *f, const v4 *at, int j, double t, const v4 *shift) {
    v4 d, x;
    memcpy(&x, f->x + 4 * (size_t)j, sizeof x);
    d = *at - x - t * *shift;
    return x[3] * kernel_value(&f->kernel, sqrt(v4_dot(&d, &d)));
}

/* The volumes' kernels on the line. Pairs move; what was outside the support at u rests, but i
 * itself moves. */
static double value_on_line(const void *arg, double t) {
    const struct line *line = arg;
    const struct fluid *f = line->f;
    const pdyn_neighbours *l = f->lists;
    int i = line->i;
    double sum = f->x[4 * (size_t)i + 3] * f->kernel.value - 1.0;
    v4 at, from, own, none = {0};
    v4_set(&from, f->x + 4 * i, 0.0);
    memcpy(&own, f->gradient + 4 * i, sizeof own);
    at = from - t * own;
    for (int s = f->pair_start[i]; s < f->pair_end[i]; s++) {
        v4 g;
        load_pair(f, s, &g);
        sum += value_at(f, &at, f->pair_index[s], t, &g);
    }
    for (int s = l->start[i]; s < l->end[i]; s++) {
        bool moving = s < l->boundary_start[i];
        v4 d, x;
        memcpy(&x, f->x + 4 * (size_t)l->index[s], sizeof x);
        d = from - x;
        if (moving && v4_dot(&d, &d) < f->kernel.support * f->kernel.support) continue;
        sum += value_at(f, &at, l->index[s], 0.0, &none);
    }
    return sum;
}

/* What a boundary point b feels of the fluid that moves along the line. */
static double value_at_wall(const void *arg, double t) {
    const struct line *line = arg;
    const struct fluid *f = line->f;
    double sum = -f->walls.share[line->i - f->particles];
    v4 at, g;
    v4_set(&at, f->x + 4 * (size_t)line->i, 0.0);
    for (int s = f->pair_start[line->i]; s < f->pair_end[line->i]; s++) {
        load_pair(f, s, &g);
        sum += value_at(f, &at, f->pair_index[s], t, &g);
    }
    return sum;
}

/* Projects constraint i; returns its energy. */
INLINE double set_constraint(struct fluid *f, int i, const struct sum *sum,
                             double (*value)(const void *line, double t)) {
    struct line line = {f, i};
    double w = f->params.stiffness;
    f->error[i] = f->value[i] = sum->c, f->squares[i] = sum->squares;
    f->stiffness[i] = sum->squares > 0.0 ? w / sum->squares : 0.0;
    f->flux[i] = 0.0;
    if (!(sum->c > 0.0 && sum->squares > 0.0)) return 0.0;
    double t = fluid_root(value, &line, sum->c, sum->squares, f->params.projection_tolerance);
    f->flux[i] = w * t, f->value[i] = t * sum->squares;
    return 0.5 * w * t * t * sum->squares;
}

INLINE double project_constraint(struct fluid *f, int i, const struct sum *sum) {
    v4 gradient = {sum->gradient[0], sum->gradient[1], sum->gradient[2], 0.0};
    memcpy(f->gradient + 4 * i, &gradient, sizeof gradient);
    return set_constraint(f, i, sum, value_on_line);
}

/* C_i and its gradient at x. Keeps the pairs of i from *front on. Returns the energy. */
INLINE double project_particle(struct fluid *f, int i, struct near *near, int *front) {
    const pdyn_neighbours *l = f->lists;
    bool fluid = is_fluid(f, i);
    double volume = f->x[4 * (size_t)i + 3];
    struct sum sum = {.c = volume * f->kernel.value - 1.0, .members = fluid};
    v4 at;
    v4_set(&at, f->x + 4 * (size_t)i, fluid ? 0.0 : 1.0 - volume);
    add_moving(f, i, &at, l->index + l->start[i], l->boundary_start[i] - l->start[i], near, front,
               &sum);
    if (fluid) add_boundary(f, i, &at, near, front, &sum);
    f->held[i] = f->params.stiffness * sum.members;
    if (!fluid) return 0.0;
    sum.squares += vec3_dot(sum.gradient, sum.gradient);
    return project_constraint(f, i, &sum);
}

/* The same of a boundary point, which does not move. */
INLINE double project_wall(struct fluid *f, int i, struct near *near, int *front) {
    const int *start = f->walls.start + (i - f->particles);
    struct sum sum = {.c = 0.0};
    v4 at;
    v4_set(&at, f->x + 4 * (size_t)i, 0.0);
    add_moving(f, i, &at, f->walls.particle + start[0], start[1] - start[0], near, front, &sum);
    sum.c = fluid_walls_see(&f->walls, i - f->particles, sum.c);
    return set_constraint(f, i, &sum, value_at_wall);
}

WIDE static void project_block(void *arg, int first, int last, int block) {
    struct fluid *f = ((const struct fluid_call *)arg)->f;
    struct near near;
    double energy = 0.0;
    int front = f->block_start[block];
    for (int i = first; i < last && i < f->particles; i++)
        energy += project_particle(f, i, &near, &front);
    for (int i = first > f->particles ? first : f->particles; i < last; i++)
        energy += project_wall(f, i, &near, &front);
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
    for_particles(f, constrained_points(f), project_block, NULL, NULL);
    for (int b = 0; b * FLUID_GRAIN < constrained_points(f); b++) sum += f->partial[b];
    return sum;
}
