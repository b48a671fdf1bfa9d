/* Springs along the edges of a mesh (Liu, Bargteil, O'Brien, Kavan 2013): u is the edge vector, its
 * projection has the rest length. The stiffness of an edge follows from the stretching stiffness Y
 * of the sheet: each triangle at it adds 3 Y A / (l_1^2 + l_2^2 + l_3^2). So springs store what a
 * sheet of Young's modulus times thickness Y and Poisson's ratio 1/3 does, as a mean over the
 * directions of a strain, on every triangle; on equilateral triangles and on square cells in every
 * direction. (Van Gelder 1998 takes Y A / l^2, which makes square cells 1.2 Y stiff along the axes
 * and 0.75 Y along diagonals.) */
#include "base/simd.h"

#include "projdyn/module.h"
#include "projdyn/vec3.h"

struct params {
    double stretching_stiffness, damping;
};

static const pdyn_param params[] = {
    {"stretching_stiffness", PDYN_REAL, offsetof(struct params, stretching_stiffness), true, 0, 0,
     1e12, "N/m", "tension per strain of the sheet: Young's modulus times thickness"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "stress grows with strain + damping x rate of strain"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->edges;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const int *edge = b->body->edge + 2 * e;
        for (int k = 0; k < 2; k++) {
            b->column[2 * e + k] = b->body->first + edge[k];
            b->coefficient[2 * e + k] = k ? 1.0 : -1.0;
        }
        ((double *)b->data)[e] =
            vec3_distance(b->body->rest + 3 * edge[0], b->body->rest + 3 * edge[1]);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++)
        b->weight[e] = 3.0 * q->stretching_stiffness * b->body->edge_share[e];
}

WIDE static void project_springs(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    const double *length = b->data;
    for (int e = first; e < last; e++) vec3_project_length(b->p + 3 * e, b->u + 3 * e, length[e]);
}

enum { PIECE = 64 }; /* springs whose roots are taken side by side */

WIDE static void axial_springs(const void *par, const pdyn_batch *b, int first, int last,
                               double *axis) {
    (void)par;
    for (int e = first; e < last; e += PIECE) {
        double s[PIECE], t[PIECE];
        const double *length = (const double *)b->data + e, *u = b->u + 3 * e;
        int count = last - e < PIECE ? last - e : PIECE;
        for (int k = 0; k < count; k++) vec3_contraction(&s[k], &t[k], u + 3 * k, length[k]);
        for (int k = 0; k < count; k++, u += 3, axis += 4) {
            for (int a = 0; a < 3; a++) axis[a] = t[k] * u[a];
            axis[3] = s[k];
        }
    }
}

static double damping(const void *par) { return ((const struct params *)par)->damping; }

static void hold(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) ((double *)b->data)[e] = vec3_length(b->u + 3 * e);
}

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
    .tangent_rank1 = axial_springs,
    .damping = damping,
    .damping_rest = hold,
};
