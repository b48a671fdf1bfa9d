#include "numeric_tangent.h"

#include "eigen.h"

#include <string.h>

static double length(const double *a, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += a[k] * a[k];
    return sqrt(sum);
}

void tangent_difference(const struct batch *b, int e, double step, double *D) {
    const pdyn_batch *v = &b->view;
    int first = 3 * v->element_row[e], n = 3 * v->element_row[e + 1] - first;
    double *u = (double *)v->u + first, *p = v->p + first, p_at_u[TANGENT_NUMBERS_MAX];
    memcpy(p_at_u, p, (size_t)n * sizeof *p);
    double h = step * (1e-6 + length(u, n) + length(p, n)); /* not 0 where u = p = 0 */
    for (int j = 0; j < n; j++) {
        double at = u[j];
        u[j] = at + h;
        b->type->project(b->params, v, e, e + 1);
        for (int i = 0; i < n; i++) D[i * n + j] = p[i];
        u[j] = at - h;
        b->type->project(b->params, v, e, e + 1);
        for (int i = 0; i < n; i++) D[i * n + j] = (D[i * n + j] - p[i]) / (2.0 * h);
        u[j] = at;
    }
    memcpy(p, p_at_u, (size_t)n * sizeof *p);
}

void tangent_clamp(double *A, int n) {
    double copy[TANGENT_NUMBERS_MAX * TANGENT_NUMBERS_MAX], value[TANGENT_NUMBERS_MAX];
    double vector[TANGENT_NUMBERS_MAX * TANGENT_NUMBERS_MAX];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            A[i * n + j] = A[j * n + i] = 0.5 * (A[i * n + j] + A[j * n + i]);
    memcpy(copy, A, (size_t)(n * n) * sizeof *A);
    eigen_symmetric(copy, n, value, vector);
    for (int k = 0; k < n; k++) {
        double excess = value[k] - fmin(fmax(value[k], 0.0), 1.0);
        for (int i = 0; i < n && excess != 0.0; i++)
            for (int j = 0; j < n; j++)
                A[i * n + j] -= excess * vector[i * n + k] * vector[j * n + k];
    }
}

/* The step is large beside the error of a projection that iterates to some 1e-9, and small beside
 * the element. */
void tangent_numeric(const struct batch *b, int e, double *J) {
    tangent_difference(b, e, 1e-5, J);
    tangent_clamp(J, 3 * (b->view.element_row[e + 1] - b->view.element_row[e]));
}
