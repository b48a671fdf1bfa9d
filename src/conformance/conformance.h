/* Whether a type keeps the contract of module.h. Every check gets the type on a small body of its
 * own and tells each fault in words; nothing here knows a type by name, for scenes are written from
 * the types' own tables of parameters. */
#ifndef PDYN_CONFORMANCE_H
#define PDYN_CONFORMANCE_H

#include "base/registry.h"
#include "projdyn/conformance.h"
#include "step/sim.h"

enum body_kind { SURFACE, PARTICLES, VOLUME, BODY_KINDS };

struct check {                /* of one constraint type or one solver */
    const pdyn_context *like; /* whose types and allocator the trials have */
    const pdyn_constraint_type *type;
    const pdyn_global_solver *solver;
    enum body_kind kind; /* of the body that the type is on, now */
    void (*tell)(void *user, const char *text);
    void *user;
    int faults;
};

/* Tells one fault. */
void fault(struct check *check, const char *format, ...) PDYN_PRINTF(2, 3);

/* ---- trials ---------------------------------------------------------------------------------- */

struct trial { /* a scene of the type, or one to solve, at a random state */
    pdyn_context *context;
    pdyn_sim *sim;
    struct batch *batch, *rows; /* of the type; rows: its rows tier, the batch itself without an
                                   operator */
    int n;                      /* 3 x particles */
    double *x, *gradient, *u, *y, *z, *w; /* n: a state, the gradient there, a direction; room */
    double *da, *db;                      /* 2 n: room for block diagonals */
};

/* A context with the same types and so many threads; NULL without memory. */
pdyn_context *trial_context(const pdyn_context *like, int threads);

enum trial_size { SMALL, LARGE, SIZES }; /* large: parallel loops have several blocks */

/* The scene of the checked type, or of a solver the one with this constraint, in a text of 4096
 * bytes. */
void trial_scene(char text[4096], const pdyn_constraint_type *type, enum body_kind kind,
                 enum trial_size size, const char *solver, const char *step);

/* Loads that scene with one thread and takes it to a random state. A scene that does not load is a
 * fault; false then. */
bool trial_start(struct trial *trial, struct check *check, const pdyn_constraint_type *type,
                 const char *solver);
/* Memory that did not come back is a fault. */
void trial_finish(struct trial *trial, struct check *check);

double trial_dot(const double *a, const double *b, int n);
double trial_norm(const double *a, int n);
double trial_distance(const double *a, const double *b, int n);
double trial_random(uint64_t *seed); /* in [-1, 1) */

/* ---- what is checked, each on a trial of its own --------------------------------------------- */

typedef void check_fn(struct check *check, struct trial *trial);

check_fn check_callbacks;  /* callbacks.c: ranges, what they write, that they keep no state */
check_fn check_projection; /* mathematics.c */
check_fn check_tangent, check_gradient, check_momentum, check_hold;
check_fn check_bounds, check_diagonal;              /* hessian of the type */
check_fn check_stiffness, check_tiers, check_model; /* tiers.c: two ways to the same numbers */

/* Every solver on the type's scene; the checked solver on every type's. */
void check_solvers(struct check *check);
void check_steps(struct check *check);
void check_solver(struct check *check);

#endif
