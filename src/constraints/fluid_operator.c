/* The density constraint as an operator: a row for every particle of every constraint would be some
 * 30 rows a particle. What is kept instead, for every pair inside the support, is the gradient of
 * the kernel and its value; all displacements u - p of constraint i are t_i times that. Every pass
 * runs over the pairs of a particle and writes only to it.
 *
 * Pairs are kept in single precision, sums and everything else in double; a pair is the same in
 * both directions and everywhere it is used, so momentum and symmetry hold as in double. Memory: 25
 * bytes per listed neighbour, 153 per particle of the system and 32 per boundary point. */
#include "../core/simd.h"
#include "fluid.h"
#include "projdyn/vec3.h"

enum { GRAIN = 128, CHUNK = 64 };

struct fluid {
    const pdyn_services *services;
    const pdyn_neighbours *lists;
    struct fluid_params params;
    struct kernel kernel;       /* times the volume of a particle */
    int first, count;           /* the fluid's particles in the system */
    int particles, points;      /* of the system; with the boundary */
    double rest_density;        /* kg/m^3 */
    double particle_volume;     /* m^3 */
    unsigned boundary;          /* revision of the boundary points in x */
    size_t pairs;               /* capacity of what is kept per listed neighbour */
    int *block_start;           /* blocks + 1: first pair of each block of GRAIN particles */
    int *pair_start, *pair_end; /* particles: its pairs inside the support, packed by blocks; the
                                   neighbours outside follow from the end of the block backwards */
    int *pair_index;            /* pairs */
    float *pair_gradient;       /* pairs x 3: grad W(x_i - x_j) times the volume of the
                                   one that is no fluid (of fluid: 1), 1/m */
    float *pair_value;          /* pairs: W */
    double *x;                  /* points x 4: where the last local step was, and the volume */
    double *gradient;           /* particles x 4: grad C_i with respect to x_i, 1/m, and 0 */
    double *before;    /* particles x 4: velocities before viscosity, and 1; 0 if not fluid */
    double *value;     /* particles: C_i, negative where there is room */
    double *stiffness; /* particles: w / |grad C_i|^2, N m */
    double *flux;      /* particles: what constraint i gives along its gradient; 0: none */
    double *members;   /* particles: in how many constraints a particle takes part */
    double *reached;   /* particles: C_i in the linear model, where the solver is */
    double *rate;      /* particles: grad C_i . u for the u it aims along */
    bool *active;      /* particles: C_i counts there */
    double *partial;   /* two partial sums for each parallel block */
};

struct call { /* arguments of a parallel loop */
    struct fluid *f;
    const double *in;
    double *out;
    double eps, t;
};

static bool is_fluid(const struct fluid *f, int i) {
    return i >= f->first && i < f->first + f->count;
}

static void for_particles(struct fluid *f, int count, pdyn_range_fn *fn, const double *in,
                          double *out, double eps) {
    struct call call = {f, in, out, eps, 0.0};
    f->services->parallel_for(f->services->core, count, GRAIN, fn, &call);
}

static double sum_partial(const struct fluid *f, int count) {
    double sum = 0.0;
    for (int b = 0; b * GRAIN < count; b++) sum += f->partial[b];
    return sum;
}

/* ---- memory ---------------------------------------------------------------------------------- */

static void *resize(struct fluid *f, void *block, size_t old_count, size_t count, size_t size) {
    return f->services->allocate(f->services->core, block, old_count * size, count * size);
}

/* Every array that is as long as the particles or the points, made or freed. */
static bool resize_particles(struct fluid *f, size_t particles, size_t points, bool make) {
    struct {
        void **array;
        size_t count, size;
    } all[] = {
        {(void **)&f->block_start, particles / GRAIN + 2, sizeof(int)},
        {(void **)&f->pair_start, particles, sizeof(int)},
        {(void **)&f->pair_end, particles, sizeof(int)},
        {(void **)&f->x, 4 * points, sizeof(double)},
        {(void **)&f->gradient, 4 * particles, sizeof(double)},
        {(void **)&f->before, 4 * particles, sizeof(double)},
        {(void **)&f->value, particles, sizeof(double)},
        {(void **)&f->stiffness, particles, sizeof(double)},
        {(void **)&f->flux, particles, sizeof(double)},
        {(void **)&f->members, particles, sizeof(double)},
        {(void **)&f->reached, particles, sizeof(double)},
        {(void **)&f->rate, particles, sizeof(double)},
        {(void **)&f->active, particles, sizeof(bool)},
        {(void **)&f->partial, 2 * (particles / GRAIN + 1), sizeof(double)},
    };
    bool good = true;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        *all[k].array =
            resize(f, *all[k].array, make ? 0 : all[k].count, make ? all[k].count : 0, all[k].size);
        good &= *all[k].array != NULL;
    }
    return good;
}

static void release_pairs(struct fluid *f) {
    if (!f->pairs) return;
    f->pair_index = resize(f, f->pair_index, f->pairs, 0, sizeof(int));
    f->pair_gradient = resize(f, f->pair_gradient, 3 * f->pairs + 1, 0, sizeof(float));
    f->pair_value = resize(f, f->pair_value, f->pairs, 0, sizeof(float));
}

static void release(void *self) {
    struct fluid *f = self;
    release_pairs(f);
    resize_particles(f, (size_t)f->particles, (size_t)f->points, false);
    resize(f, f, 1, 0, sizeof *f);
}

static void *create(const void *par, const pdyn_body *body, const pdyn_services *services) {
    struct fluid *f = services->allocate(services->core, NULL, 0, sizeof *f);
    if (!f) return NULL;
    f->services = services;
    f->params = *(const struct fluid_params *)par;
    f->kernel = fluid_kernel(body);
    f->particle_volume = fluid_particle_volume(body);
    f->first = body->first, f->count = body->count;
    f->rest_density = body->rest_density;
    return f;
}

static void set_points(struct fluid *f) {
    f->boundary = f->lists->boundary_revision;
    for (int i = 0; i < f->points; i++) {
        const double *x = f->lists->boundary_x + 3 * (i - f->particles);
        for (int a = 0; i >= f->particles && a < 3; a++) f->x[4 * i + a] = x[a];
        f->x[4 * i + 3] = f->lists->volume[i] / f->particle_volume;
    }
}

/* Boundary points that have moved since the last local step. */
static void follow_boundary(struct fluid *f) {
    if (f->boundary == f->lists->boundary_revision) return;
    for (int i = f->particles; i < f->points; i++)
        memcpy(f->x + 4 * i, f->lists->boundary_x + 3 * (i - f->particles), 3 * sizeof *f->x);
    f->boundary = f->lists->boundary_revision;
}

/* Gives every block of particles a part of the pairs; returns how many there are. */
static size_t place_blocks(struct fluid *f) {
    const pdyn_neighbours *l = f->lists;
    for (int b = 0; b * GRAIN < f->particles; b++) {
        int pairs = 0, last = (b + 1) * GRAIN < f->particles ? (b + 1) * GRAIN : f->particles;
        for (int i = b * GRAIN; i < last; i++) pairs += l->boundary_start[i] - l->start[i];
        f->block_start[b + 1] = f->block_start[b] + pairs;
    }
    return (size_t)f->block_start[(f->particles + GRAIN - 1) / GRAIN];
}

static bool neighbours(void *self, const pdyn_neighbours *lists) {
    struct fluid *f = self;
    f->lists = lists;
    if (!f->x) {
        f->particles = lists->particles, f->points = lists->points;
        if (!resize_particles(f, (size_t)f->particles, (size_t)f->points, true)) return false;
        set_points(f);
    }
    size_t pairs = place_blocks(f);
    if (pairs <= f->pairs) return true;
    release_pairs(f);
    f->pairs = pairs + pairs / 4; /* room, so that a warmed-up step allocates nothing */
    f->pair_index = resize(f, NULL, 0, f->pairs, sizeof(int));
    f->pair_gradient = resize(f, NULL, 0, 3 * f->pairs + 1, sizeof(float)); /* loads of four */
    f->pair_value = resize(f, NULL, 0, f->pairs, sizeof(float));
    return f->pair_index && f->pair_gradient && f->pair_value;
}

/* ---- local step ------------------------------------------------------------------------------ */

/* A few neighbours side by side. */
struct near {
    double d[CHUNK][4]; /* distance vector, m, and minus the volume of the one that is no fluid */
    double squared[CHUNK], value[CHUNK], slope[CHUNK];
    int index[CHUNK];
};

/* A sum over the neighbours of one particle i. */
struct sum {
    double c;       /* C_i, not clipped */
    v4 gradient;    /* of C_i with respect to x_i, 1/m */
    double squares; /* |grad C_i|^2 over the moving neighbours, 1/m^2 */
    int members;    /* fluid particles among these */
};

/* Distances from `at` to `count` points; those inside the support come first in `near`, the index
 * of the others goes to `outside`. Returns how many are inside. */
INLINE int pick_near(const struct fluid *f, const v4 *at, const int *index, int count,
                     struct near *near, int *outside) {
    double limit = f->kernel.support * f->kernel.support;
    int inside = 0, others = 0;
    for (int k = 0; k < count; k++) {
        v4 d;
        memcpy(&d, f->x + 4 * index[k], sizeof d);
        d = *at - d;
        double squared = v4_dot(&d, &d);
        memcpy(near->d[inside], &d, sizeof d);
        near->squared[inside] = squared, near->index[inside] = index[k];
        outside[others] = index[k];
        inside += squared < limit, others += !(squared < limit);
    }
    return inside;
}

INLINE void evaluate(const struct kernel *kernel, int count, struct near *near) {
    for (int k = 0; k < count; k++) {
        double q = sqrt(near->squared[k]) * kernel->inverse, rest = 1.0 - q;
        near->value[k] =
            kernel->value * (q <= 0.5 ? 1.0 - 6.0 * q * q * rest : 2.0 * rest * rest * rest);
        near->slope[k] = kernel->slope * (q <= 0.5 ? 3.0 * q - 2.0 : -rest * rest / q);
    }
}

/* Adds the neighbours in `near`; keeps their kernels from `pair` on. */
INLINE void add_near(struct fluid *f, const struct near *near, int count, struct sum *sum,
                     size_t pair) {
    for (int k = 0; k < count; k++) {
        v4 d;
        memcpy(&d, near->d[k], sizeof d);
        double volume = -d[3];
        v4 g = volume * near->slope[k] * d;
        v4f kept = __builtin_convertvector(g, v4f);
        memcpy(f->pair_gradient + 3 * (pair + (size_t)k), &kept, 3 * sizeof(float));
        g = __builtin_convertvector(kept, v4);
        f->pair_value[pair + (size_t)k] = (float)near->value[k];
        f->pair_index[pair + (size_t)k] = near->index[k];
        sum->c += volume * near->value[k];
        sum->gradient += g;
        sum->squares += v4_dot(&g, &g);
        sum->members += is_fluid(f, near->index[k]);
    }
}

INLINE void add_boundary(const struct fluid *f, const v4 *at, int i, struct near *near,
                         struct sum *sum) {
    const pdyn_neighbours *l = f->lists;
    int outside[CHUNK];
    for (int s = l->boundary_start[i]; s < l->end[i]; s += CHUNK) {
        int left = l->end[i] - s;
        int inside = pick_near(f, at, l->index + s, left < CHUNK ? left : CHUNK, near, outside);
        evaluate(&f->kernel, inside, near);
        for (int k = 0; k < inside; k++) {
            v4 d;
            memcpy(&d, near->d[k], sizeof d);
            sum->c -= d[3] * near->value[k];
            sum->gradient -= d[3] * near->slope[k] * d;
        }
    }
}

/* C_i and its gradient at x. Keeps the pairs of i in the part [*front, *back) of a block. */
INLINE struct sum sum_at(struct fluid *f, int i, struct near *near, int *front, int *back) {
    const pdyn_neighbours *l = f->lists;
    struct sum sum = {.c = f->x[4 * i + 3] * f->kernel.value - 1.0, .members = is_fluid(f, i)};
    int outside[CHUNK];
    v4 at;
    v4_set(&at, f->x + 4 * i, is_fluid(f, i) ? 0.0 : 1.0 - f->x[4 * i + 3]);
    f->pair_start[i] = *front;
    for (int s = l->start[i]; s < l->boundary_start[i]; s += CHUNK) {
        int left = l->boundary_start[i] - s, count = left < CHUNK ? left : CHUNK;
        int inside = pick_near(f, &at, l->index + s, count, near, outside);
        evaluate(&f->kernel, inside, near);
        add_near(f, near, inside, &sum, (size_t)*front);
        *front += inside, *back -= count - inside;
        memcpy(f->pair_index + *back, outside, (size_t)(count - inside) * sizeof *outside);
    }
    f->pair_end[i] = *front, f->members[i] = sum.members;
    if (!is_fluid(f, i)) return sum;
    add_boundary(f, &at, i, near, &sum);
    sum.gradient[3] = 0.0;
    sum.squares += v4_dot(&sum.gradient, &sum.gradient);
    return sum;
}

/* Sum of the volumes times W of `count` points seen from `at`, each displaced by t times its kept
 * gradient; no gradients: not displaced. */
INLINE double density_from(const struct fluid *f, const v4 *at, const int *index,
                           const float *gradients, int count, double t) {
    double squared[CHUNK], volume[CHUNK], sum = 0.0;
    for (int done = 0; done < count; done += CHUNK) {
        int n = count - done < CHUNK ? count - done : CHUNK;
        for (int k = 0; k < n; k++) {
            v4 d;
            memcpy(&d, f->x + 4 * index[done + k], sizeof d);
            volume[k] = d[3];
            d = *at - d;
            if (gradients) {
                v4f g;
                memcpy(&g, gradients + 3 * (done + k), sizeof g);
                d -= t * __builtin_convertvector(g, v4);
            }
            squared[k] = v4_dot(&d, &d);
        }
        for (int k = 0; k < n; k++) {
            double q = sqrt(squared[k]) * f->kernel.inverse, rest = q < 1.0 ? 1.0 - q : 0.0;
            volume[k] *=
                f->kernel.value * (q <= 0.5 ? 1.0 - 6.0 * q * q * rest : 2.0 * rest * rest * rest);
        }
        for (int k = 0; k < n; k++) sum += volume[k];
    }
    return sum;
}

struct line { /* p = u - t grad C of one constraint */
    const struct fluid *f;
    int i;
    const int *outside; /* neighbours that are not among the pairs */
    int others;
};

WIDE static double value_on_line(const void *arg, double t) {
    const struct line *line = arg;
    const struct fluid *f = line->f;
    const pdyn_neighbours *l = f->lists;
    int i = line->i, start = f->pair_start[i], boundary = l->boundary_start[i];
    v4 at, gradient;
    v4_set(&at, f->x + 4 * i, 0.0);
    memcpy(&gradient, f->gradient + 4 * i, sizeof gradient);
    at -= t * gradient;
    return f->x[4 * i + 3] * f->kernel.value - 1.0 +
           density_from(f, &at, f->pair_index + start, f->pair_gradient + 3 * (size_t)start,
                        f->pair_end[i] - start, t) +
           density_from(f, &at, line->outside, NULL, line->others, 0.0) +
           density_from(f, &at, l->index + boundary, NULL, l->end[i] - boundary, 0.0);
}

/* Projects constraint i; returns its energy. */
static double project_constraint(struct fluid *f, int i, const struct sum *sum, const int *outside,
                                 int others) {
    struct line line = {f, i, outside, others};
    double w = f->params.stiffness, squares = sum->squares;
    memcpy(f->gradient + 4 * i, &sum->gradient, sizeof sum->gradient);
    f->value[i] = f->reached[i] = sum->c;
    f->stiffness[i] = squares > 0.0 ? w / squares : 0.0;
    f->active[i] = sum->c > 0.0 && squares > 0.0;
    f->flux[i] = 0.0;
    if (!f->active[i]) return 0.0;
    double t = fluid_root(value_on_line, &line, sum->c, squares, f->params.projection_tolerance);
    f->flux[i] = w * t;
    return 0.5 * w * t * t * squares;
}

static void set_positions(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) memcpy(c->f->x + 4 * i, c->in + 3 * i, 3 * sizeof *c->in);
}

WIDE static void local_project(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct near near;
    struct fluid *f = c->f;
    double energy = 0.0;
    int front = f->block_start[block], back = f->block_start[block + 1];
    for (int i = first; i < last; i++) {
        int last_back = back;
        struct sum sum = sum_at(f, i, &near, &front, &back);
        if (is_fluid(f, i))
            energy += project_constraint(f, i, &sum, f->pair_index + back, last_back - back);
    }
    f->partial[block] = energy;
}

/* ---- the passes over pairs --------------------------------------------------------------------
 */

/* Sums over the pairs of a particle run in several lanes, so that no addition waits for the one
 * before. */
enum { LANES = 4 };

INLINE void load_gradient(const struct fluid *f, int pair, v4 *out) {
    v4f g;
    memcpy(&g, f->pair_gradient + 3 * (size_t)pair, sizeof g);
    *out = __builtin_convertvector(g, v4);
}

INLINE void add_product(const struct fluid *f, int pair, const double *u, v4 *sum) {
    v4 g, v;
    load_gradient(f, pair, &g);
    memcpy(&v, u + 3 * f->pair_index[pair], sizeof v);
    *sum += g * v;
}

INLINE void add_flux(const struct fluid *f, int pair, const double *flux, v4 *sum) {
    v4 g;
    load_gradient(f, pair, &g);
    *sum += flux[f->pair_index[pair]] * g;
}

typedef void add_fn(const struct fluid *f, int pair, const double *values, v4 *sum);

INLINE void sum_pairs(const struct fluid *f, int i, add_fn *add, const double *values, v4 *out) {
    v4 sum[LANES] = {{0}};
    int s = f->pair_start[i], end = f->pair_end[i];
    for (; s + LANES <= end; s += LANES)
        for (int k = 0; k < LANES; k++) add(f, s + k, values, &sum[k]);
    for (; s < end; s++) add(f, s, values, &sum[0]);
    *out = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* grad C_i . u over all particles of constraint i; the fourth lane of the sum is that of others */
INLINE double divergence(const struct fluid *f, int i, const double *u) {
    v4 sum;
    sum_pairs(f, i, add_product, u, &sum);
    return vec3_dot(f->gradient + 4 * i, u + 3 * i) - (sum[0] + sum[1] + sum[2]);
}

WIDE static void apply_divergence(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct fluid *f = c->f;
    for (int i = f->first + first; i < f->first + last; i++)
        f->flux[i] =
            f->active[i] ? (1.0 - c->eps) * f->stiffness[i] * divergence(f, i, c->in) : 0.0;
}

/* How fast the constraints change along u. */
WIDE static void rate_divergence(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct fluid *f = c->f;
    for (int i = f->first + first; i < f->first + last; i++)
        f->rate[i] = f->stiffness[i] > 0.0 ? divergence(f, i, c->in) : 0.0;
}

/* Slope and curvature of the model's energy at t along the rates. */
WIDE static void model_slope(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const struct fluid *f = c->f;
    double slope = 0.0, curvature = 0.0;
    for (int i = f->first + first; i < f->first + last; i++) {
        double there = f->reached[i] + c->t * f->rate[i];
        double k = there > 0.0 ? f->stiffness[i] * f->rate[i] : 0.0;
        slope += k * there, curvature += k * f->rate[i];
    }
    c->f->partial[2 * block] = slope, c->f->partial[2 * block + 1] = curvature;
}

/* Goes t along the rates; the flux is what that changes. */
static void model_go(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct fluid *f = c->f;
    double changed = 0.0;
    for (int i = f->first + first; i < f->first + last; i++) {
        double from = f->reached[i], to = from + c->t * f->rate[i];
        bool active = to > 0.0 && f->stiffness[i] > 0.0;
        f->flux[i] = (1.0 - c->eps) * f->stiffness[i] * (fmax(0.0, to) - fmax(0.0, from));
        changed += active != f->active[i];
        f->reached[i] = to, f->active[i] = active;
    }
    f->partial[block] = changed;
}

static void add_damping(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    double w = c->eps * c->f->params.stiffness;
    for (int i = first; i < last; i++)
        vec3_add(c->out + 3 * i, w * c->f->members[i], c->in + 3 * i);
}

/* out += sum of flux times gradient over all constraints of a particle */
WIDE static void add_gradients(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct fluid *f = c->f;
    for (int i = first; i < last; i++) {
        v4 sum, own;
        sum_pairs(f, i, add_flux, f->flux, &sum);
        memcpy(&own, f->gradient + 4 * i, sizeof own);
        sum += f->flux[i] * own;
        v4_add_to(c->out + 3 * i, &sum);
    }
}

static double local(void *self, const double *x, double *gradient) {
    struct fluid *f = self;
    follow_boundary(f);
    for_particles(f, f->particles, set_positions, x, NULL, 0.0);
    for_particles(f, f->particles, local_project, NULL, NULL, 0.0);
    for_particles(f, f->particles, add_gradients, NULL, gradient, 0.0);
    return sum_partial(f, f->particles);
}

/* ---- the product: a divergence, then a pressure gradient --------------------------------------
 */

static void damp(struct fluid *f, double eps, const double *u, double *y) {
    if (eps > 0.0) for_particles(f, f->particles, add_damping, u, y, eps);
}

static void apply(void *self, double eps, const double *u, double *y) {
    struct fluid *f = self;
    for_particles(f, f->count, apply_divergence, u, NULL, eps);
    for_particles(f, f->particles, add_gradients, NULL, y, 0.0);
    damp(f, eps, u, y);
}

static void aim(void *self, double eps, const double *u, double *y) {
    struct fluid *f = self;
    if (eps < 1.0) for_particles(f, f->count, rate_divergence, u, NULL, eps);
    damp(f, eps, u, y);
}

static void for_model(struct fluid *f, double eps, double t, pdyn_range_fn *fn) {
    struct call call = {.f = f, .eps = eps, .t = t};
    f->services->parallel_for(f->services->core, f->count, GRAIN, fn, &call);
}

static double slope(void *self, double eps, double t, double *curvature) {
    struct fluid *f = self;
    double sum = *curvature = 0.0;
    if (eps == 1.0) return 0.0;
    for_model(f, eps, t, model_slope);
    for (int b = 0; b * GRAIN < f->count; b++)
        sum += f->partial[2 * b], *curvature += f->partial[2 * b + 1];
    *curvature *= 1.0 - eps;
    return (1.0 - eps) * sum;
}

static int go(void *self, double eps, double t, double *y) {
    struct fluid *f = self;
    if (eps == 1.0) return 0;
    for_model(f, eps, t, model_go);
    int changed = (int)sum_partial(f, f->count);
    for_particles(f, f->particles, add_gradients, NULL, y, 0.0);
    return changed;
}

static void active_stiffness(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct fluid *f = c->f;
    for (int i = f->first + first; i < f->first + last; i++)
        f->flux[i] = f->active[i] ? (1.0 - c->eps) * f->stiffness[i] : 0.0;
}

INLINE void add_outer_product(v4 sum[3], double scale, const v4 *a) {
    for (int k = 0; k < 3; k++) sum[k] += scale * (*a)[k] * *a;
}

WIDE static void diagonal_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct fluid *f = c->f;
    for (int i = first; i < last; i++) {
        v4 sum[3] = {{0}}, g;
        for (int s = f->pair_start[i]; s < f->pair_end[i]; s++) {
            load_gradient(f, s, &g);
            add_outer_product(sum, f->flux[f->pair_index[s]], &g);
        }
        memcpy(&g, f->gradient + 4 * i, sizeof g);
        add_outer_product(sum, f->flux[i], &g);
        double *D = c->out + 6 * i, damped = c->eps * f->params.stiffness * f->members[i];
        D[0] += sum[0][0] + damped, D[1] += sum[0][1], D[2] += sum[0][2];
        D[3] += sum[1][1] + damped, D[4] += sum[1][2], D[5] += sum[2][2] + damped;
    }
}

static void diagonal(void *self, double eps, double *blocks) {
    struct fluid *f = self;
    for_particles(f, f->count, active_stiffness, NULL, NULL, eps);
    for_particles(f, f->particles, diagonal_blocks, NULL, blocks, eps);
}

/* ---- measures and viscosity ------------------------------------------------------------------ */

static void density(void *self, double *out) {
    const struct fluid *f = self;
    for (int i = f->first; i < f->first + f->count; i++)
        out[i] = f->rest_density * (1.0 + f->value[i]);
}

/* The constraint does the work of a pressure: flux dC = -p dV, and dC = -dV / V. */
static void pressure(void *self, double *out) {
    const struct fluid *f = self;
    for (int i = f->first; i < f->first + f->count; i++) out[i] = f->flux[i] / f->particle_volume;
}

/* XSPH (Schechter & Bridson 2012) between fluid particles, at rest density: the exchange of a pair
 * is the same on both sides, so momentum stays. */
WIDE static void add_viscosity(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct fluid *f = c->f;
    for (int i = f->first + first; i < f->first + last; i++) {
        v4 sum = {0}, own;
        for (int s = f->pair_start[i]; s < f->pair_end[i]; s++) {
            v4 v;
            memcpy(&v, f->before + 4 * f->pair_index[s], sizeof v);
            sum += (double)f->pair_value[s] * v;
        }
        v4_set(&own, c->out + 3 * i, 0.0);
        sum = f->params.viscosity * (sum - sum[3] * own);
        v4_add_to(c->out + 3 * i, &sum);
    }
}

static void velocity(void *self, double *v) {
    struct fluid *f = self;
    if (f->params.viscosity == 0.0) return;
    for (int i = 0; i < f->particles; i++) {
        v4 before = {0};
        if (is_fluid(f, i)) v4_set(&before, v + 3 * i, 1.0);
        memcpy(f->before + 4 * i, &before, sizeof before);
    }
    for_particles(f, f->count, add_viscosity, NULL, v, 0.0);
}

const pdyn_operator fluid_operator = {
    .create = create,
    .free = release,
    .neighbours = neighbours,
    .local = local,
    .apply = apply,
    .aim = aim,
    .slope = slope,
    .go = go,
    .diagonal = diagonal,
    .density = density,
    .pressure = pressure,
    .velocity = velocity,
};
