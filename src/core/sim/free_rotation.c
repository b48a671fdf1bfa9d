#include "free_rotation.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- rotations ------------------------------------------------------------------------------- */

void rotation_multiply_transposed(const double A[9], const double B[9], double C[9]) {
    for (int k = 0; k < 9; k++) C[k] = vec3_dot(A + 3 * (k / 3), B + 3 * (k % 3));
}

/* By Rodrigues' formula for each column. */
void rotation_turn(const double w[3], double R[9]) {
    double angle = vec3_length(w), half = 0.5 * angle;
    double s = angle > 1e-8 ? sin(angle) / angle : 1.0;
    double c = angle > 1e-8 ? 2.0 * sin(half) * sin(half) / (angle * angle) : 0.5;
    for (int k = 0; k < 3; k++) {
        const double column[3] = {R[k], R[3 + k], R[6 + k]};
        double once[3], twice[3];
        vec3_cross(once, w, column);
        vec3_cross(twice, w, once);
        for (int a = 0; a < 3; a++) R[3 * a + k] += s * once[a] + c * twice[a];
    }
}

void rotation_vector(const double R[9], double w[3]) {
    const double axis[3] = {R[7] - R[5], R[2] - R[6], R[3] - R[1]}; /* 2 sin(angle) axis */
    double sine = 0.5 * vec3_length(axis), angle = atan2(sine, 0.5 * (R[0] + R[4] + R[8] - 1.0));
    double scale = sine > 1e-8 ? 0.5 * angle / sine : 0.5;
    for (int a = 0; a < 3; a++) w[a] = scale * axis[a];
}

/* ---- free rotation --------------------------------------------------------------------------- */

void rigid_inertia_at(const struct rigid_body *body, const double R[9], double I[9]) {
    double half[9];
    rotation_multiply_transposed(R, body->inertia, half);
    rotation_multiply_transposed(half, R, I);
}

/* w = I^-1 L at the rotation exp([turn]) R. */
static void spin_at(const struct rigid_body *body, const double turn[3], const double R[9],
                    const double L[3], double w[3]) {
    double turned[9], I[9];
    memcpy(turned, R, sizeof turned);
    rotation_turn(turn, turned);
    rigid_inertia_at(body, turned, I);
    vec3_solve(w, I, L);
}

/* A substep of the commutator-free method of order 4 by Celledoni, Marthinsen and Owren (2003). */
static void turn_free(const struct rigid_body *body, const double L[3], double t, double R[9]) {
    double k[4][3], turn[3], half[9];
    spin_at(body, (const double[3]){0}, R, L, k[0]);
    for (int m = 1; m < 3; m++) {
        for (int a = 0; a < 3; a++) turn[a] = 0.5 * t * k[m - 1][a];
        spin_at(body, turn, R, L, k[m]);
    }
    memcpy(half, R, sizeof half);
    for (int a = 0; a < 3; a++) turn[a] = 0.5 * t * k[0][a];
    rotation_turn(turn, half);
    for (int a = 0; a < 3; a++) turn[a] = t * (k[2][a] - 0.5 * k[0][a]);
    spin_at(body, turn, half, L, k[3]);
    for (int m = 0; m < 2; m++) {
        double first = m ? -1.0 : 3.0, last = m ? 3.0 : -1.0;
        for (int a = 0; a < 3; a++)
            turn[a] = t / 12.0 * (first * k[0][a] + 2.0 * k[1][a] + 2.0 * k[2][a] + last * k[3][a]);
        rotation_turn(turn, R);
    }
}

/* Angle of a substep, and the number of these in a step at most. */
static const double max_angle = 0.02;
enum { MAX_SUBSTEPS = 1000 };

void rotate_free(const struct rigid_body *body, const double L[3], double t, double R[9]) {
    double w[3];
    spin_at(body, (const double[3]){0}, R, L, w);
    double angle = fabs(t) * vec3_length(w);
    int count = angle < max_angle * MAX_SUBSTEPS ? 1 + (int)(angle / max_angle) : MAX_SUBSTEPS;
    for (int k = 0; k < count; k++) turn_free(body, L, t / count, R);
}
