/* Checks of constraint types and solvers against the contract of module.h. Each check runs on a
 * small scene (a trial) and reports faults as text. Scenes are written from a type's parameter
 * table, so the checks cover any type. */
#ifndef PDYN_CONFORMANCE_H
#define PDYN_CONFORMANCE_H

#include "base/registry.h"
#include "projdyn/conformance.h"
#include "sim/sim.h"

/* How the body of a trial is deformed: constraints of one side act in some of these states only.
 * CRUMPLED: at random, by half of the distance of the points, so that limits far from rest act. */
enum strain { COMPRESSED, STRETCHED, SHEARED, CRUMPLED, STRAINS };

enum body_kind { SURFACE, PARTICLES, VOLUME, BODY_KINDS };

/* What the scene of a trial gives to the parameters of the type. */
struct form {
    int exchanged;  /* 0: parameters that are true or false have their defaults; k: the k-th of them
                       has not; one above their number: none has */
    bool many_rows; /* tables of PDYN_ROWS have two rows for each vertex, not one */
};

struct check {                /* the checks of one constraint type or one solver */
    const pdyn_context *like; /* the trials have its types and allocator */
    const pdyn_constraint_type *type;
    const pdyn_global_solver *solver;
    enum body_kind kind; /* of the trial's body */
    enum strain strain;  /* of the trial's body */
    struct form form;    /* of the trial's parameters */
    int found;           /* elements of all trials */
    int active;          /* elements that pulled in some trial: u differed from p */
    void (*tell)(void *user, const char *text);
    void *user;
    int faults;
};

/* Reports a fault and counts it. */
void fault(struct check *check, const char *format, ...) PDYN_PRINTF(2, 3);

/* ---- trials ---------------------------------------------------------------------------------- */

struct trial { /* a scene at a deformed, randomly disturbed state */
    pdyn_context *context;
    pdyn_sim *sim;
    struct batch *batch, *rows; /* the type's batch; rows: its rows, equal to batch unless the type
                                   is matrix-free */
    int n;                      /* 3 x particles */
    double *x, *gradient, *u;   /* n: positions, gradient of E there, a random direction */
    double *y, *z, *w;          /* n: scratch */
    double *da, *db;            /* 2 n: scratch for block diagonals */
};

/* Creates a context with the same types and `threads` threads; NULL without memory. */
pdyn_context *trial_context(const pdyn_context *like, int threads);

enum trial_size { SMALL, LARGE, SIZES }; /* LARGE: parallel loops have several blocks */

/* A scene: one body of check->kind and this size with one constraint of this type; "solver": the
 * given type and step ("newton" or "projective"). */
struct trial_scene {
    const struct check *check;
    const pdyn_constraint_type *type;
    enum trial_size size;
    const char *solver, *step;
};
/* Loads it. */
pdyn_status trial_load(pdyn_context *context, const struct trial_scene *scene, pdyn_sim **out);
/* Whether the check's form exchanges a parameter of the type that is true or false. */
bool trial_exchanges(const struct check *check, const pdyn_constraint_type *type,
                     const pdyn_param *param);
/* Whether the parameters of the check's form are refused, by a rule of the type or of the scene. */
bool trial_is_refused(const struct check *check);

/* Gives each part of a body other numbers in the tables of its constraints, so that a wrong row
 * shows. */
pdyn_status trial_vary_tables(pdyn_sim *sim);

/* Loads a small scene with the newton step on one thread and sets a random state near rest. Returns
 * false, with a fault, if the scene does not load. */
bool trial_start(struct trial *trial, struct check *check, const pdyn_constraint_type *type,
                 const char *solver);
/* Frees the trial. Memory of the context that is still in use is a fault. */
void trial_finish(struct trial *trial, struct check *check);

double trial_dot(const double *a, const double *b, int n);
double trial_norm(const double *a, int n);
double trial_distance(const double *a, const double *b, int n);
/* Whether a - b is more than this part of b, in the norm, or not finite. */
bool trial_differ(const double *a, const double *b, int n, double tolerance);
double trial_random(uint64_t *seed); /* in [-1, 1) */

/* ---- the checks ------------------------------------------------------------------------------ */

typedef void check_fn(struct check *check, struct trial *trial);

check_fn check_callbacks; /* callbacks.c: what they write; no state between calls */
check_fn check_state;     /* state.c: no state but `memory` */
check_fn check_projection, check_closest, check_one_side, check_activity; /* mathematics.c */
check_fn check_tangent, check_gradient, check_work, check_momentum, check_damping_rest;
check_fn check_bounds, check_diagonal; /* H, mathematics.c */
check_fn check_stiffness, check_tiers; /* tiers.c: two realisations, equal results */
check_fn check_operator, check_model;  /* operator.c */

/* The checked type with every solver; the checked solver with every type (solvers.c). */
void check_solvers(struct check *check);
void check_steps(struct check *check);
void check_solver(struct check *check);

#endif
