/* The operator tier's scalar constraints in the model of E: constraint i has the energy
 * k_i / 2 max(0, C_i + grad C_i . d)^2, and d, the way gone from the x of the last local step, says
 * on which side each one is. With the damping eps, (1 - eps) of that and eps times the diagonal of
 * the projective step. */
#ifndef PDYN_ONE_SIDED_H
#define PDYN_ONE_SIDED_H

#include "base/context.h"
#include "projdyn/module.h"

struct one_sided {
    pdyn_context *context;
    const pdyn_operator *op;
    void *self; /* the operator's state */
    int particles, capacity;
    pdyn_one_sided at;  /* the x of the last local step */
    double *reached;    /* count: C_i where d is */
    double *rate;       /* count: grad C_i . u for the u aimed along */
    double *multiplier; /* count: scratch */
    bool *acts;         /* count: C_i is positive where d is */
    bool *possible;     /* count: C_i can act at all */
    int remembered;
    double
        *before; /* remembered: multipliers k_i C_i of the first constraints, a step earlier, N */
    double *partial; /* two sums for each parallel block */
};

/* Begins at d = 0 after a local step; grows with the number of constraints. */
pdyn_status one_sided_begin(struct one_sided *s);
void one_sided_free(struct one_sided *s);

/* y += ((1 - eps) sum over those that act of k_i grad C_i grad C_i' + eps held) u */
void one_sided_apply(struct one_sided *s, double eps, const double *u, double *y);
/* Adds the block diagonal of the same. */
void one_sided_diagonal(struct one_sided *s, double eps, double *blocks);

/* Aims along u from d. */
void one_sided_aim(struct one_sided *s, const double *u);
/* How many are on another side at d + u. */
int one_sided_turns(struct one_sided *s);
/* The derivative of the one-sided energy at d + t u by t, and the second one. */
double one_sided_slope(struct one_sided *s, double eps, double t, double *curvature);
/* d += t u. Adds to y what the gradient changes by beyond t times what one_sided_apply gives, that
 * is where sides change. Returns how many did. */
int one_sided_go(struct one_sided *s, double eps, double t, double *y);

/* The part of a force that is an impact: what of its impulse went into stopping an approach, as far
 * as the constraint is too stiff for its oscillation to be resolved. stopped: by how much the rate
 * at which the constraint is violated fell in a step of length h; change: by how much the force
 * makes it fall in h; stiff: (h omega)^2 of its oscillation, about 10 where a period has two
 * steps. */
static inline double impact_part(double stopped, double change, double stiff) {
    if (!(stopped > 0.0 && change > 0.0)) return 0.0;
    return (stopped < change ? stopped / change : 1.0) * stiff / (10.0 + stiff);
}

/* y += the forces of all constraints as they are, N. */
void one_sided_forces(struct one_sided *s, double *y);
/* The rates of constraints by velocities before a step less those after it, m/s, and by these
 * forces over the masses, m/s^2: particles x 3. */
void one_sided_rate_slowed(struct one_sided *s, const double *slowed);
void one_sided_rate_acceleration(struct one_sided *s, const double *acceleration);
/* y += the impact parts of the forces, from these rates. mass: kg, of a particle of the
 * constraints' body; h: s. Returns how many are impacts for the greater part. */
int one_sided_impacts(struct one_sided *s, double mass, double h, double *y);

#endif
