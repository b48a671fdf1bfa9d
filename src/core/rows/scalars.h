/* The operator tier's scalar constraints in the model of E: constraint i has the energy
 * k_i / 2 max(0, C_i + grad C_i . d)^2, and d, the way gone from the x of the last local step, says
 * on which side each one is. With the damping eps, (1 - eps) of that and eps times the diagonal of
 * the projective step. */
#ifndef PDYN_SCALARS_H
#define PDYN_SCALARS_H

#include "base/context.h"
#include "projdyn/module.h"

struct scalars {
    pdyn_context *context;
    const pdyn_operator *op;
    void *self; /* the operator's state */
    int particles, capacity;
    pdyn_scalars at;    /* the x of the last local step */
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
pdyn_status scalars_begin(struct scalars *s);
void scalars_free(struct scalars *s);

/* y += ((1 - eps) sum over those that act of k_i grad C_i grad C_i' + eps held) u */
void scalars_apply(struct scalars *s, double eps, const double *u, double *y);
/* Adds the block diagonal of the same. */
void scalars_diagonal(struct scalars *s, double eps, double *blocks);

/* Aims along u from d. */
void scalars_aim(struct scalars *s, const double *u);
/* How many are on another side at d + u. */
int scalars_turns(struct scalars *s);
/* The derivative of the one-sided energy at d + t u by t, and the second one. */
double scalars_slope(struct scalars *s, double eps, double t, double *curvature);
/* d += t u. Adds to y what the gradient changes by beyond t times what scalars_apply gives, that is
 * where sides change. Returns how many did. */
int scalars_go(struct scalars *s, double eps, double t, double *y);

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
void scalars_forces(struct scalars *s, double *y);
/* The rates of constraints by velocities before a step less those after it, m/s, and by these
 * forces over the masses, m/s^2: particles x 3. */
void scalars_rate_slowed(struct scalars *s, const double *slowed);
void scalars_rate_acceleration(struct scalars *s, const double *acceleration);
/* y += the impact parts of the forces, from these rates. mass: kg, of a particle of the
 * constraints' body; h: s. Returns how many are impacts for the greater part. */
int scalars_impacts(struct scalars *s, double mass, double h, double *y);

#endif
