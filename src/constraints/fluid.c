/* The fluid: a density constraint for every fluid particle i over itself and its neighbours j
 * (Weiler, Koschier, Bender 2016, eq. 6-9),
 *
 *     C_i(x) = max(0, sum_j V_j W(x_i - x_j) - 1),      V: rest volumes, of boundary samples too
 *
 * with u all particles of the constraint. The projection is the paper's Newton iteration on the
 * copies p, from p = u:  p <- p - C grad C / |grad C|^2  until C < projection_tolerance. Its
 * tangent is J = I - n n', n = grad C / |grad C|, so that the newton step couples the fluid along
 * the normals of the constraints; eps = 1 is the paper's D = I, a diagonal.
 *
 * Operator tier: a row for every particle of every constraint would be some 30 rows a particle.
 * What is kept instead: the kernel's slope for every listed pair, and the displacement u - p of
 * every constraint. Both passes of the product run over the pairs of a particle and write only to
 * it. Cloth points have a volume and neighbours, but no constraint of their own; static boundary
 * samples enter the density alone (Akinci et al. 2012). Memory: 36 bytes per listed neighbour and
 * 125 per particle of the system. */
#include "../core/kernel.h"
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { GRAIN = 128, MAX_NEWTON = 20 };

struct params {
    double stiffness, viscosity, projection_tolerance;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1e6, 0, 1e15, "N/m",
     "weight of the density constraint: force per distance from the uncompressed state"},
    {"viscosity", PDYN_REAL, offsetof(struct params, viscosity), false, 0.02, 0, 1, "1",
     "XSPH: how much of the velocity difference to the neighbours a step takes away"},
    {"projection_tolerance", PDYN_REAL, offsetof(struct params, projection_tolerance), false, 1e-6,
     1e-14, 1, "1", "relative density error at which the projection of a constraint ends"},
    {0}};

struct fluid {
    const pdyn_services *services;
    const pdyn_neighbours *lists;
    struct params params;
    struct kernel kernel;
    int first, count;      /* the fluid's particles in the system */
    int particles;         /* of the system */
    double rest_density;   /* kg/m^3 */
    size_t pairs;          /* capacity of what is kept per listed neighbour */
    int *pair_index;       /* pairs: of each list, those inside the support, one after the other */
    int *pair_end;         /* particles: where these end; they start where the list does */
    double *pair_slope;    /* pairs: their W'(r)/r, so that grad W = slope (x_i - x_j), 1/m^5 */
    double *pair_shift;    /* pairs x 3: u - p of x_j in constraint i, m */
    double *x;             /* particles x 3: where the last local step was */
    double *self_gradient; /* particles x 3: the gradient of C_i with respect to x_i, 1/m */
    double *self_shift;    /* particles x 3: u - p of x_i in constraint i, m */
    double *value;         /* particles: C_i, negative where there is room */
    double *stiffness;     /* particles: w / |grad C_i|^2, N m */
    bool *active;          /* particles: C_i counts, at x or where `predict` looked */
    double *flux;          /* particles: stiffness_i (grad C_i . u), N; 0 where not active */
    double *members;       /* particles: in how many constraints a particle takes part */
    double *partial;       /* a partial energy for each parallel block */
};

struct call { /* arguments of a parallel loop */
    struct fluid *f;
    const double *in, *x;
    double *out;
    double eps;
};

static bool is_fluid(const struct fluid *f, int i) {
    return i >= f->first && i < f->first + f->count;
}

static void for_particles(struct fluid *f, int count, pdyn_range_fn *fn, const double *in,
                          const double *x, double *out, double eps) {
    struct call call = {f, in, x, out, eps};
    f->services->parallel_for(f->services->core, count, GRAIN, fn, &call);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static void *resize(struct fluid *f, void *block, size_t old_count, size_t count) {
    return f->services->allocate(f->services->core, block, old_count * sizeof(double),
                                 count * sizeof(double));
}

static int *resize_ints(struct fluid *f, int *block, size_t old_count, size_t count) {
    return f->services->allocate(f->services->core, block, old_count * sizeof(int),
                                 count * sizeof(int));
}

static void release_pairs(struct fluid *f) {
    resize(f, f->pair_slope, f->pairs, 0);
    resize(f, f->pair_shift, 3 * f->pairs, 0);
    resize_ints(f, f->pair_index, f->pairs, 0);
}

static void release(void *self) {
    struct fluid *f = self;
    size_t n = (size_t)f->particles;
    release_pairs(f);
    resize(f, f->x, 3 * n, 0);
    resize(f, f->self_gradient, 3 * n, 0);
    resize(f, f->self_shift, 3 * n, 0);
    resize_ints(f, f->pair_end, n, 0);
    resize(f, f->value, n, 0);
    resize(f, f->stiffness, n, 0);
    f->services->allocate(f->services->core, f->active, n * sizeof(bool), 0);
    resize(f, f->flux, n, 0);
    resize(f, f->members, n, 0);
    resize(f, f->partial, n / GRAIN + 1, 0);
    f->services->allocate(f->services->core, f, sizeof *f, 0);
}

static void *create(const void *par, const pdyn_body *body, const pdyn_services *services) {
    struct fluid *f = services->allocate(services->core, NULL, 0, sizeof *f);
    if (!f) return NULL;
    f->services = services;
    f->params = *(const struct params *)par;
    f->kernel = kernel_make(4.0 * body->radius);
    f->first = body->first, f->count = body->count;
    f->rest_density = body->rest_density;
    return f;
}

static bool reserve_particles(struct fluid *f, int particles) {
    size_t n = (size_t)particles;
    f->particles = particles;
    f->x = resize(f, NULL, 0, 3 * n);
    f->self_gradient = resize(f, NULL, 0, 3 * n);
    f->self_shift = resize(f, NULL, 0, 3 * n);
    f->pair_end = resize_ints(f, NULL, 0, n);
    f->value = resize(f, NULL, 0, n);
    f->stiffness = resize(f, NULL, 0, n);
    f->active = f->services->allocate(f->services->core, NULL, 0, n * sizeof(bool));
    f->flux = resize(f, NULL, 0, n);
    f->members = resize(f, NULL, 0, n);
    f->partial = resize(f, NULL, 0, n / GRAIN + 1);
    return f->x && f->pair_end && f->self_gradient && f->self_shift && f->value && f->stiffness &&
           f->active && f->flux && f->members && f->partial;
}

static bool neighbours(void *self, const pdyn_neighbours *lists) {
    struct fluid *f = self;
    size_t pairs = (size_t)lists->start[lists->particles];
    f->lists = lists;
    if (!f->particles && !reserve_particles(f, lists->particles)) return false;
    if (pairs <= f->pairs) return true;
    release_pairs(f);
    f->pairs = pairs + pairs / 4; /* room, so that a warmed-up step allocates nothing */
    f->pair_slope = resize(f, NULL, 0, f->pairs);
    f->pair_index = resize_ints(f, NULL, 0, f->pairs);
    f->pair_shift = resize(f, NULL, 0, 3 * f->pairs);
    return f->pair_slope && f->pair_index && f->pair_shift;
}

/* ---- local step ------------------------------------------------------------------------------ */

/* A sum over the neighbours of one particle i. */
struct sum {
    double c;           /* C_i, not clipped */
    double gradient[3]; /* of C_i with respect to x_i, 1/m */
    double squares;     /* |grad C_i|^2 over all moving particles of the constraint, 1/m^2 */
};

/* Adds a neighbour of volume V at the distance vector d; returns W'(r)/r. */
static inline double add_neighbour(const struct fluid *f, struct sum *sum, double V,
                                   const double d[3], bool moving) {
    double squared = vec3_dot(d, d);
    if (squared >= f->kernel.support * f->kernel.support) return 0.0;
    double r = sqrt(squared), slope = kernel_slope(&f->kernel, r);
    sum->c += V * kernel_value(&f->kernel, r);
    vec3_add(sum->gradient, V * slope, d);
    if (moving) sum->squares += V * V * slope * slope * squared;
    return slope;
}

static void add_boundary(const struct fluid *f, struct sum *sum, int i, const double p[3]) {
    const pdyn_neighbours *l = f->lists;
    for (int s = l->boundary_start[i]; s < l->start[i + 1]; s++) {
        const double *q = l->boundary_x + 3 * (l->index[s] - l->particles);
        double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
        add_neighbour(f, sum, l->volume[l->index[s]], d, false);
    }
}

/* C_i at x, keeping the kernel slopes of i's particle pairs and counting i's constraints. */
static struct sum sum_at(struct fluid *f, const double *x, int i) {
    const pdyn_neighbours *l = f->lists;
    struct sum sum = {.c = l->volume[i] * kernel_value(&f->kernel, 0.0) - 1.0};
    int members = is_fluid(f, i), end = l->start[i];
    for (int s = l->start[i]; s < l->boundary_start[i]; s++) {
        const double *a = x + 3 * i, *b = x + 3 * l->index[s];
        double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        double slope = add_neighbour(f, &sum, l->volume[l->index[s]], d, true);
        if (slope == 0.0) continue;
        f->pair_index[end] = l->index[s], f->pair_slope[end++] = slope;
        members += is_fluid(f, l->index[s]);
    }
    add_boundary(f, &sum, i, x + 3 * i);
    sum.squares += vec3_dot(sum.gradient, sum.gradient);
    f->members[i] = members;
    f->pair_end[i] = end;
    return sum;
}

/* C_i at the copies p = x - shift. */
static struct sum sum_at_copies(const struct fluid *f, const double *x, int i) {
    const pdyn_neighbours *l = f->lists;
    struct sum sum = {.c = l->volume[i] * kernel_value(&f->kernel, 0.0) - 1.0};
    const double *shift = f->self_shift + 3 * i;
    double p[3] = {x[3 * i] - shift[0], x[3 * i + 1] - shift[1], x[3 * i + 2] - shift[2]};
    for (int s = l->start[i]; s < l->boundary_start[i]; s++) {
        const double *q = x + 3 * l->index[s], *moved = f->pair_shift + 3 * s;
        double d[3] = {p[0] - q[0] + moved[0], p[1] - q[1] + moved[1], p[2] - q[2] + moved[2]};
        add_neighbour(f, &sum, l->volume[l->index[s]], d, true);
    }
    add_boundary(f, &sum, i, p);
    sum.squares += vec3_dot(sum.gradient, sum.gradient);
    return sum;
}

/* shift += t grad C at the copies p = x - shift */
static void move_copies(struct fluid *f, const double *x, int i, double t,
                        const double gradient[3]) {
    const pdyn_neighbours *l = f->lists;
    double p[3];
    memcpy(p, x + 3 * i, sizeof p);
    vec3_add(p, -1.0, f->self_shift + 3 * i);
    for (int s = l->start[i]; s < l->boundary_start[i]; s++) {
        const double *q = x + 3 * l->index[s];
        double *shift = f->pair_shift + 3 * s;
        double d[3] = {p[0] - q[0] + shift[0], p[1] - q[1] + shift[1], p[2] - q[2] + shift[2]};
        vec3_add(shift, -t * l->volume[l->index[s]] * kernel_slope(&f->kernel, vec3_length(d)), d);
    }
    vec3_add(f->self_shift + 3 * i, t, gradient);
}

/* Newton's iteration on constraint i; returns |u - p|^2. */
static double project_constraint(struct fluid *f, const double *x, int i, struct sum sum) {
    const pdyn_neighbours *l = f->lists;
    double *shift = f->self_shift + 3 * i, distance = 0.0;
    int pairs = l->boundary_start[i] - l->start[i];
    memcpy(f->self_gradient + 3 * i, sum.gradient, sizeof sum.gradient);
    f->value[i] = sum.c;
    f->stiffness[i] = sum.squares > 0.0 ? f->params.stiffness / sum.squares : 0.0;
    f->active[i] = sum.c > 0.0 && sum.squares > 0.0;
    if (!f->active[i]) return 0.0;
    memset(shift, 0, 3 * sizeof *shift);
    memset(f->pair_shift + 3 * l->start[i], 0, 3 * (size_t)pairs * sizeof *shift);
    for (int k = 0; k < MAX_NEWTON && sum.squares > 0.0; k++) {
        move_copies(f, x, i, sum.c / sum.squares, sum.gradient);
        if (sum.c < f->params.projection_tolerance) break;
        sum = sum_at_copies(f, x, i);
        if (sum.c < f->params.projection_tolerance) break;
    }
    for (int s = 3 * l->start[i]; s < 3 * l->boundary_start[i]; s++)
        distance += f->pair_shift[s] * f->pair_shift[s];
    return distance + vec3_dot(shift, shift);
}

static void local_project(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct fluid *f = c->f;
    double energy = 0.0;
    for (int i = first; i < last; i++) {
        struct sum sum = sum_at(f, c->x, i);
        if (is_fluid(f, i))
            energy += 0.5 * f->params.stiffness * project_constraint(f, c->x, i, sum);
    }
    f->partial[block] = energy;
}

/* The shifts that all constraints of a particle want. */
static void local_gather(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    for (int i = first; i < last; i++) {
        double sum[3] = {0};
        if (f->active[i]) vec3_add(sum, 1.0, f->self_shift + 3 * i);
        for (int s = l->start[i]; s < l->boundary_start[i]; s++)
            if (f->active[l->index[s]]) vec3_add(sum, 1.0, f->pair_shift + 3 * l->mirror[s]);
        vec3_add(c->out + 3 * i, f->params.stiffness, sum);
    }
}

static double local(void *self, const double *x, double *gradient) {
    struct fluid *f = self;
    memcpy(f->x, x, 3 * (size_t)f->particles * sizeof *x);
    for_particles(f, f->particles, local_project, NULL, x, NULL, 0.0);
    for_particles(f, f->particles, local_gather, NULL, x, gradient, 0.0);
    double energy = 0.0;
    for (int b = 0; b * GRAIN < f->particles; b++) energy += f->partial[b];
    return energy;
}

/* ---- the product: a divergence, then a pressure gradient --------------------------------------
 */

/* grad C_i . u over all particles of constraint i */
static double divergence(const struct fluid *f, int i, const double *u) {
    const pdyn_neighbours *l = f->lists;
    const double *a = f->x + 3 * i;
    double sum = 0.0;
    for (int s = l->start[i]; s < f->pair_end[i]; s++) {
        int j = f->pair_index[s];
        const double *b = f->x + 3 * j, *v = u + 3 * j;
        sum += l->volume[j] * f->pair_slope[s] *
               ((a[0] - b[0]) * v[0] + (a[1] - b[1]) * v[1] + (a[2] - b[2]) * v[2]);
    }
    return vec3_dot(f->self_gradient + 3 * i, u + 3 * i) - sum;
}

static void apply_divergence(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct fluid *f = c->f;
    for (int i = f->first + first; i < f->first + last; i++)
        f->flux[i] =
            f->active[i] ? (1.0 - c->eps) * f->stiffness[i] * divergence(f, i, c->in) : 0.0;
}

/* The flux of the linear model max(0, C_i + grad C_i . d) beyond that at d = 0, and its active set.
 */
static void predict_divergence(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct fluid *f = c->f;
    double changed = 0.0;
    for (int i = f->first + first; i < f->first + last; i++) {
        double there = f->value[i] + divergence(f, i, c->in);
        bool active = there > 0.0 && f->stiffness[i] > 0.0;
        changed += active != f->active[i];
        f->active[i] = active;
        f->flux[i] = (1.0 - c->eps) * f->stiffness[i] * (fmax(0.0, there) - fmax(0.0, f->value[i]));
    }
    f->partial[block] = changed;
}

static void apply_gradient(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    double w = c->eps * f->params.stiffness;
    for (int i = first; i < last; i++) {
        const double *a = f->x + 3 * i;
        double sum[3] = {0};
        for (int s = l->start[i]; s < f->pair_end[i]; s++) {
            const double *b = f->x + 3 * f->pair_index[s],
                         flux = f->flux[f->pair_index[s]] * f->pair_slope[s];
            for (int k = 0; k < 3; k++) sum[k] += flux * (a[k] - b[k]);
        }
        double *y = c->out + 3 * i;
        vec3_add(y, l->volume[i], sum);
        vec3_add(y, f->flux[i], f->self_gradient + 3 * i);
        vec3_add(y, w * f->members[i], c->in + 3 * i);
    }
}

static void apply(void *self, double eps, const double *u, double *y) {
    struct fluid *f = self;
    for_particles(f, f->count, apply_divergence, u, NULL, NULL, eps);
    for_particles(f, f->particles, apply_gradient, u, NULL, y, eps);
}

static int predict(void *self, double eps, const double *d, double *y) {
    struct fluid *f = self;
    for_particles(f, f->count, predict_divergence, d, NULL, NULL, eps);
    for_particles(f, f->particles, apply_gradient, d, NULL, y, eps);
    double changed = 0.0;
    for (int b = 0; b * GRAIN < f->count; b++) changed += f->partial[b];
    return (int)changed;
}

static void add_outer_product(double *block, double scale, const double *a) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; k++) block[k] += scale * a[row[k]] * a[column[k]];
}

static void diagonal_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    for (int i = first; i < last; i++) {
        double *D = c->out + 6 * i, V = l->volume[i], undamped = 1.0 - c->eps;
        if (f->active[i])
            add_outer_product(D, undamped * f->stiffness[i], f->self_gradient + 3 * i);
        for (int s = l->start[i]; s < f->pair_end[i]; s++) {
            const double *a = f->x + 3 * i, *b = f->x + 3 * f->pair_index[s];
            double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]}, g = V * f->pair_slope[s];
            if (f->active[f->pair_index[s]])
                add_outer_product(D, undamped * g * g * f->stiffness[f->pair_index[s]], d);
        }
        double damped = c->eps * f->params.stiffness * f->members[i];
        D[0] += damped, D[3] += damped, D[5] += damped;
    }
}

static void diagonal(void *self, double eps, double *blocks) {
    struct fluid *f = self;
    for_particles(f, f->particles, diagonal_blocks, NULL, NULL, blocks, eps);
}

/* ---- measures and viscosity ------------------------------------------------------------------ */

static void density(void *self, double *out) {
    const struct fluid *f = self;
    for (int i = f->first; i < f->first + f->count; i++)
        out[i] = f->rest_density * (1.0 + f->value[i]);
}

/* XSPH (Schechter & Bridson 2012) between fluid particles, at rest density: the exchange of a pair
 * is the same on both sides, so momentum stays. self_shift is free at this point of a step. */
static void viscosity_change(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    for (int i = f->first + first; i < f->first + last; i++) {
        double *change = f->self_shift + 3 * i;
        memset(change, 0, 3 * sizeof *change);
        for (int s = l->start[i]; s < l->boundary_start[i]; s++) {
            int j = l->index[s];
            if (!is_fluid(f, j)) continue;
            double w = f->params.viscosity * l->volume[j] *
                       kernel_value(&f->kernel, vec3_distance(c->x + 3 * i, c->x + 3 * j));
            for (int k = 0; k < 3; k++) change[k] += w * (c->in[3 * j + k] - c->in[3 * i + k]);
        }
    }
}

static void velocity(void *self, const double *x, double *v) {
    struct fluid *f = self;
    if (f->params.viscosity == 0.0) return;
    for_particles(f, f->count, viscosity_change, v, x, NULL, 0.0);
    for (int i = f->first; i < f->first + f->count; i++)
        vec3_add(v + 3 * i, 1.0, f->self_shift + 3 * i);
}

static const pdyn_operator op = {
    .create = create,
    .free = release,
    .neighbours = neighbours,
    .local = local,
    .apply = apply,
    .predict = predict,
    .diagonal = diagonal,
    .density = density,
    .velocity = velocity,
};

/* ---- the same as rows: for assembly, and to check the operator against -------------------------
 */

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void shape(const void *par, const pdyn_batch *b, int element, int *rows, int *width) {
    (void)par;
    int i = b->body->first + element;
    *rows = 1 + b->neighbours->boundary_start[i] - b->neighbours->start[i];
    *width = 1;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        int row = b->element_row[e], i = b->body->first + e;
        b->column[row] = i;
        for (int r = row + 1; r < b->element_row[e + 1]; r++)
            b->column[r] = b->neighbours->index[b->neighbours->start[i] + r - row - 1];
        for (int r = row; r < b->element_row[e + 1]; r++) b->coefficient[r] = 1.0;
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

/* C of element e with its copies at p (rows x 3, its own first), and grad C into g, rows x 3. */
static double row_density(const pdyn_batch *b, int e, const double *p, double *g) {
    const pdyn_neighbours *l = b->neighbours;
    struct kernel kernel = kernel_make(4.0 * b->body->radius);
    int i = b->body->first + e, moving = l->boundary_start[i] - l->start[i];
    double c = l->volume[i] * kernel_value(&kernel, 0.0) - 1.0;
    memset(g, 0, 3 * sizeof *g);
    for (int k = 0; k < l->start[i + 1] - l->start[i]; k++) {
        int j = l->index[l->start[i] + k];
        const double *q = k < moving ? p + 3 * (1 + k) : l->boundary_x + 3 * (j - l->particles);
        double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]}, r = vec3_length(d);
        double slope = l->volume[j] * kernel_slope(&kernel, r);
        c += l->volume[j] * kernel_value(&kernel, r);
        vec3_add(g, slope, d);
        for (int a = 0; k < moving && a < 3; a++) g[3 * (1 + k) + a] = -slope * d[a];
    }
    return c;
}

static double squares_of(const double *g, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += g[k] * g[k];
    return sum;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    double tolerance = ((const struct params *)par)->projection_tolerance, g[3 * 2048];
    for (int e = first; e < last; e++) {
        int n = 3 * (b->element_row[e + 1] - b->element_row[e]);
        double *p = b->p + 3 * b->element_row[e];
        memcpy(p, b->u + 3 * b->element_row[e], (size_t)n * sizeof *p);
        if (n > 3 * 2048) continue;
        double c = row_density(b, e, p, g), squares = squares_of(g, n);
        for (int k = 0; k < MAX_NEWTON && c > (k ? tolerance : 0.0) && squares > 0.0; k++) {
            for (int a = 0; a < n; a++) p[a] -= c / squares * g[a];
            c = row_density(b, e, p, g), squares = squares_of(g, n);
        }
    }
}

/* J = I - n n' where the constraint is active, otherwise I */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    double g[3 * 2048];
    for (int e = first; e < last; e++) {
        int n = 3 * (b->element_row[e + 1] - b->element_row[e]);
        double c = n > 3 * 2048 ? 0.0 : row_density(b, e, b->u + 3 * b->element_row[e], g);
        double squares = c > 0.0 ? squares_of(g, n) : 0.0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                J[i * n + j] = (i == j) - (squares > 0.0 ? g[i] * g[j] / squares : 0.0);
        J += n * n;
    }
}

const pdyn_constraint_type pdyn_constraint_fluid = {
    .name = "fluid",
    .summary = "an incompressible liquid: SPH density at most the rest density",
    .flags = PDYN_ON_PARTICLES,
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .shape = shape,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .op = &op,
};
