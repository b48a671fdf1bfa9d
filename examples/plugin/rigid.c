/* Shape matching (Mueller, Heidelberger, Teschner, Gross 2005): a body that keeps its shape. One
 * element: u are all points of the body, r_i the rest positions about their mean,
 *
 *     p_i = c + R r_i,     c: mean of u,     R: rotation that maximises sum (u_i - c) . R r_i
 *     J_ij = I / n + [a_i]x K^-1 [a_j]x',    a_i = R r_i,  K = sum (a_i . a_i I - a_i a_i')
 *
 * R by Horn 1987: its quaternion is an eigenvector of a 4 x 4 matrix. Core stores J of an element,
 * (3 points)^2 numbers: meant for some hundred points. */
#include <projdyn/module.h>
#include <projdyn/vec3.h>

struct params {
    double stiffness;
};

static const pdyn_param params[] = {{"stiffness", PDYN_REAL, offsetof(struct params, stiffness),
                                     false, 1e5, 0, 1e12, "N/m",
                                     "force per distance of a point from the shape"},
                                    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par, (void)body;
    return 1;
}

static void row_sizes(const void *par, const pdyn_batch *b, int element, int *rows, int *width) {
    (void)par, (void)element;
    *rows = b->body->count, *width = 1;
}

static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int i = 0; i < b->body->count && first < last; i++)
        b->column[i] = b->body->first + i, b->coefficient[i] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

/* Mean of n points. */
static void mean_of(const double *x, int n, double mean[3]) {
    for (int k = 0; k < 3; k++) mean[k] = 0.0;
    for (int i = 0; i < n; i++) vec3_add(mean, 1.0 / n, x + 3 * i);
}

/* q: unit eigenvector of the largest eigenvalue of a symmetric 4 x 4 matrix, by Jacobi rotations.
 */
static void largest_eigenvector(double A[4][4], double q[4]) {
    double V[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    for (int sweep = 0; sweep < 12; sweep++)
        for (int i = 0; i < 4; i++)
            for (int j = i + 1; j < 4; j++) {
                double angle = 0.5 * atan2(2.0 * A[i][j], A[j][j] - A[i][i]);
                double c = cos(angle), s = sin(angle);
                for (int k = 0; k < 4; k++) {
                    double a = A[k][i], v = V[k][i];
                    A[k][i] = c * a - s * A[k][j], A[k][j] = s * a + c * A[k][j];
                    V[k][i] = c * v - s * V[k][j], V[k][j] = s * v + c * V[k][j];
                }
                for (int k = 0; k < 4; k++) {
                    double a = A[i][k];
                    A[i][k] = c * a - s * A[j][k], A[j][k] = s * a + c * A[j][k];
                }
            }
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (A[i][i] > A[best][best]) best = i;
    for (int k = 0; k < 4; k++) q[k] = V[k][best];
}

/* R, row by row, from S_ab = sum over points of r_a (u - c)_b. */
static void rotation(double S[3][3], double R[9]) {
    double q[4], N[4][4] = {{S[0][0] + S[1][1] + S[2][2], S[1][2] - S[2][1], S[2][0] - S[0][2],
                             S[0][1] - S[1][0]},
                            {0, S[0][0] - S[1][1] - S[2][2], S[0][1] + S[1][0], S[2][0] + S[0][2]},
                            {0, 0, S[1][1] - S[0][0] - S[2][2], S[1][2] + S[2][1]},
                            {0, 0, 0, S[2][2] - S[0][0] - S[1][1]}};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++) N[i][j] = N[j][i];
    largest_eigenvector(N, q);
    double w = q[0], x = q[1], y = q[2], z = q[3];
    R[0] = w * w + x * x - y * y - z * z, R[1] = 2 * (x * y - w * z), R[2] = 2 * (x * z + w * y);
    R[3] = 2 * (x * y + w * z), R[4] = w * w - x * x + y * y - z * z, R[5] = 2 * (y * z - w * x);
    R[6] = 2 * (x * z - w * y), R[7] = 2 * (y * z + w * x), R[8] = w * w - x * x - y * y + z * z;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    int n = b->body->count;
    double c[3], middle[3], S[3][3] = {{0}}, R[9], r[3];
    (void)par;
    if (first == last) return;
    mean_of(b->u, n, c), mean_of(b->body->rest, n, middle);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 9; k++)
            S[k / 3][k % 3] +=
                (b->body->rest[3 * i + k / 3] - middle[k / 3]) * (b->u[3 * i + k % 3] - c[k % 3]);
    rotation(S, R);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) r[k] = b->body->rest[3 * i + k] - middle[k];
        vec3_multiply(b->p + 3 * i, R, r);
        vec3_add(b->p + 3 * i, 1.0, c);
    }
}

/* The 3 x 3 block of J, size x size, between points with arms a and b:
 * share I + [a]x K^-1 [b]x'. */
static void add_block(double *J, int size, const double *a, const double *b,
                      const double inverse[9], double share) {
    for (int k = 0; k < 3; k++) {
        double unit[3] = {0}, turn[3], spin[3], move[3];
        unit[k] = 1.0;
        vec3_cross(turn, b, unit);          /* torque of a unit force at b */
        vec3_multiply(spin, inverse, turn); /* the rotation that it makes */
        vec3_cross(move, spin, a);          /* what that moves at a */
        for (int m = 0; m < 3; m++) J[m * size + k] = move[m] + (m == k ? share : 0.0);
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    int n = b->body->count;
    double c[3], K[9] = {0}, inverse[9];
    (void)par;
    if (first == last) return;
    mean_of(b->p, n, c);
    for (int i = 0; i < n; i++) {
        double a[3] = {b->p[3 * i] - c[0], b->p[3 * i + 1] - c[1], b->p[3 * i + 2] - c[2]};
        for (int k = 0; k < 9; k++) K[k] += (k % 4 ? 0.0 : vec3_dot(a, a)) - a[k / 3] * a[k % 3];
    }
    double determinant = vec3_cofactors(inverse, K);
    for (int k = 0; k < 9; k++) inverse[k] /= determinant;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double a[3] = {b->p[3 * i] - c[0], b->p[3 * i + 1] - c[1], b->p[3 * i + 2] - c[2]};
            double d[3] = {b->p[3 * j] - c[0], b->p[3 * j + 1] - c[1], b->p[3 * j + 2] - c[2]};
            add_block(J + 9 * n * i + 3 * j, 3 * n, a, d, inverse, 1.0 / n);
        }
}

static const pdyn_constraint_type type = {
    .name = "rigid",
    .summary = "a body that keeps its shape, by shape matching",
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .row_sizes = row_sizes,
    .select = select_rows,
    .weight = weight,
    .project = project,
    .tangent = tangent,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "rigid", types, NULL};
