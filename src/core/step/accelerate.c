/* Accelerations of classic Projective Dynamics: Chebyshev and Anderson. */
#include "accelerate.h"

#include "scene/choices.h"

#include <math.h>
#include <string.h>

/* ---- Chebyshev ------------------------------------------------------------------------------- */

/* Spectral radius of the iteration. A value that is too small is safe but slow. Estimates from the
 * ratio of the directions in the first iterations are far too small. */
static const double spectral_radius = 0.99;

enum { START_ITERATIONS = 2 }; /* iterations before the first proposal */
enum { BEFORE, CHEBYSHEV_VECTORS };

/* x_(k+1) = omega (x^ - x_(k-1)) + x_(k-1), x^: global step at x_k (Wang 2015, equation 9). */
static bool propose_chebyshev(struct acceleration *a, const double *x, double *direction) {
    double square = spectral_radius * spectral_radius, *before = a->vector[BEFORE];
    bool ready = a->iterations >= START_ITERATIONS;
    a->omega =
        a->iterations > START_ITERATIONS ? 4.0 / (4.0 - square * a->omega) : 2.0 / (2.0 - square);
    for (int k = 0; ready && k < 3 * a->objective->particles; k++)
        direction[k] = a->omega * direction[k] + (a->omega - 1.0) * (x[k] - before[k]);
    memcpy(before, x, objective_bytes(a->objective));
    return ready;
}

/* ---- Anderson -------------------------------------------------------------------------------- */

/* Stored vectors: the last d and G = x + d, and their changes in the last iterations. */
enum {
    LAST_D,
    LAST_G,
    CHANGE_D,
    CHANGE_G = CHANGE_D + ANDERSON_WINDOW,
    ANDERSON_VECTORS = CHANGE_G + ANDERSON_WINDOW
};

/* Solves A y = b, n x n, by a Cholesky factorisation in place; scales the diagonal by 1 + 1e-10. */
static bool solve_small(int n, double A[ANDERSON_WINDOW][ANDERSON_WINDOW], double *b) {
    for (int i = 0; i < n; i++) {
        A[i][i] *= 1.0 + 1e-10;
        for (int j = 0; j <= i; j++) {
            for (int k = 0; k < j; k++) A[i][j] -= A[i][k] * A[j][k];
            if (i == j && !(A[i][i] > 0.0)) return false;
            A[i][j] = i == j ? sqrt(A[i][j]) : A[i][j] / A[j][j];
        }
        for (int k = 0; k < i; k++) b[i] -= A[i][k] * b[k];
        b[i] /= A[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) b[i] -= A[k][i] * b[k];
        b[i] /= A[i][i];
    }
    return true;
}

/* Stores the changes of d and G = x + d since the last iteration. */
static void store_change(struct acceleration *a, const double *x, const double *d) {
    int slot = (a->iterations + ANDERSON_WINDOW - 1) % ANDERSON_WINDOW,
        size = 3 * a->objective->particles;
    double *last_d = a->vector[LAST_D], *last_g = a->vector[LAST_G];
    double *change_d = a->vector[CHANGE_D + slot], *change_g = a->vector[CHANGE_G + slot];
    for (int k = 0; k < size; k++) {
        double g = x[k] + d[k];
        change_d[k] = d[k] - last_d[k], change_g[k] = g - last_g[k];
        last_d[k] = d[k], last_g[k] = g;
    }
}

/* x_(k+1) = G_k - sum theta_j (change of G)_j, where theta minimises |d_k - sum theta_j (change of
 * d)_j| (Peng, Deng, Zhang, Geng, Qin, Liu 2018, eqs. 6 and 7). */
static bool propose_anderson(struct acceleration *a, const double *x, double *direction) {
    struct objective *objective = a->objective;
    double A[ANDERSON_WINDOW][ANDERSON_WINDOW], theta[ANDERSON_WINDOW];
    double *const *change_d = a->vector + CHANGE_D, *const *change_g = a->vector + CHANGE_G;
    int n = a->iterations < ANDERSON_WINDOW ? a->iterations : ANDERSON_WINDOW;
    store_change(a, x, direction);
    for (int i = 0; i < n; i++) {
        theta[i] = objective_dot(objective, change_d[i], direction);
        for (int j = 0; j <= i; j++) A[i][j] = objective_dot(objective, change_d[i], change_d[j]);
    }
    if (!n || !solve_small(n, A, theta)) return false;
    for (int i = 0; i < n; i++) objective_axpy(objective, -theta[i], change_g[i], direction);
    return true;
}

/* ---- types ----------------------------------------------------------------------------------- */

static const struct acceleration_type accelerations[] = {
    {"none", "the plain step", 0, NULL},
    {"chebyshev", "Chebyshev semi-iteration (Wang 2015)", CHEBYSHEV_VECTORS, propose_chebyshev},
    {"anderson", "Anderson acceleration (Peng et al. 2018)", ANDERSON_VECTORS, propose_anderson},
};
const struct choices acceleration_choices = {accelerations, sizeof *accelerations,
                                             sizeof accelerations / sizeof *accelerations};

pdyn_status acceleration_create(struct acceleration *a, const struct acceleration_type *type,
                                struct objective *objective) {
    *a = (struct acceleration){.type = type, .objective = objective};
    if (!type->vectors) return PDYN_OK;
    a->plain = NEW_VECTOR(objective->context, objective->particles);
    a->vector = NEW_ARRAY(objective->context, type->vectors, double *);
    for (int k = 0; a->vector && k < type->vectors; k++)
        if (!(a->vector[k] = NEW_VECTOR(objective->context, objective->particles)))
            return PDYN_NO_MEMORY;
    return a->plain && a->vector ? PDYN_OK : PDYN_NO_MEMORY;
}

void acceleration_free(struct acceleration *a) {
    if (!a->objective) return;
    for (int k = 0; a->vector && k < a->type->vectors; k++)
        FREE_VECTOR(a->objective->context, a->vector[k], a->objective->particles);
    FREE_ARRAY(a->objective->context, a->vector, a->type->vectors);
    FREE_VECTOR(a->objective->context, a->plain, a->objective->particles);
}

void acceleration_start(struct acceleration *a) { a->iterations = 0; }

bool acceleration_propose(struct acceleration *a, const double *x, double *direction) {
    if (!a->type->vectors) return false;
    memcpy(a->plain, direction, objective_bytes(a->objective));
    bool proposes = a->type->propose(a, x, direction);
    a->iterations++;
    return proposes;
}
