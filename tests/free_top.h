/* Euler's equations of a free rigid body, for tests and bench/rigid.c. */
#ifndef TEST_FREE_TOP_H
#define TEST_FREE_TOP_H

struct top { /* in its principal axes: angular velocity, and the axes in space */
    double w[3], axes[9];
};

/* A step of length h by Runge-Kutta of order 4; I: the moments of inertia, up to a factor. */
void top_step(struct top *top, const double I[3], double h);

/* The moments of inertia of a box of these sides, times 12 over its mass. */
void top_inertia(const double side[3], double I[3]);

#endif
