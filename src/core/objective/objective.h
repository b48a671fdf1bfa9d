/* What a step minimises, and its derivatives, summed over all batches:
 *
 *     E(x) = 1/(2 h^2) |M^(1/2) (x - s)|^2 + sum of the batches' energies
 *     H    = M/h^2 + sum of the batches' w G' ((1 - eps)(I - J) + eps I) G
 *
 * Vectors are particles x 3. */
#ifndef PDYN_OBJECTIVE_H
#define PDYN_OBJECTIVE_H

#include "contact/contact.h"
#include "contact/surface_friction.h"
#include "rows/batch.h"
#include "sph/neighbours.h"

enum { PARTICLE_GRAIN = 2048 }; /* particles: vector operations worth waking a thread for */

struct objective_body { /* its residual is |grad E| / |M g|, over its own particles */
    int first, count;   /* its particles */
    double weight;      /* |M g|, N, in this step */
    double residual;    /* at the last measurement */
};

struct objective {
    pdyn_context *context;
    int particles;
    double *mass;     /* particles, kg */
    double *s;        /* the inertial prediction, m */
    double h;         /* s, effective length of the current step (integrator.h) */
    unsigned weights; /* moves when weights do by themselves, not with h */
    double time;      /* s, at its end */
    const double *x;  /* where the last local step was */
    double eps;       /* damping of the current linearisation: 0 newton, 1 projective */
    int batches, capacity;
    struct batch **batch;                      /* capacity */
    struct contact *contact;                   /* NULL in a scene without contact */
    struct surface_friction *surface_friction; /* NULL where no surface has friction with a fluid */
    struct neighbours *neighbours;             /* NULL where no constraint needs them */
    struct samples *samples;                   /* of surfaces in these; NULL: none */
    unsigned lists;                            /* revision of the lists */
    bool dynamic_rows; /* some batch changes its selector from step to step */
    int bodies;
    struct objective_body *body; /* bodies, ascending; they have all particles */
    double *partial;             /* sums of parallel blocks of PARTICLE_GRAIN particles */
    double ms_neighbours, ms_local;
};

/* A step of effective length h begins at x and v, the base of integrator.h. */
void objective_begin(struct objective *objective, const double *x, const double *v);

/* way: particles, then samples, m: how far each of them may go from x at once. */
pdyn_status objective_limit(struct objective *objective, const double *x, double *way);

/* x with the samples, *all, and lists that are complete there. */
pdyn_status objective_cover(struct objective *objective, const double *x, const double **all);

/* Builds the neighbour lists at x. */
pdyn_status objective_build_lists(struct objective *objective, const double *x);

/* The lists are new: tells every batch. */
pdyn_status objective_tell_lists(struct objective *objective);

/* E and its gradient at x (finite or not: the caller checks E). */
pdyn_status objective_local(struct objective *objective, const double *x, double *energy,
                            double *gradient);

/* Fixes H at the x of the last local step. */
pdyn_status objective_linearise(struct objective *objective, double eps);

/* Moves when the selector of some rows does. */
unsigned objective_revision(const struct objective *objective);

/* y = H u */
void objective_apply(struct objective *objective, const double *u, double *y);

/* The model of E around x, minimised from d = 0 along one direction after the other: H, but that
 * one-sided constraints take their sides where d is. */

/* Aims along u. */
void objective_aim(struct objective *objective, const double *u);

/* How many constraints change sides on the whole way along u. */
int objective_turns(struct objective *objective);

/* How far to go along u to the model's minimum. descent: minus the model's slope here, > 0;
 * curvature: u . H u with the sides as they are. */
double objective_line_minimum(struct objective *objective, double descent, double curvature);

/* Goes t along u; y, H u with the sides as they were, becomes the change of the model's gradient.
 * Returns how many constraints changed sides. */
int objective_go(struct objective *objective, double t, double *y);

/* The 3 x 3 block diagonal of H, packed xx xy xz yy yz zz: particles x 6. */
void objective_diagonal(struct objective *objective, double *blocks);
/* The same of constraints that change from step to step alone, without inertia. */
void objective_dynamic_diagonal(struct objective *objective, double *blocks);

/* Sums of 3-vectors' products over all particles, the same bits for any number of threads. */
double objective_dot(struct objective *objective, const double *a, const double *b);

/* The length of a residual: the root of the sum of squares over bodies, each relative to its
 * weight. Where it is below a number, so is the residual of every body. */
double objective_norm(struct objective *objective, const double *r);

/* The body of a particle. */
int objective_body_of(const struct objective *objective, int particle);

/* Measures the residual of every body from the gradient of E; returns the largest. */
double objective_residual(struct objective *objective, const double *gradient);

/* The sum of what each block of a loop over the particles left in `partial`. */
double objective_partial_sum(const struct objective *objective);

/* Bytes of a vector, particles x 3. */
static inline size_t objective_bytes(const struct objective *objective) {
    return 3 * (size_t)objective->particles * sizeof(double);
}

/* What a particle's inertia adds to each of its diagonal entries in H, N/m. */
static inline double objective_inertia(const struct objective *objective, int i) {
    return objective->mass[i] / (objective->h * objective->h);
}

/* Adds scale x to y. */
void objective_axpy(struct objective *objective, double scale, const double *x, double *y);

#endif
