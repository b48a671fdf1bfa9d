/* Isometric bending of a thin plate. The three rows of a triangle are its second derivatives times
 * its area A in m (plate.h): u = A x_11, A sqrt(2) x_12, A x_22. Each row is one element:
 *
 *     p = l u / |u|,     w = B / A,     B: bending rigidity                       (rest_length.h)
 *
 * A sheet that bends without stretching has x_ij = b_ij n with its second fundamental form b and
 * its normal n. So the energy is that of a plate without Poisson's effect,
 *
 *     E = B/2 integral |b - b_rest|^2.
 *
 * l = A |b_rest| for the first row, which plate.h turns along the curvature of the rest shape, and
 * 0 for the other two. A sheet that is flat at rest has l = 0: its energy is quadratic. The lengths
 * |u| are the same for b and -b, so a shell that is turned inside out has no energy. */
#include "projdyn/simd.h"

#include "plate.h"

#include "projdyn/rest_length.h"

struct params {
    double bending_rigidity, damping;
};

static const pdyn_param params[] = {
    {"bending_rigidity", PDYN_REAL, offsetof(struct params, bending_rigidity), true, 0, 0, 1e12,
     "N m", "bending moment per width and curvature of the sheet"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "moment = rigidity (curvature + damping x rate of curvature)"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return 3 * body->triangles;
}

static void row_sizes(const void *par, const pdyn_batch *b, int e, int *rows, int *width) {
    int node[PLATE_NODES];
    (void)par;
    *rows = 1, *width = plate_nodes(b->body, e / 3, node);
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    struct plate plate;
    (void)par;
    for (int e = first; e < last; e++) {
        if (e == first || e % 3 == 0) plate_hessian(b->body, e / 3, &plate);
        ((double *)b->data)[e] = e % 3 ? 0.0 : plate.curvature;
        for (int i = 0; i < plate.nodes; i++) {
            b->column[b->row_entry[e] + i] = b->body->first + plate.node[i];
            b->coefficient[b->row_entry[e] + i] = plate.coefficient[e % 3][i];
        }
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++)
        b->weight[e] = q->bending_rigidity / b->body->triangle_area[e / 3];
}

WIDE static void project_bends(const void *par, const pdyn_batch *b, int first, int last) {
    rest_length_project(par, b, first, last);
}

WIDE static void tangent_bends(const void *par, const pdyn_batch *b, int first, int last,
                               double *axis) {
    rest_length_tangent(par, b, first, last, axis);
}

/* True for a sheet that is flat at rest: p = 0 and J = 0. */
static bool linear(const void *par, const pdyn_batch *b) {
    (void)par;
    for (int e = 0; e < b->elements; e++)
        if (((const double *)b->data)[e] != 0.0) return false;
    return true;
}

static double damping(const void *par) { return ((const struct params *)par)->damping; }

const pdyn_constraint_type pdyn_constraint_bending = {
    .name = "bending",
    .summary = "resistance of a sheet to a change of its curvature",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .row_sizes = row_sizes,
    .select = select,
    .weight = weight,
    .project = project_bends,
    .tangent_rank1 = tangent_bends,
    .linear = linear,
    .damping = damping,
    .damping_rest = rest_length_damping_rest,
};
