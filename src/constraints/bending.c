/* Isometric bending. The rows are the second derivatives of the sheet on its triangles, integrated
 * (plate.h): u = A x_11 and so on, in m. A sheet that bends without stretching has x_ij = b_ij n, b
 * its second fundamental form; so with the weight B / A the energy is that of a plate of rigidity B
 * without Poisson's effect, B/2 integral |b - b_rest|^2. An element is one of the three rows of a
 * triangle. Where the rest shape is curved, the first one's length at rest is kept, whatever its
 * direction; all others are to vanish. A flat rest shape has p = 0 and a constant, quadratic
 * energy. */
#include "base/simd.h"

#include "plate.h"

#include "projdyn/vec3.h"

struct params {
    double bending_rigidity, damping;
};

static const pdyn_param params[] = {
    {"bending_rigidity", PDYN_REAL, offsetof(struct params, bending_rigidity), true, 0, 0, 1e12,
     "N m", "bending moment per width and curvature of the sheet"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "moment grows with curvature + damping x rate of curvature"},
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
    (void)par;
    for (int e = first; e < last; e++)
        vec3_project_length(b->p + 3 * e, b->u + 3 * e, ((const double *)b->data)[e]);
}

WIDE static void axial_bends(const void *par, const pdyn_batch *b, int first, int last,
                             double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4)
        vec3_axis_length(axis, b->u + 3 * e, ((const double *)b->data)[e]);
}

/* Flat at rest. */
static bool linear(const void *par, const pdyn_batch *b) {
    (void)par;
    for (int e = 0; e < b->elements; e++)
        if (((const double *)b->data)[e] != 0.0) return false;
    return true;
}

static double damping(const void *par) { return ((const struct params *)par)->damping; }

static void hold(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) ((double *)b->data)[e] = vec3_length(b->u + 3 * e);
}

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
    .tangent_rank1 = axial_bends,
    .linear = linear,
    .damping = damping,
    .damping_rest = hold,
};
