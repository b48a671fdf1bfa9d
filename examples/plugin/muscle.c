/* A muscle: fibres in a soft solid that contract. f is the direction of the fibres of a tetrahedron
 * of volume V at rest, length 1, and F its deformation gradient, so |F f| is the stretch of the
 * fibres. u = sqrt(V) F f is one row, with the projection onto a sphere:
 *
 *     E = k/2 V (|F f| - l)^2,     p = sqrt(V) l u / |u|,     l = 1 - activation,     w = k
 *
 * the one-dimensional strain energy of Bouaziz et al. 2014, section 5.1, along the fibres. The
 * directions are a table with one row for each tetrahedron; a row of zeros is a tetrahedron without
 * fibres. `activation` may change while a simulation runs. */
#include <projdyn/module.h>
#include <projdyn/rest_length.h>

struct params {
    pdyn_table fibre;
    double activation, stiffness;
};

static const pdyn_param params[] = {
    {"fibre", PDYN_TABLE(PDYN_PER_TET, 3), offsetof(struct params, fibre), true, 0, -1e6, 1e6, "1",
     "direction of the fibres at rest, of any length; 0, 0, 0: none"},
    {"activation", PDYN_REAL, offsetof(struct params, activation), false, 0, 0, 1, "1",
     "part of their length by which free fibres shorten"},
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), true, 0, 0, 1e12, "Pa",
     "stress per strain of the fibres"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->tets;
}

/* The coefficients of F f: F f = sum over k of (g_k . f) x_k, where g_k is the gradient of the k-th
 * barycentric coordinate in the rest shape. */
static void coefficients_of(const pdyn_body *body, int t, const double f[3], double c[4]) {
    const int *corner = body->tet + 4 * t;
    const double *origin = body->rest + 3 * corner[0];
    double side[3][3], normal[3];
    for (int k = 0; k < 3; k++) vec3_subtract(side[k], body->rest + 3 * corner[1 + k], origin);
    for (int k = 0; k < 3; k++) {
        vec3_cross(normal, side[(k + 1) % 3], side[(k + 2) % 3]);
        c[1 + k] = vec3_dot(normal, f) / (6.0 * body->tet_volume[t]);
    }
    c[0] = -c[1] - c[2] - c[3];
}

/* The data of an element is the length sqrt(V) l of u, as rest_length.h has it. */
static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    for (int e = first; e < last; e++) {
        const double *fibre = q->fibre.value + 3 * e, length = vec3_length(fibre);
        double c[4], root = sqrt(b->body->tet_volume[e]);
        coefficients_of(b->body, e, fibre, c);
        for (int k = 0; k < 4; k++) {
            b->column[4 * e + k] = b->body->first + b->body->tet[4 * e + k];
            b->coefficient[4 * e + k] = length > 0.0 ? root * c[k] / length : 0.0;
        }
        ((double *)b->data)[e] = root * (1.0 - q->activation);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    for (int e = first; e < last; e++)
        b->weight[e] = vec3_length(q->fibre.value + 3 * e) > 0.0 ? q->stiffness : 0.0;
}

static const pdyn_constraint_type type = {
    .name = "muscle",
    .summary = "fibres of a soft solid that contract",
    .flags = PDYN_ON_VOLUME,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .rows = 1,
    .width = 4,
    .select = select_rows,
    .weight = weight,
    .project = rest_length_project,
    .tangent_rank1 = rest_length_tangent,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "muscle", types, NULL};
