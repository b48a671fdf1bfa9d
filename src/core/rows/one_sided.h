/* The scalar constraints of an operator in the quadratic model of E: constraint i has the energy
 *
 *     (1 - eps) k_i / 2 max(0, C_i + grad C_i . d)^2 + eps / 2 d . D d,
 *
 * where d is the displacement from the x of the last local step. A constraint acts where
 * C_i + grad C_i . d > 0; this is its side. D: the diagonal of the projective step, the sums of
 * pdyn_one_sided.weight_sum; those of a sample of a surface are lumped to the corners of its
 * triangle. */
#ifndef PDYN_ONE_SIDED_H
#define PDYN_ONE_SIDED_H

#include "base/context.h"
#include "base/snapshot_file.h"
#include "projdyn/module.h"

struct one_sided {
    pdyn_context *context;
    const pdyn_operator *op;
    void *self;              /* the operator's state */
    int particles, capacity; /* without samples of surfaces; constraints with room */
    pdyn_one_sided at;       /* the x of the last local step */
    const double *D;         /* particles: the same x, N/m */
    double *reached;         /* count: C_i + grad C_i . d */
    double *rate;            /* count: grad C_i . u, u: the search direction */
    double *mean; /* means: multipliers of the mean forces of the last step: without those parts
                     of impacts that the integrator left out */
    int means;    /* the count of the last step; 0: that step was not solved */
    double *multiplier; /* count: scratch of a step; between steps k_i max(0, C_i) of its end */
    bool *acts;         /* count: the constraint acts at d */
    bool *possible;     /* count: k_i > 0 */
    double *partial;    /* two sums for each parallel block */
};

/* Sets d = 0 after a local step. Allocates when the number of constraints grows. */
pdyn_status one_sided_begin(struct one_sided *s);
void one_sided_free(struct one_sided *s);

/* y += (1 - eps) sum over acting constraints of k_i grad C_i grad C_i' u; vectors with samples */
void one_sided_apply(struct one_sided *s, double eps, const double *u, double *y);
/* Adds the block diagonal of that matrix, packed xx xy xz yy yz zz; with samples. */
void one_sided_diagonal(struct one_sided *s, double eps, double *blocks);
/* y += eps D u of the particles from first to before last, and its blocks; without samples. */
void one_sided_apply_projective(struct one_sided *s, double eps, int first, int last,
                                const double *u, double *y);
void one_sided_diagonal_projective(struct one_sided *s, double eps, double *blocks);

/* Sets the search direction u from d. */
void one_sided_set_direction(struct one_sided *s, const double *u);
/* The number of constraints that change sides between d and d + u. */
int one_sided_count_side_changes(struct one_sided *s);
/* The first derivative of the constraints' energy at d + t u with respect to t; *curvature: the
 * second. */
double one_sided_slope(struct one_sided *s, double eps, double t, double *curvature);
/* d += t u. Adds to y the change of the gradient that t times the product of one_sided_apply does
 * not contain, because constraints change sides. */
void one_sided_step_along(struct one_sided *s, double eps, double t, double *y);

/* The part of a force, 0 to 1, that is an impact: the part of its impulse that stopped an approach,
 * or by which it rose suddenly, times a factor that is near 1 if the step is too long to resolve
 * the oscillation of the constraint. stopped: decrease of dC/dt in a step of length h, or the part
 * of `change` by which the force rose; change: the decrease that the force alone causes in h;
 * stiff: (h omega)^2 of the oscillation, about 10 for two steps a period. */
static inline double impact_part(double stopped, double change, double stiff) {
    if (!(stopped > 0.0 && change > 0.0)) return 0.0;
    return (stopped < change ? stopped / change : 1.0) * stiff / (10.0 + stiff);
}

/* multiplier = k_i max(0, C_i) at the last local step: y += sum of multiplier_i grad C_i is the
 * gradient of the constraints' energy. mean = the same, less the part `left_out` of the impact
 * parts that one_sided_impacts has found before; 0: there are none. The next step compares its
 * forces with those of a solved one only. */
void one_sided_store_forces(struct one_sided *s, double left_out, bool solved);
/* The energy that constraint i stores at the last local step, J, after one_sided_store_forces. */
double one_sided_energy(const struct one_sided *s, int i);
/* Writes or reads the mean forces of the last step. */
void one_sided_persist(struct one_sided *s, struct snapshot_file *snapshot);
/* y += the gradient of the constraints' energy at the last local step, N */
void one_sided_forces(struct one_sided *s, double *y);

struct rate_change { /* of the constraints that act, in a step */
    /* count: grad C_i . (velocities before the step minus those after it), m/s */
    const double *slowed;
    /* count: grad C_i . (velocities after the step), m/s; -INFINITY: not known. It may be
     * `multiplier`: entry i is read before it is written */
    const double *after;
    /* count: grad C_i . (the gradient of one_sided_forces over the masses), m/s^2 */
    const double *acceleration;
    double mass;  /* kg, of a particle of the body */
    double h;     /* s */
    double taken; /* part of the impulse of an impact that the caller takes off the velocities */
    bool solved;  /* the forces are those of a solved step */
};
/* y += the impact parts of the forces. Returns the number of forces of which the impact is the
 * greater part. */
int one_sided_impacts(struct one_sided *s, const struct rate_change *change, double *y);

#endif
