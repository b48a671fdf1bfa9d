#include "eigen.h"

#include <math.h>
#include <stdbool.h>

enum { SWEEPS = 30 };

/* Rotates rows p and q (stride 1) or columns p and q (stride n) of A by an angle, c = cos, s = sin.
 */
static void turn(double *A, int n, int p, int q, int stride, double c, double s) {
    int across = stride == 1 ? n : 1;
    for (int k = 0; k < n; k++) {
        double *a = A + p * across + k * stride, *b = A + q * across + k * stride, before = *a;
        *a = c * before - s * *b;
        *b = s * before + c * *b;
    }
}

/* One Jacobi rotation: makes A_pq zero. */
static void rotate(double *A, int n, int p, int q, double *vector) {
    double ratio = (A[q * n + q] - A[p * n + p]) / (2.0 * A[p * n + q]);
    double t = (ratio >= 0.0 ? 1.0 : -1.0) / (fabs(ratio) + sqrt(1.0 + ratio * ratio));
    double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    turn(A, n, p, q, 1, c, s), turn(A, n, p, q, n, c, s);
    turn(vector, n, p, q, n, c, s);
}

void eigen_symmetric(double *A, int n, double *value, double *vector) {
    double squares = 0.0;
    for (int k = 0; k < n * n; k++) vector[k] = k % (n + 1) == 0, squares += A[k] * A[k];
    double small = 1e-15 * sqrt(squares);
    bool diagonal = false;
    for (int sweep = 0; sweep < SWEEPS && !diagonal; sweep++) {
        diagonal = true;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                if (fabs(A[p * n + q]) > small) rotate(A, n, p, q, vector), diagonal = false;
    }
    for (int k = 0; k < n; k++) value[k] = A[k * n + k];
}
