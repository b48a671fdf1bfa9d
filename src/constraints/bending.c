/* Isometric bending (Bergou et al. 2006; Bouaziz et al. 2014): u is the cotangent Laplacian at an
 * interior vertex i, sum_j c_ij (x_j - x_i), in m; its length at rest is kept. With the weight
 * B / A_i the energy is B/2 sum A_i (|u| / A_i)^2, that of a plate of bending rigidity B with the
 * mean curvature |u| / A_i. A flat rest shape has p = 0 and a constant, quadratic energy. */
#include "../core/simd.h"

#include "projdyn/module.h"
#include "projdyn/vec3.h"

struct params {
    double bending_rigidity;
};

static const pdyn_param params[] = {{"bending_rigidity", PDYN_REAL,
                                     offsetof(struct params, bending_rigidity), true, 0, 0, 1e12,
                                     "N m", "bending moment per width and curvature of the sheet"},
                                    {0}};

/* An element is a vertex; one on an open border selects nothing. */
static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void shape(const void *par, const pdyn_batch *b, int i, int *rows, int *width) {
    (void)par;
    const int *ring = b->body->ring_start + i;
    *rows = 1;
    *width = b->body->on_border[i] ? 0 : 1 + ring[1] - ring[0];
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    const pdyn_body *body = b->body;
    for (int i = first; i < last; i++) {
        double u[3] = {0}, sum = 0.0;
        int *column = b->column + b->row_entry[i], ring = body->ring_start[i];
        double *coefficient = b->coefficient + b->row_entry[i];
        for (int k = 1; k < b->row_entry[i + 1] - b->row_entry[i]; k++, ring++) {
            const int *edge = body->edge + 2 * body->ring_edge[ring];
            int j = edge[0] == i ? edge[1] : edge[0];
            column[k] = body->first + j;
            coefficient[k] = body->edge_cotan[body->ring_edge[ring]];
            sum += coefficient[k];
            for (int a = 0; a < 3; a++)
                u[a] += coefficient[k] * (body->rest[3 * j + a] - body->rest[3 * i + a]);
        }
        if (!body->on_border[i]) column[0] = body->first + i, coefficient[0] = -sum;
        ((double *)b->data)[i] = vec3_length(u);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int i = first; i < last; i++)
        b->weight[i] = ((const struct params *)par)->bending_rigidity / b->body->vertex_area[i];
}

WIDE static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int i = first; i < last; i++)
        vec3_project_length(b->p + 3 * i, b->u + 3 * i, ((const double *)b->data)[i]);
}

WIDE static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int i = first; i < last; i++, J += 9)
        vec3_tangent_length(J, b->u + 3 * i, ((const double *)b->data)[i]);
}

const pdyn_constraint_type pdyn_constraint_bending = {
    .name = "bending",
    .summary = "resistance of a sheet to a change of its curvature",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .shape = shape,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
};
