#include "free_top.h"

#include "projdyn/vec3.h"

void top_inertia(const double side[3], double I[3]) {
    for (int a = 0; a < 3; a++) {
        double b = side[(a + 1) % 3], c = side[(a + 2) % 3];
        I[a] = b * b + c * c;
    }
}

/* Time derivative: Euler's equations, and axes' = w x axes with w in space. */
static void top_rate(const struct top *t, const double I[3], struct top *rate) {
    double spin[3] = {0};
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        rate->w[a] = (I[b] - I[c]) * t->w[b] * t->w[c] / I[a];
        vec3_add(spin, t->w[a], t->axes + 3 * a);
    }
    for (int a = 0; a < 3; a++) vec3_cross(rate->axes + 3 * a, spin, t->axes + 3 * a);
}

void top_step(struct top *t, const double I[3], double h) {
    static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    struct top sum = *t, rate = {{0}, {0}};
    for (int k = 0; k < 4; k++) {
        struct top at = *t;
        for (int a = 0; a < 3; a++) at.w[a] += part[k] * h * rate.w[a];
        for (int a = 0; a < 9; a++) at.axes[a] += part[k] * h * rate.axes[a];
        top_rate(&at, I, &rate);
        for (int a = 0; a < 3; a++) sum.w[a] += weight[k] * h / 6.0 * rate.w[a];
        for (int a = 0; a < 9; a++) sum.axes[a] += weight[k] * h / 6.0 * rate.axes[a];
    }
    *t = sum;
}
