#include "dense.h"

#include <math.h>
#include <string.h>

void dense_hessian(pdyn_model *model, double *H, double *unit) {
    int n = 3 * model->particles;
    memset(unit, 0, (size_t)n * sizeof *unit);
    for (int k = 0; k < n; k++) {
        unit[k] = 1.0;
        model->product(model, unit, H + k * n);
        unit[k] = 0.0;
    }
}

bool dense_solve(double *H, int n, double *y) {
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = H[i * n + j];
            for (int k = 0; k < j; k++) sum -= H[i * n + k] * H[j * n + k];
            if (i == j && !(sum > 0.0)) return false;
            H[i * n + j] = i == j ? sqrt(sum) : sum / H[j * n + j];
        }
        for (int k = 0; k < i; k++) y[i] -= H[i * n + k] * y[k];
        y[i] /= H[i * n + i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) y[i] -= H[k * n + i] * y[k];
        y[i] /= H[i * n + i];
    }
    return true;
}

/* Entry (i, j), i >= j, of the full matrix; dim 1 stands for the same matrix in x, y and z. */
static double entry(const pdyn_matrix *m, int i, int j) {
    int copies = 3 / m->dim, row = i / copies, column = j / copies;
    for (int k = m->start[column]; k < m->start[column + 1] && i % copies == j % copies; k++)
        if (m->row[k] == row) return m->value[k];
    return 0.0;
}

double dense_matrix_error(pdyn_model *model, const double *H) {
    pdyn_matrix matrix;
    int n = 3 * model->particles;
    double error = 0.0, largest = 0.0;
    if (model->matrix(model, &matrix) != PDYN_OK) return -1.0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            error = fmax(error, fabs(entry(&matrix, i, j) - H[i * n + j]));
            largest = fmax(largest, fabs(H[i * n + j]));
        }
    return error / largest;
}
