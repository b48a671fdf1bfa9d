/* Incompressible fluid: one density constraint per particle i over the particle and its neighbours
 * j (Weiler, Koschier, Bender 2016, eq. 6-9), with rest volumes V,
 *
 *     C_i(x) = sum_j V_j W(x_i - x_j) - 1 <= 0,      E = k_i/2 max(0, C_i)^2
 *     p = u - (k_i / w) C_i grad C_i,                k_i = w / |grad C_i|^2, bounded (fluid.h)
 *     J = I - (k_i / w) grad C_i grad C_i'           where C_i > 0; elsewhere p = u and J = I
 *
 * u: positions of i, of its neighbours, and of the corners of its samples. p is the first Newton
 * step of that paper. To first order w/2 |u - p|^2 = E; its gradient w (u - p) is exact while k_i
 * is constant. eps = 1 gives the paper's diagonal D = I.
 *
 * Simulations use the matrix-free operator (fluid_operator.c), with k_i of the previous step. The
 * rows of this file take k_i from u. They serve solvers that assemble H, and check the operator.
 * Samples of surfaces have volumes and neighbours but no constraint; static boundary points only
 * add density (Akinci et al. 2012). */
#include "fluid.h"

#include "listed_points.h"

#include "projdyn/kernel.h"

enum { MAX_ROWS = 2048 }; /* of one constraint; with more, C counts as 0 */

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, offsetof(struct fluid_params, stiffness), false, -1, 0,
     FLUID_MAX_STIFFNESS, "N/m",
     "weight of the density constraint: force per distance from the uncompressed state; instead of "
     "compression, and 1e6 by default without gravity"},
    {"compression", PDYN_REAL, offsetof(struct fluid_params, compression), false, 0, 1e-9, 0.5, "1",
     "relative density error at the bottom of the fluid at rest; 0.001 by default, or "
     "less where bodies and solids press more than the fluid does"},
    {"sound_speed", PDYN_REAL, offsetof(struct fluid_params, sound_speed), false, 0, 1e-3, 1e6,
     "m/s", "speed of sound in the fluid; instead of compression"},
    {"viscosity", PDYN_REAL, offsetof(struct fluid_params, viscosity), false, 0.02, 0, 1, "1",
     "fraction of the velocity difference to the neighbours that a step removes (XSPH); the "
     "constraint \"viscosity\" has Pa s"},
    {"damping", PDYN_REAL, offsetof(struct fluid_params, damping), false, -1, 0, 1e6, "s",
     "pressure = bulk modulus (compression + damping x its rate); by default the time in which "
     "sound crosses a cube of the fluid's volume, less the longest step, if at least two steps fit "
     "into it"},
    {0}};

static const char *const alternatives[] = {"stiffness", "compression", "sound_speed", NULL};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

/* A row is one particle; a sample has three, the corners of its triangle. */
static void row_sizes(const void *par, const pdyn_batch *b, int element, int *rows, int *width) {
    (void)par;
    const pdyn_neighbours *l = b->neighbours;
    int i = b->body->first + element;
    *rows =
        1 + l->surface_start[i] - l->start[i] + 3 * (l->boundary_start[i] - l->surface_start[i]);
    *width = 1;
}

static void select_row(const pdyn_batch *b, int row, int particle) {
    b->column[b->row_entry[row]] = particle, b->coefficient[b->row_entry[row]] = 1.0;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    const pdyn_neighbours *l = b->neighbours;
    for (int e = first; e < last; e++) {
        int row = b->element_row[e], i = b->body->first + e;
        select_row(b, row++, i);
        for (int k = l->start[i]; k < l->surface_start[i]; k++) select_row(b, row++, l->index[k]);
        for (int k = l->surface_start[i]; k < l->boundary_start[i]; k++)
            for (int m = 0; m < 3; m++)
                select_row(b, row++, l->sample_vertex[sample_corner(l, l->index[k]) + m]);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct fluid_params *)par)->stiffness;
}

struct kernels { /* of the points around a particle, times the rest volume of a particle */
    struct kernel particle;
    struct surface_kernel area;
    double unit; /* m^3, that volume */
};

struct point {            /* in the list of a particle */
    double at[3];         /* m */
    double volume;        /* relative to that of a particle */
    double growth[9];     /* of a sample: gradient of the volume, corners x 3, 1/m */
    const double *weight; /* of a sample: of its corners; NULL: another point */
};

/* The point of entry k in the list of particle i. u: positions of its rows, of a point that moves.
 */
static struct point point_at(const pdyn_neighbours *l, double unit, int i, int k, const double *u) {
    int j = l->index[k], corner = sample_corner(l, j);
    struct point point = {.volume = l->volume[j] / unit};
    if (k < l->surface_start[i] || k >= l->boundary_start[i]) {
        bool moves = k < l->surface_start[i];
        memcpy(point.at, moves ? u : l->boundary_x + 3 * (j - l->particles), sizeof point.at);
        return point;
    }
    point.weight = l->sample_weight + corner;
    for (int m = 0; m < 3; m++) vec3_add(point.at, point.weight[m], u + 3 * m);
    point.volume = fluid_sample_volume(l->sample_share[corner / 3] / unit,
                                       (const double *const[]){u, u + 3, u + 6}, point.growth);
    return point;
}

/* Returns W at the distance vector d. gradient: volume times grad W, 1/m, rounded to float as the
 * operator stores it. has_area: the point has the surface kernel. */
static double evaluate(const struct kernels *s, bool has_area, const double d[3], double volume,
                       double gradient[3]) {
    double squared = vec3_dot(d, d), r = vec3_length(d);
    double slope =
        has_area ? surface_kernel_slope(&s->area, squared) : kernel_slope(&s->particle, r);
    for (int a = 0; a < 3; a++) {
        /* volatile: gcc 12 drops the conversion to float and back in vectorised code */
        volatile float narrow = (float)(volume * slope * d[a]);
        gradient[a] = (double)narrow;
    }
    return has_area ? surface_kernel_value(&s->area, squared) : kernel_value(&s->particle, r);
}

/* g: gradient of C with respect to the rows of a point that moves; returns their number. value: W;
 * gradient: with respect to the particle. */
static int set_rows(const struct point *point, double value, const double gradient[3], double *g) {
    for (int a = 0; !point->weight && a < 3; a++) g[a] = -gradient[a];
    for (int k = 0; point->weight && k < 9; k++)
        g[k] = value * point->growth[k] - point->weight[k / 3] * gradient[k % 3];
    return point->weight ? 3 : 1;
}

/* Returns C of element e at the positions p (rows x 3, particle e first); g: its gradient, rows x
 * 3, 1/m; *squares: of the gradients of particles and samples. */
static double row_density(const pdyn_batch *b, int e, const double *p, double *g, double *squares) {
    const pdyn_neighbours *l = b->neighbours;
    const double spacing = 2.0 * b->body->radius;
    const struct kernels kernels = {fluid_kernel(l->kernel, spacing),
                                    fluid_surface_kernel(l->kernel, spacing),
                                    fluid_particle_volume(b->body)};
    int i = b->body->first + e, row = 1;
    double rest = 1.0 + (l->granted ? l->granted[i] : 0.0);
    double c = l->volume[i] / kernels.unit * kernel_value(&kernels.particle, 0.0) - rest;
    memset(g, 0, 3 * sizeof *g);
    *squares = 0.0;
    for (int k = l->start[i]; k < l->end[i]; k++) {
        const struct point point = point_at(l, kernels.unit, i, k, p + 3 * row);
        bool has_area = k >= l->surface_start[i] && listed_has_area(l, i, k);
        double d[3], gradient[3];
        vec3_subtract(d, p, point.at);
        double value = evaluate(&kernels, has_area, d, point.volume, gradient);
        c += point.volume * value;
        vec3_add(g, 1.0, gradient);
        if (k >= l->boundary_start[i]) continue;
        for (int a = 0; a < 3; a++) *squares += gradient[a] * gradient[a];
        row += set_rows(&point, value, gradient, g + 3 * row);
    }
    *squares += vec3_dot(g, g);
    return c;
}

static double squares_of(const double *g, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += g[k] * g[k];
    return sum;
}

/* *c, g: C of element e at u and its gradient (rows x 3). Returns k, N m; 0 for C <= 0. */
static double linearise(const struct fluid_params *par, const pdyn_batch *b, int e, double *c,
                        double *g) {
    int row = b->element_row[e], n = 3 * (b->element_row[e + 1] - row);
    double squares = 0.0;
    *c = n > 3 * MAX_ROWS ? 0.0 : row_density(b, e, b->u + 3 * row, g, &squares);
    return *c > 0.0 ? fluid_energy_stiffness(b->neighbours->kernel, par->stiffness, squares,
                                             2.0 * b->body->radius)
                    : 0.0;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    double w = ((const struct fluid_params *)par)->stiffness, g[3 * MAX_ROWS], c;
    for (int e = first; e < last; e++) {
        int row = b->element_row[e], n = 3 * (b->element_row[e + 1] - row);
        double k = linearise(par, b, e, &c, g);
        memcpy(b->p + 3 * row, b->u + 3 * row, (size_t)n * sizeof *g);
        for (int i = 0; k > 0.0 && i < n; i++) b->p[3 * row + i] -= k * c / w * g[i];
    }
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    double g[3 * MAX_ROWS], c, sum = 0.0;
    for (int e = first; e < last; e++) {
        double k = linearise(par, b, e, &c, g);
        sum += 0.5 * k * c * c;
    }
    return sum;
}

/* J = I - min(k / w, 1 / |grad C|^2) grad C grad C': no eigenvalue is below 0. */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    double w = ((const struct fluid_params *)par)->stiffness, g[3 * MAX_ROWS], c;
    for (int e = first; e < last; e++) {
        int n = 3 * (b->element_row[e + 1] - b->element_row[e]);
        double k = linearise(par, b, e, &c, g), squares = k > 0.0 ? squares_of(g, n) : 0.0;
        double part = fmin(k / w, squares > 0.0 ? 1.0 / squares : 0.0);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                J[i * n + j] = (i == j) - (part > 0.0 ? part * g[i] * g[j] : 0.0);
        J += n * n;
    }
}

const pdyn_constraint_type pdyn_constraint_fluid = {
    .name = "fluid",
    .summary = "an incompressible liquid: SPH density at most the rest density",
    .flags = PDYN_ON_PARTICLES,
    .params_size = sizeof(struct fluid_params),
    .params = params,
    .alternatives = alternatives,
    .resolve = fluid_resolve,
    .elements = elements,
    .row_sizes = row_sizes,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .energy = energy,
    .matrix_free = &fluid_operator,
};
