/* The barrier of contact: the energy of a pair at a distance d below its thickness T,
 *
 *     b(d) = k (T - d)^3 / (2 d),    -b' = k/2 (T - d)^2 (T + 2 d) / d^2,    b'' = k (T^3/d^3 - 1),
 *
 * with two continuous derivatives at T; 0 < d <= T, m; k: N/m, the stiffness of the scene's contact
 * times the share of the pair (docs/theory/contact.md). */
#ifndef PROJDYN_BARRIER_H
#define PROJDYN_BARRIER_H

/* b, J */
static inline double barrier_energy(double k, double T, double d) {
    return 0.5 * k * (T - d) * (T - d) * (T - d) / d;
}

/* -b', N */
static inline double barrier_force(double k, double T, double d) {
    return 0.5 * k * (T - d) * (T - d) * (T + 2.0 * d) / (d * d);
}

/* b'', N/m */
static inline double barrier_stiffness(double k, double T, double d) {
    double ratio = T / d;
    return k * (ratio * ratio * ratio - 1.0);
}

#endif
