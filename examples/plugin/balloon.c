/* A closed surface that keeps its volume V, or is inflated to `inflation` times its rest volume.
 * One element: u are all vertices x_i of the body,
 *
 *     V(u) = 1/6 sum over triangles of (a - m) . (b - m) x (c - m),     m: mean of the vertices
 *     p = u - t grad V(u), with t such that V(p) = inflation x V(rest)
 *     J = I - n n',     n = grad V / |grad V|
 *
 * Core stores J of an element, (3 vertices)^2 numbers: meant for some hundred vertices. */
#include <projdyn/module.h>
#include <projdyn/vec3.h>

#include <string.h>

struct params {
    double stiffness, inflation;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1e4, 0, 1e12, "N/m",
     "force per distance of the points from the volume that they should have"},
    {"inflation", PDYN_REAL, offsetof(struct params, inflation), false, 1, 0, 1e3, "1",
     "the volume to have, in that at rest"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par, (void)body;
    return 1;
}

static void row_sizes(const void *par, const pdyn_batch *b, int element, int *rows, int *width) {
    (void)par, (void)element;
    *rows = b->body->count, *width = 1;
}

/* Returns V at the points u - t g (g NULL: u), m^3. gradient: grad V, m^2; NULL: not wanted. */
static double volume(const pdyn_body *body, const double *u, double t, const double *g,
                     double *gradient) {
    double middle[3] = {0}, mean[3] = {0}, sum = 0.0;
    int n = body->count;
    for (int i = 0; i < n; i++) {
        vec3_add(middle, 1.0 / n, u + 3 * i);
        if (g) vec3_add(middle, -t / n, g + 3 * i);
    }
    if (gradient) memset(gradient, 0, 3 * (size_t)n * sizeof *gradient);
    for (int f = 0; f < body->triangles; f++) {
        double x[3][3], normal[3];
        for (int k = 0; k < 9; k++) {
            int place = 3 * body->triangle[3 * f + k / 3] + k % 3;
            x[k / 3][k % 3] = u[place] - (g ? t * g[place] : 0.0) - middle[k % 3];
        }
        for (int k = 0; k < 3; k++) {
            vec3_cross(normal, x[(k + 1) % 3], x[(k + 2) % 3]);
            if (gradient) vec3_add(gradient + 3 * body->triangle[3 * f + k], 1.0 / 6.0, normal);
        }
        sum += vec3_dot(x[2], normal) / 6.0; /* normal = x[0] x x[1] */
    }
    for (int i = 0; i < n && gradient; i++) vec3_add(mean, 1.0 / n, gradient + 3 * i);
    for (int i = 0; i < n && gradient; i++) vec3_add(gradient + 3 * i, -1.0, mean);
    return sum;
}

/* data: the target volume, m^3 */
static void select(const void *par, const pdyn_batch *b, int first, int last) {
    if (first == last) return;
    for (int i = 0; i < b->body->count; i++)
        b->column[i] = b->body->first + i, b->coefficient[i] = 1.0;
    *(double *)b->data =
        ((const struct params *)par)->inflation * volume(b->body, b->body->rest, 0.0, NULL, NULL);
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

static double squares_of(const double *g, int n) {
    double sum = 0.0;
    for (int k = 0; k < 3 * n; k++) sum += g[k] * g[k];
    return sum;
}

/* Newton's iteration for t along the gradient at u. p stores this gradient until t is known. */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const pdyn_body *body = b->body;
    double target = *(const double *)b->data, t = 0.0;
    (void)par;
    if (first == last) return;
    double missing = volume(body, b->u, 0.0, NULL, b->p) - target;
    double squares = squares_of(b->p, body->count);
    for (int k = 0; k < 20 && squares > 0.0 && fabs(missing) > 1e-12 * fabs(target); k++) {
        t += missing / squares;
        missing = volume(body, b->u, t, b->p, NULL) - target;
    }
    for (int k = 0; k < 3 * body->count; k++) b->p[k] = b->u[k] - t * b->p[k];
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    int n = 3 * b->body->count;
    (void)par;
    if (first == last) return;
    double *g = J; /* stored in the first row of J, which is set last */
    volume(b->body, b->u, 0.0, NULL, g);
    double squares = squares_of(g, n / 3);
    for (int i = n - 1; i >= 0; i--) {
        double along = squares > 0.0 ? g[i] / squares : 0.0;
        for (int j = n - 1; j >= 0; j--) J[i * n + j] = (i == j) - along * g[j];
    }
}

static const pdyn_constraint_type type = {
    .name = "balloon",
    .summary = "a closed surface that keeps its volume, or is inflated",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .row_sizes = row_sizes,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "balloon", types, NULL};
