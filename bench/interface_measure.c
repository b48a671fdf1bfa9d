/* Quantities of a state for the measurements of the interface. */
#include "interface.h"

#include "projdyn/vec3.h"

#include <math.h>

void sample_add(struct sample *s, double weight, double value) {
    s->n += weight, s->sum += weight * value, s->squares += weight * value * value;
}

double sample_mean(const struct sample *s) { return s->sum / s->n; }

double sample_deviation(const struct sample *s) {
    double mean = sample_mean(s);
    return sqrt(fmax(0.0, s->squares / s->n - mean * mean));
}

double body_weight(const pdyn_sim *sim, int body) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    double sum = 0.0;
    for (int i = 0; i < b.count; i++) sum += g * s.mass[b.first + i];
    return sum;
}

double body_area(const pdyn_sim *sim, int body) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    double sum = 0.0;
    for (int t = 0; t < b.triangles; t++) {
        const double *p[3];
        double side[2][3], normal[3];
        for (int k = 0; k < 3; k++) p[k] = s.x + 3 * (b.first + b.triangle[3 * t + k]);
        for (int k = 0; k < 3; k++) side[0][k] = p[1][k] - p[0][k], side[1][k] = p[2][k] - p[0][k];
        vec3_cross(normal, side[0], side[1]);
        sum += 0.5 * vec3_length(normal);
    }
    return sum;
}

void body_middle(const pdyn_sim *sim, int body, double x[3]) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    x[0] = x[1] = x[2] = 0.0;
    for (int i = 0; i < b.count; i++) vec3_add(x, 1.0 / b.count, s.x + 3 * (b.first + i));
}

/* Fraction of the interval x +- d/2 within +- half. */
static double share(double x, double d, double half) {
    if (half <= 0.0) return 0.0;
    return fmax(0.0, fmin(x + 0.5 * d, half) - fmax(x - 0.5 * d, -half)) / d;
}

double surface_height(const pdyn_sim *sim, const struct frame *f) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, 0);
    double d = 2.0 * b.radius, volume = 0.0;
    double area = 4.0 * f->outer[0] * f->outer[1];
    if (f->inner[0] > 0.0 && f->inner[1] > 0.0) area -= 4.0 * f->inner[0] * f->inner[1];
    for (int i = 0; i < b.count; i++) {
        const double *p = s.x + 3 * (b.first + i);
        if (s.live && !s.live[b.first + i]) continue;
        double x = p[0] - f->middle[0], z = p[2] - f->middle[1];
        double within = share(x, d, f->outer[0]) * share(z, d, f->outer[1]) -
                        share(x, d, f->inner[0]) * share(z, d, f->inner[1]);
        volume += within * fmin(1.0, fmax(0.0, (p[1] - f->low) / d + 0.5));
    }
    return f->low + volume * d * d * d / area;
}

void regression_add(struct regression *r, double weight, const double x[], double y) {
    for (int i = 0; i < r->terms; i++) {
        for (int j = 0; j < r->terms; j++) r->matrix[i][j] += weight * x[i] * x[j];
        r->right[i] += weight * x[i] * y;
    }
}

void regression_solve(struct regression *r, double c[]) {
    for (int k = 0; k < r->terms; k++)
        for (int i = k + 1; i < r->terms; i++) {
            double factor = r->matrix[i][k] / r->matrix[k][k];
            for (int j = k; j < r->terms; j++) r->matrix[i][j] -= factor * r->matrix[k][j];
            r->right[i] -= factor * r->right[k];
        }
    for (int k = r->terms - 1; k >= 0; k--) {
        c[k] = r->right[k];
        for (int j = k + 1; j < r->terms; j++) c[k] -= r->matrix[k][j] * c[j];
        c[k] /= r->matrix[k][k];
    }
}
