/* What a step minimises, and its derivatives, summed over all batches:
 *
 *     E(x) = 1/(2 h^2) |M^(1/2) (x - s)|^2 + sum of the batches' energies
 *     H    = M/h^2 + sum of the batches' w G' ((1 - eps)(I - J) + eps I) G
 *
 * Vectors are particles x 3. */
#ifndef PDYN_SYSTEM_H
#define PDYN_SYSTEM_H

#include "contact/contact.h"
#include "contact/drag.h"
#include "rows/batch.h"
#include "sph/neighbours.h"

enum { SYSTEM_GRAIN = 2048 }; /* particles: vector operations worth waking a thread for */

struct system_body {  /* its residual is |grad E| / |M g|, over its own particles */
    int first, count; /* its particles */
    double weight;    /* |M g|, N, in this step */
    double residual;  /* at the last measurement */
};

struct system {
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
    struct batch **batch;          /* capacity */
    struct contact *contact;       /* NULL in a scene without contact */
    struct drag *drag;             /* NULL where no surface has friction with a fluid */
    struct neighbours *neighbours; /* NULL where no constraint needs them */
    struct samples *samples;       /* of surfaces in these; NULL: none */
    unsigned lists;                /* revision of the lists */
    bool changing;                 /* some batch changes its selector from step to step */
    int bodies;
    struct system_body *body; /* bodies, ascending; they have all particles */
    double *partial;          /* sums of parallel blocks of SYSTEM_GRAIN particles */
    double ms_neighbours, ms_local;
};

/* A step of effective length h begins at x and v, the base of integrator.h. */
void system_begin(struct system *system, const double *x, const double *v);

/* way: particles, then samples, m: how far each of them may go from x at once. */
pdyn_status system_limit(struct system *system, const double *x, double *way);

/* x with the samples, *all, and lists that are complete there. */
pdyn_status system_cover(struct system *system, const double *x, const double **all);

/* Builds the neighbour lists at x. */
pdyn_status system_build_lists(struct system *system, const double *x);

/* The lists are new: tells every batch. */
pdyn_status system_tell_lists(struct system *system);

/* E and its gradient at x (finite or not: the caller checks E). */
pdyn_status system_local(struct system *system, const double *x, double *energy, double *gradient);

/* Fixes H at the x of the last local step. */
pdyn_status system_linearise(struct system *system, double eps);

/* Moves when the selector of some rows does. */
unsigned system_revision(const struct system *system);

/* y = H u */
void system_apply(struct system *system, const double *u, double *y);

/* The model of E around x, minimised from d = 0 along one direction after the other: H, but that
 * one-sided constraints take their sides where d is. */

/* Aims along u. */
void system_aim(struct system *system, const double *u);

/* How many constraints change sides on the whole way along u. */
int system_turns(struct system *system);

/* How far to go along u to the model's minimum. descent: minus the model's slope here, > 0;
 * curvature: u . H u with the sides as they are. */
double system_line_minimum(struct system *system, double descent, double curvature);

/* Goes t along u; y, H u with the sides as they were, becomes the change of the model's gradient.
 * Returns how many constraints changed sides. */
int system_go(struct system *system, double t, double *y);

/* The 3 x 3 block diagonal of H, packed xx xy xz yy yz zz: particles x 6. */
void system_diagonal(struct system *system, double *blocks);

/* Sums of 3-vectors' products over all particles, the same bits for any number of threads. */
double system_dot(struct system *system, const double *a, const double *b);

/* The length of a residual: the root of the sum of squares over bodies, each relative to its
 * weight. Where it is below a number, so is the residual of every body. */
double system_norm(struct system *system, const double *r);

/* What particles from `first` to before `last` add to its square. */
double system_norm_part(const struct system *system, const double *r, int first, int last);

/* The body of a particle. */
int system_body_of(const struct system *system, int particle);

/* Measures the residual of every body from the gradient of E; returns the largest. */
double system_residual(struct system *system, const double *gradient);

/* The sum of what each block of a loop over the particles left in `partial`. */
double system_partial_sum(const struct system *system);

/* Bytes of a vector, particles x 3. */
static inline size_t system_bytes(const struct system *system) {
    return 3 * (size_t)system->particles * sizeof(double);
}

/* What a particle's inertia adds to each of its diagonal entries in H, N/m. */
static inline double system_inertia(const struct system *system, int i) {
    return system->mass[i] / (system->h * system->h);
}

/* Adds scale x to y. */
void system_axpy(struct system *system, double scale, const double *x, double *y);

#endif
