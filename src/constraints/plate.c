/* Constant second derivatives per triangle after Morley (1968), whose element has the vertex values
 * and the normal slopes at the edge midpoints as unknowns; the mean of its second derivatives over
 * the mesh is exact on any mesh. Here the slope across an edge is not an unknown (as in Grinspun,
 * Gingold, Reisman, Zorin 2006) but that of a quadratic fitted to the vertices of the two triangles
 * at the edge and of the four around them. Both triangles use the same slope, which is exact for
 * quadratics: so the bending energy of a smooth shape converges to the plate's, and it is never
 * below Morley's, hence no mesh makes the sheet too soft. At a border the slope minimises the
 * triangle's energy: no moment acts there. */
#include "plate.h"

#include "frame.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { TERMS = 6, AROUND = 8 }; /* terms of a quadratic; vertices of the up to 6 triangles */

/* ---- the triangles around an edge, unfolded into a plane ------------------------------------- */

struct flat { /* the vertices around an edge in a plane */
    int nodes, node[AROUND];
    double at[AROUND][2]; /* along and across the edge, from its midpoint, m */
};

static const double *rest(const pdyn_body *body, int vertex) {
    return body->rest + 3 * (size_t)vertex;
}

/* Unfolds the triangle on the side from node p to node q: adds its vertex `tip` on the left (left =
 * 1) or right (-1) of the side. */
static void unfold(const pdyn_body *body, struct flat *f, int p, int q, int tip, double left) {
    double side[3], to_tip[3], up[3];
    const double *a = f->at[p], *b = f->at[q];
    for (int k = 0; k < 3; k++) {
        side[k] = rest(body, f->node[q])[k] - rest(body, f->node[p])[k];
        to_tip[k] = rest(body, tip)[k] - rest(body, f->node[p])[k];
    }
    double length = vec3_length(side);
    double along = vec3_dot(side, to_tip) / (length * length);
    vec3_cross(up, side, to_tip);
    double height = left * vec3_length(up) / (length * length);
    f->at[f->nodes][0] = a[0] + along * (b[0] - a[0]) - height * (b[1] - a[1]);
    f->at[f->nodes][1] = a[1] + along * (b[1] - a[1]) + height * (b[0] - a[0]);
    f->node[f->nodes++] = tip;
}

/* Unfolds the triangles beyond the other two sides of the triangle of `corner`. tip: the node of
 * that corner; left: 1 or -1, its side of the edge from node 0 to node 1. */
static void unfold_around(const pdyn_body *body, struct flat *f, int corner, int tip, double left) {
    for (int k = 1; k < 3; k++) {
        int end = corner / 3 * 3 + (corner + k) % 3, beyond = body->across[end];
        int other = body->triangle[end] == f->node[0] ? 1 : 0;
        if (beyond >= 0) unfold(body, f, other, tip, body->triangle[beyond], other ? -left : left);
    }
}

/* Unfolds the up to six triangles around the edge opposite to a corner. Nodes 0 and 1: the edge,
 * node 2: the vertex of the corner, node 3: the vertex beyond the edge. */
static struct flat unfold_edge(const pdyn_body *body, int corner) {
    const int *c = body->triangle + corner / 3 * 3;
    int a = c[(corner + 1) % 3], b = c[(corner + 2) % 3], beyond = body->across[corner];
    double half = 0.5 * vec3_distance(rest(body, a), rest(body, b));
    struct flat f = {.nodes = 2, .node = {a, b}, .at = {{-half, 0.0}, {half, 0.0}}};
    unfold(body, &f, 0, 1, c[corner % 3], 1.0);
    unfold(body, &f, 0, 1, body->triangle[beyond], -1.0);
    unfold_around(body, &f, corner, 2, 1.0);
    unfold_around(body, &f, beyond, 3, -1.0);
    return f;
}

/* ---- the slope across an edge ---------------------------------------------------------------- */

/* y = A^-1 y for a symmetric positive definite A, by Gaussian elimination. */
static void solve(double A[TERMS][TERMS], double y[TERMS]) {
    for (int k = 0; k < TERMS; k++)
        for (int i = k + 1; i < TERMS; i++) {
            double factor = A[i][k] / A[k][k];
            for (int j = k; j < TERMS; j++) A[i][j] -= factor * A[k][j];
            y[i] -= factor * y[k];
        }
    for (int k = TERMS - 1; k >= 0; k--) {
        for (int j = k + 1; j < TERMS; j++) y[k] -= A[k][j] * y[j];
        y[k] /= A[k][k];
    }
}

/* Sets slope_i such that sum_i slope_i f_i is the derivative across the edge (right to left) at its
 * midpoint, 1/m, of the quadratic fitted to the values f_i by least squares. A regularisation of
 * 1e-9 selects the flattest fit where the points do not determine it. */
static void slope_across(const struct flat *f, double slope[AROUND]) {
    double term[AROUND][TERMS], A[TERMS][TERMS] = {0}, y[TERMS] = {0};
    double width = 2.0 * f->at[1][0], height = f->at[2][1] - f->at[3][1];
    for (int i = 0; i < f->nodes; i++) {
        double s = f->at[i][0] / width, t = f->at[i][1] / height;
        memcpy(term[i], (double[TERMS]){1.0, s, t, s * s, s * t, t * t}, sizeof term[i]);
        for (int j = 0; j < TERMS; j++)
            for (int k = 0; k < TERMS; k++) A[j][k] += term[i][j] * term[i][k];
    }
    for (int j = 3; j < TERMS; j++) A[j][j] += 1e-9;
    y[2] = 1.0 / height;
    solve(A, y);
    for (int i = 0; i < f->nodes; i++) {
        slope[i] = 0.0;
        for (int j = 0; j < TERMS; j++) slope[i] += term[i][j] * y[j];
    }
}

/* ---- the Hessian ----------------------------------------------------------------------------- */

/* Adds scale x direction to the three coefficients of a vertex of `out`. */
static void add(struct plate *out, int vertex, double scale, const double direction[3]) {
    int i = 0;
    while (out->node[i] != vertex) i++;
    for (int r = 0; r < 3; r++) out->coefficient[r][i] += scale * direction[r];
}

/* direction = (n_x n_x, sqrt(2) n_x n_y, n_y n_y) for the unit normal n of a side; returns the
 * side's length, m */
static double side_direction(const double outward[2], double direction[3]) {
    double square = outward[0] * outward[0] + outward[1] * outward[1];
    direction[0] = outward[0] * outward[0] / square;
    direction[1] = sqrt(2.0) * outward[0] * outward[1] / square;
    direction[2] = outward[1] * outward[1] / square;
    return sqrt(square);
}

/* Adds the contribution of the edge opposite to a corner: its length times the slope across it
 * minus the slope of the linear function on the triangle. */
static void add_edge(const pdyn_body *body, int corner, const struct frame *f, struct plate *out) {
    double direction[3], slope[AROUND];
    struct flat flat = unfold_edge(body, corner);
    const double *outward = f->outward[corner % 3];
    double length = side_direction(outward, direction);
    slope_across(&flat, slope);
    for (int i = 0; i < flat.nodes; i++) add(out, flat.node[i], -length * slope[i], direction);
    for (int k = 0; k < 3; k++)
        add(out, body->triangle[corner / 3 * 3 + k],
            -(f->gradient[k][0] * outward[0] + f->gradient[k][1] * outward[1]), direction);
}

/* Projects the Hessian to the complement of a unit direction: coefficients -= d (d . coefficients).
 */
static void remove_direction(struct plate *out, const double direction[3]) {
    for (int i = 0; i < out->nodes; i++) {
        double along = 0.0;
        for (int r = 0; r < 3; r++) along += direction[r] * out->coefficient[r][i];
        for (int r = 0; r < 3; r++) out->coefficient[r][i] -= along * direction[r];
    }
}

/* Border edges have the slopes that minimise the Hessian: their directions are projected out. */
static void free_borders(const pdyn_body *body, int t, const struct frame *f, struct plate *out) {
    double taken[3] = {0}, direction[3];
    for (int k = 0; k < 3; k++) {
        if (body->across[3 * t + k] >= 0) continue;
        side_direction(f->outward[k], direction);
        vec3_add(direction, -vec3_dot(direction, taken), taken);
        double length = vec3_length(direction);
        for (int r = 0; r < 3; r++) taken[r] = direction[r] / length;
        remove_direction(out, taken);
    }
}

/* Subtracts Christoffel symbols times first derivatives (covariant derivatives). Of the second
 * derivatives of the rest shape, the part along the normal is left: curvature, m. */
static void make_covariant(const pdyn_body *body, int t, const struct frame *f, struct plate *out,
                           double curvature[3]) {
    double bent[3][3] = {{0}}, symbol[2][3];
    for (int r = 0; r < 3; r++) {
        for (int i = 0; i < out->nodes; i++)
            vec3_add(bent[r], out->coefficient[r][i], rest(body, out->node[i]));
        curvature[r] = vec3_dot(bent[r], f->axis[2]);
        for (int a = 0; a < 2; a++) symbol[a][r] = vec3_dot(bent[r], f->axis[a]);
    }
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 2; a++)
            add(out, body->triangle[3 * t + k], -f->gradient[k][a], symbol[a]);
}

/* Rotates the three rows such that the first has the whole curvature of the rest shape. A curvature
 * of at most 1e-7 sqrt(area) comes from rounded coordinates and counts as 0. */
static void align_rows(const double curvature[3], double area, struct plate *out) {
    double length = vec3_length(curvature), axis[3][3];
    if (length <= 1e-7 * sqrt(area)) return;
    int least = 0;
    for (int r = 1; r < 3; r++)
        if (fabs(curvature[r]) < fabs(curvature[least])) least = r;
    for (int r = 0; r < 3; r++) axis[0][r] = curvature[r] / length;
    vec3_cross(axis[1], axis[0], (double[3]){least == 0, least == 1, least == 2});
    double across = vec3_length(axis[1]);
    for (int r = 0; r < 3; r++) axis[1][r] /= across;
    vec3_cross(axis[2], axis[0], axis[1]);
    for (int i = 0; i < out->nodes; i++) {
        double before[3], after[3];
        for (int r = 0; r < 3; r++) before[r] = out->coefficient[r][i];
        vec3_multiply(after, axis[0], before);
        for (int r = 0; r < 3; r++) out->coefficient[r][i] = after[r];
    }
    out->curvature = length;
}

/* Appends the vertex of a corner unless it is in the list; returns the new length. */
static int add_node(const pdyn_body *body, int corner, int nodes, int *node) {
    int vertex = body->triangle[corner], i = 0;
    while (i < nodes && node[i] != vertex) i++;
    node[i] = vertex;
    return i == nodes ? nodes + 1 : nodes;
}

int plate_nodes(const pdyn_body *body, int t, int node[PLATE_NODES]) {
    int nodes = 0;
    for (int c = 3 * t; c < 3 * t + 3; c++) nodes = add_node(body, c, nodes, node);
    for (int c = 3 * t; c < 3 * t + 3; c++) {
        int beyond = body->across[c];
        if (beyond < 0) continue;
        nodes = add_node(body, beyond, nodes, node);
        for (int k = 1; k < 3; k++) {
            int next = body->across[beyond / 3 * 3 + (beyond + k) % 3];
            if (next >= 0) nodes = add_node(body, next, nodes, node);
        }
    }
    for (int c = 3 * t; c < 3 * t + 3; c++)
        if (body->across[c] >= 0) return nodes;
    return 0;
}

void plate_hessian(const pdyn_body *body, int t, struct plate *out) {
    double curvature[3];
    struct frame f = frame_of(body, t);
    *out = (struct plate){0};
    out->nodes = plate_nodes(body, t, out->node);
    for (int k = 0; k < 3; k++)
        if (body->across[3 * t + k] >= 0) add_edge(body, 3 * t + k, &f, out);
    if (!out->nodes) return;
    free_borders(body, t, &f, out);
    make_covariant(body, t, &f, out, curvature);
    align_rows(curvature, f.area, out);
}
