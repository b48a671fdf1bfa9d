/* The function that a step minimises, its gradient and its Hessian, summed over all batches (one
 * constraint type on one body each, rows/batch.h):
 *
 *     E(x) = 1/(2 h^2) |M^(1/2) (x - s)|^2 + sum of energies
 *     H    = M/h^2 + sum of w G' ((1 - eps)(I - J) + eps I) G
 *
 * Vectors are particles x 3. */
#ifndef PDYN_OBJECTIVE_H
#define PDYN_OBJECTIVE_H

#include "rows/batch.h"
#include "rows/rigid_matrix.h"
#include "sph/neighbours.h"
#include "sph/wet_sides.h"

#include <stdint.h>

struct contact;

enum { PARTICLE_GRAIN = 2048 }; /* particles per parallel block of vector operations */

/* objective.work counts entries of rows. In the time of so many entries a pass visits the gradient
 * of a one-sided constraint, and an iteration of a linear solver a particle of its vectors. */
enum { WORK_OF_GRADIENT = 15, WORK_OF_VECTORS = 10 };

struct objective_body { /* for the residual of a step (residual.h) */
    const pdyn_body *of;
    int first, count;    /* particles */
    double weight;       /* |M g|, N, in this step */
    double impact, load; /* N, at the x of the last local step */
    double residual;     /* at the last measurement */
};

struct objective {
    pdyn_context *context;
    int particles, bodies;
    struct objective_body *body; /* bodies, by first particle; together they have all particles */

    /* The step. */
    double *mass;          /* particles, kg */
    const double *inertia; /* particles, kg: mass, or more where a particle moves as given */
    double *s;             /* the inertial prediction, m */
    double h;              /* s, effective length h_e (step/integrator.h) */
    double length;         /* s */
    double extrapolation;  /* its base is x^ = x_n + extrapolation (x_n - x_(n-1)) */
    double time;           /* s, at its end */
    const double *x;       /* of the last local step */
    double eps;            /* damping of the current linearisation: 0 newton, 1 projective */

    /* Constraints. */
    int batches;
    size_t capacity;
    struct batch **batch;        /* capacity */
    struct contact *contact;     /* NULL in a scene without contact */
    struct batch *barrier;       /* of contact: element e acts on contact e of contact_current */
    struct batch *dashpots;      /* on dashpot e; NULL without bearings */
    struct batch *friction;      /* on contact e of contact_at_start; NULL without friction */
    struct wet_sides *wet_sides; /* NULL where no fluid rubs or passes a surface */
    bool dynamic;                /* some constraint changes from step to step (PDYN_DYNAMIC) */
    unsigned weights_revision;   /* changes when weights do, for another reason than h */

    /* What follows the particles. */
    struct neighbours *neighbours;     /* NULL where no constraint needs them */
    unsigned lists_revision;           /* of the lists that batches have */
    struct surface_samples *samples;   /* on surfaces, for SPH sums; NULL: none */
    struct rigid_map *rigid;           /* NULL in a scene without rigid bodies */
    struct rigid_matrix *rigid_matrix; /* the same */

    /* Scratch and measurements. */
    double *without_load; /* particles x 3, N: the gradient before a load (residual.c); NULL: no
                             loads */
    double *partial;      /* partial sums, one per block of PARTICLE_GRAIN particles */
    double ms_neighbours, ms_local;
    int64_t work; /* of local steps and products so far, in entries of G visited */
};

/* Counts passes over a batch as work. */
static inline void objective_count(struct objective *o, const struct batch *b, int passes) {
    o->work +=
        (int64_t)passes * (b->op ? (int64_t)WORK_OF_GRADIENT * b->one_sided.at.count : b->entries);
}

/* The neighbour lists, as constraints see them; NULL: no constraint needs them. */
static inline const pdyn_neighbours *objective_lists(const struct objective *o) {
    return o->neighbours ? neighbours_view(o->neighbours) : NULL;
}

/* The step, as batches get it. */
static inline struct batch_step objective_step(const struct objective *o) {
    return (struct batch_step){o->length, o->extrapolation, o->h, o->time};
}

/* Makes a batch, the last one of the objective, which has the capacity for it. added: may be NULL.
 */
pdyn_status objective_add_batch(struct objective *objective, const struct batch_def *def,
                                struct batch **added);

/* Begins a step of effective length h: updates elements that come and go from step to step, rest
 * shapes of dampers, and weights. */
pdyn_status objective_begin(struct objective *objective, const struct step_start *start);

/* Ends a step: it is accepted at the x of the last local step. PDYN_NO_MEMORY: it is not. */
pdyn_status objective_end(struct objective *objective);

/* max_step: particles, then samples: how far each may move from x in one iterate, m. */
pdyn_status objective_limit(struct objective *objective, const double *x, double *max_step);

/* *all: x, then the samples. Rebuilds the neighbour lists if they are incomplete there. */
pdyn_status objective_ensure_lists(struct objective *objective, const double *x,
                                   const double **all);

/* Builds the neighbour lists at x. */
pdyn_status objective_build_lists(struct objective *objective, const double *x);

/* Gives new neighbour lists to every batch. */
pdyn_status objective_share_lists(struct objective *objective);

/* The local step: E and its gradient at x, where rigid bodies are rigid. The caller checks that E
 * is finite. */
pdyn_status objective_local(struct objective *objective, const double *x, double *energy,
                            double *gradient);

/* Fixes tangents and sides of one-sided constraints for H at the x of the last local step. */
pdyn_status objective_linearise(struct objective *objective, double eps);

/* Whether H of the newton step differs from that of the projective one: operators, and rows that
 * are not linear, of types with a tangent. */
bool objective_has_tangents(const struct objective *objective);

/* A counter of changes of rows' selectors. */
unsigned objective_revision(const struct objective *objective);

/* u where there are no rigid bodies, otherwise a copy in which these move as a whole: valid until
 * the next call. */
const double *objective_extended(const struct objective *objective, const double *u);
/* Replaces the forces y on rigid bodies by forces on their points. */
void objective_pull(const struct objective *objective, double *y);

/* y = H u */
void objective_apply(struct objective *objective, const double *u, double *y);

/* The 3 x 3 block diagonal of a part of H, packed xx xy xz yy yz zz: particles x 6. That of the
 * whole H also completes the matrix of rigid bodies, for rigid_matrix_solve. */
void objective_diagonal(struct objective *objective, pdyn_part part, double *blocks);

/* Both of the remainder: H without the terms k_i grad C_i grad C_i' of one-sided constraints
 * (rows/one_sided.h). Rows select only particles from first to before last: elsewhere u is 0, and y
 * has no meaning. */
void objective_apply_remainder(struct objective *objective, int first, int last, const double *u,
                               double *y);
void objective_diagonal_remainder(struct objective *objective, pdyn_part part, double *blocks);

/* The model of E around x as a function of a displacement d, which begins at 0 and moves along one
 * direction after the other. It is quadratic in pieces: one-sided constraints change sides. */

/* Sets the direction u of the functions below, in which rigid bodies move as a whole. */
void objective_set_direction(struct objective *objective, const double *u);

/* The number of constraints that change sides between d and d + u. */
int objective_count_side_changes(struct objective *objective);

/* The t > 0 at which the model is minimal along d + t u. descent: minus the model's slope at d, >
 * 0; curvature: u . H u with the sides at d. */
double objective_line_minimum(struct objective *objective, double descent, double curvature);

/* d += t u. y: H u with the sides at d; becomes the change of the model's gradient. */
void objective_step_along(struct objective *objective, double t, double *y);

/* a . b, the same bits for any number of threads. */
double objective_dot(struct objective *objective, const double *a, const double *b);
/* Of the particles first to before last alone. */
double objective_dot_between(struct objective *objective, int first, int last, const double *a,
                             const double *b);

/* The body of a particle. */
int objective_body_of(const struct objective *objective, int particle);

/* The sum of `partial` over the blocks of a loop. */
double objective_partial_sum(const struct objective *objective, int blocks);

/* Bytes of a vector, particles x 3. */
static inline size_t objective_bytes(const struct objective *objective) {
    return 3 * (size_t)objective->particles * sizeof(double);
}

/* The inertia of particle i on the diagonal of H, N/m. */
static inline double objective_inertia(const struct objective *objective, int i) {
    return objective->inertia[i] / (objective->h * objective->h);
}

/* y += scale x */
void objective_axpy(struct objective *objective, double scale, const double *x, double *y);

#endif
