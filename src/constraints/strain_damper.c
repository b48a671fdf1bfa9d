#include "strain_damper.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* The place of U_ij, i < j, among the numbers. */
static int place(int i, int j, int columns) { return columns - 1 + i + j; }

void strain_damper_rest(const svd3 *u, int columns, double *rest) {
    double U[3][3] = {{0}};
    for (int k = 0; k < columns; k++)
        for (int i = 0; i < columns; i++)
            for (int j = 0; j < columns; j++) U[i][j] += u->s[k] * u->right[k][i] * u->right[k][j];
    for (int i = 0; i < columns; i++) rest[i] = U[i][i];
    for (int j = 1; j < columns; j++)
        for (int i = 0; i < j; i++)
            rest[place(i, j, columns)] = 0.5 * (U[i][i] + U[j][j]) + U[i][j];
}

void strain_damper_product(const double *u, const double *rest, int columns, double *product) {
    memset(product, 0, 3 * (size_t)columns * sizeof *product);
    for (int i = 0; i < columns; i++) vec3_add(product + 3 * i, rest[i], u + 3 * i);
    for (int j = 1; j < columns; j++)
        for (int i = 0; i < j; i++) {
            double U = rest[place(i, j, columns)] - 0.5 * (rest[i] + rest[j]);
            vec3_add(product + 3 * i, U, u + 3 * j);
            vec3_add(product + 3 * j, U, u + 3 * i);
        }
}

static double dot(const double *a, const double *b, int numbers) {
    double sum = 0.0;
    for (int i = 0; i < numbers; i++) sum += a[i] * b[i];
    return sum;
}

void strain_damper_tangent(const svd3 *product, const double *p, int columns, double *J) {
    const double *s = product->s;
    double g[3][9];
    int n = 3 * columns;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < columns; c++) vec3_cross(g[k] + 3 * c, product->left[k], p + 3 * c);
    for (int k = 0; k < 3; k++) {
        double most = 0.0; /* with it in place of s_i + s_j no eigenvalue is above 1 (Gershgorin) */
        for (int l = 0; l < 3; l++) most += fabs(dot(g[k], g[l], n));
        double below = fmax(s[(k + 1) % 3] + s[(k + 2) % 3], most);
        for (int i = 0; i < n && below > 0.0; i++)
            for (int j = 0; j < n; j++) J[n * i + j] += g[k][i] * g[k][j] / below;
    }
}
