/* Springs along the edges of a sheet's mesh (Liu, Bargteil, O'Brien, Kavan 2013): u = x_j - x_i,
 *
 *     p = l u / |u|,     E = w/2 (|u| - l)^2,     l: rest length of the edge      (rest_length.h)
 *     w = sum over the one or two triangles of the edge of 3 Y A / (l_1^2 + l_2^2 + l_3^2)
 *
 * with Y the stretching stiffness, A a triangle's area and l_k its sides. In the mean over the
 * directions of a strain, each triangle then stores the energy of a sheet of Young's modulus times
 * thickness Y and Poisson's ratio 1/3; equilateral triangles and square cells store it for every
 * direction. (The weight Y A / l^2 of Van Gelder 1998 makes square cells 1.2 Y stiff along the axes
 * and 0.75 Y along the diagonals.) */
#include "projdyn/simd.h"

#include "projdyn/rest_length.h"

struct params {
    double stretching_stiffness, damping;
};

static const pdyn_param params[] = {
    {"stretching_stiffness", PDYN_REAL, offsetof(struct params, stretching_stiffness), true, 0, 0,
     1e12, "N/m", "tension per strain of the sheet: Young's modulus times thickness"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "stress = stiffness (strain + damping x rate of strain)"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->edges;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const int *edge = b->body->edge + 2 * e;
        const double *rest = b->body->rest;
        for (int k = 0; k < 2; k++) b->column[2 * e + k] = b->body->first + edge[k];
        b->coefficient[2 * e] = -1.0, b->coefficient[2 * e + 1] = 1.0;
        ((double *)b->data)[e] = vec3_distance(rest + 3 * edge[0], rest + 3 * edge[1]);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++)
        b->weight[e] = 3.0 * q->stretching_stiffness * b->body->edge_share[e];
}

WIDE static void project_springs(const void *par, const pdyn_batch *b, int first, int last) {
    rest_length_project(par, b, first, last);
}

WIDE static void tangent_springs(const void *par, const pdyn_batch *b, int first, int last,
                                 double *axis) {
    rest_length_tangent(par, b, first, last, axis);
}

static double damping(const void *par) { return ((const struct params *)par)->damping; }

const pdyn_constraint_type pdyn_constraint_spring = {
    .name = "spring",
    .summary = "stretching of a sheet along the edges of its mesh",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .rows = 1,
    .width = 2,
    .select = select,
    .weight = weight,
    .project = project_springs,
    .tangent_rank1 = tangent_springs,
    .damping = damping,
    .damping_rest = rest_length_damping_rest,
};
