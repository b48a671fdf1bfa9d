/* A batch: one constraint type on one body. Both tiers of module.h have the same interface here:
 * local step, product with the batch's part of the Hessian, and block diagonal of that part. For
 * the rows tier they are computed from the type's callbacks, for the operator tier by its operator.
 *
 * batch.c has the functions, but for those that create, refresh and free a batch (batch_build.c),
 * of elements that come and go (dynamic_rows.c) and batch_block (row_tangent.c). What only the
 * files of rows/ call is in row_arrays.h and row_loops.h. */
#ifndef PDYN_BATCH_H
#define PDYN_BATCH_H

#include "base/context.h"
#include "linear_rows.h"
#include "one_sided.h"
#include "projdyn/module.h"
#include "rigid_map.h"
#include "row_memory.h"

struct touch { /* an entry, in the list of its particle */
    double coefficient;
    int row, entry;
};

enum { MAX_DENSE = 300 }; /* vertices of a dense matrix: a factor takes 0.1 s */

struct batch {
    pdyn_context *context;
    const pdyn_constraint_type *type;
    const void *params;
    pdyn_batch view;            /* what the type sees; arrays owned here */
    void *op;                   /* operator tier: the type's state */
    struct one_sided one_sided; /* operator tier: its constraints */
    /* operator tier: vectors have the values of the samples appended; NULL: no samples */
    struct surface_samples *samples;
    double *lumped;  /* beside samples: one_sided.D */
    double eps;      /* damping of the current linearisation */
    double energy;   /* J, at the last local step */
    double left_out; /* part of impact forces that did not change velocities in the last step. The
                        mean force is w (u - p) less left_out times the flux, which holds the
                        impact forces; for pins, less left_out times itself (forces_pass_on) */
    bool damper;     /* the second batch of pdyn_constraint_type.damping */
    double damping;  /* of a damper, s */
    bool off;        /* switched off: all weights are 0 */
    bool weights_change; /* the last `begin` changed a weight */

    /* rows tier */
    int rows, entries;
    struct {
        int elements, rows, entries;
    } room;            /* of the arrays */
    unsigned revision; /* changes when the selector does */
    int width;         /* entries of every row, or 0 where they differ */
    bool single;       /* every element is a row that selects no particle twice */
    bool wide;         /* tangent_rank1 and elements of several rows: each couples all its particles
                          and is in products and diagonals of H, but not in preconditioners */
    bool dense;        /* a row has more than MAX_DENSE entries; left out in the same way */
    double *flux;      /* rows x 4: w (u - p), or w ((1 - eps)(I - J) + eps I) u */
    size_t *block_start; /* elements + 1 */
    double *block;       /* B = w ((1 - eps)(I - J) + eps I) of each element, (3 rows)^2 numbers;
                            with tangent_rank1 B = m m' + a I, 3 rows + 1 numbers, m and a; NULL
                            until eps is below 1 for the first time */
    int grain;           /* elements of a parallel block */
    double *partial;     /* one number for each of these blocks */
    struct linear_rows *linear;     /* replaces all rows in products and local steps; NULL: none */
    int *entry_element, *entry_row; /* entries: their elements and rows */
    int touch_first, touch_count;   /* rows select only particles of this range of the system */
    int touch_room;                 /* particles that touch_start has room for */
    int *touch_start;               /* touch_count + 1: first entry of each particle in `touch` */
    struct touch *touch;            /* entries, ascending for each particle */
    struct row_memory memory;       /* what elements that come and go left to the next step */
};

struct batch_def { /* what a batch is made from; all of it outlives the batch */
    const pdyn_constraint_type *type;
    const void *params;
    const pdyn_body *body;
    const pdyn_neighbours *neighbours; /* NULL in a scene without SPH sums */
    const pdyn_services *services;     /* for the type's operator */
};

/* ---- creation, other parameters -------------------------------------------------------------- */

/* Makes a batch: rows, or the operator of a matrix-free type. After a failure *out is NULL. */
pdyn_status batch_create(pdyn_context *context, const struct batch_def *def, struct batch **out);
/* Makes a second batch of the same constraint that has rows: also where its type has an operator,
 * and one by one where batch_join_rows has added them up. For assembly and tests. */
pdyn_status batch_create_rows(const struct batch *batch, struct batch **out);
void batch_free(struct batch *batch);

/* Whether `batch` is that of a constraint of the scene, or that of its damping. */
static inline bool batch_belongs_to(const struct batch *batch, const struct batch *constraint) {
    return batch == constraint ||
           (batch->damper && batch->type == constraint->type &&
            batch->params == constraint->params && batch->view.body == constraint->view.body);
}

/* Whether it couples so many particles with each other that preconditioners leave it out. */
static inline bool batch_couples_all(const struct batch *b) { return b->wide || b->dense; }
/* Whether the selector is the same in all steps. */
static inline bool batch_is_static(const struct batch *b) { return !b->op && !b->type->update; }
/* Whether every step computes weights of the type anew after `begin`. */
static inline bool type_weighs_in_steps(const pdyn_constraint_type *type) {
    return type->begin && !(type->flags & PDYN_STEADY);
}
/* Whether its weights depend on parameters alone: not on the length of a step, or on its begin. */
static inline bool batch_is_steady(const struct batch *b) {
    return !b->damper && !type_weighs_in_steps(b->type);
}
/* Whether its elements come and go. */
static inline bool batch_comes_and_goes(const struct batch *b) { return !b->op && b->type->update; }

/* Whether constraints of the type may give energy, whatever their parameters are (module.h,
 * pdyn_constraint_type.energy). */
static inline bool type_gives_energy(const pdyn_constraint_type *type) {
    return (type->flags & PDYN_LOSSY) || type->begin || type->update || type->end;
}

/* Replaces the rows by one constant matrix if the type says that they are linear. u, p and flux are
 * not used then. */
pdyn_status batch_join_rows(struct batch *batch);

/* Makes a batch the damper of another one of the same type and parameters. */
void batch_make_damper(struct batch *batch);

/* The parameters have changed, or `off` has: fills data and weights anew, or tells the operator.
 * Sets *changed to true unless rows and weights, of which solvers keep something, are the same.
 * PDYN_BAD_INPUT: the elements or their rows are others with these parameters, or a weight is not
 * valid; the batch is to be refreshed again with valid ones then. */
pdyn_status batch_refresh(struct batch *batch, bool *changed);

/* ---- a step: its beginning and its end ------------------------------------------------------- */

/* The step that ended at the last local step was taken: calls the type's `end`, if it has one.
 * batch_prepare_end makes the memory for it: PDYN_NO_MEMORY. */
pdyn_status batch_prepare_end(struct batch *batch);
void batch_end(struct batch *batch);
/* Gives each element the memory that the last step left to it. */
void batch_recall(struct batch *batch);

struct step_start { /* where a step begins; all particles x 3, m and m/s */
    const double *x, *v;
    const double *x_before;        /* x of the step before; NULL: none */
    const double *x_base, *v_base; /* of step/integrator.h */
};

struct batch_step {               /* of the integrator, see pdyn_batch */
    double length, extrapolation; /* s; 1 */
    double h;                     /* s, effective length */
    double time;                  /* s, at its end */
};

/* Tells the type's callbacks the time and the lengths of the step; batch_begin does so, too. */
void batch_set_step(struct batch *batch, const struct batch_step *step);

/* Begins a step: at the state x, v, updates elements that come and go from step to step; then, at
 * the base, calls the type's `begin`, or gives a damper its rest shape and weights. */
pdyn_status batch_begin(struct batch *batch, const struct step_start *start,
                        const struct batch_step *step);

/* Gives an operator new neighbour lists. */
pdyn_status batch_neighbours(struct batch *batch, const pdyn_neighbours *neighbours);

/* ---- local steps, and products with H -------------------------------------------------------- */

/* Local step at x (particles x 3; with samples for an operator that has them): projects, sets
 * batch->energy, J, and adds to the gradient, N. */
pdyn_status batch_local(struct batch *batch, const double *x, double *gradient);

/* Fixes the tangent at the x of the last local step, damped with eps in [0, 1]. */
pdyn_status batch_linearise(struct batch *batch, double eps);

/* y += G' B G u, B = w ((1 - eps)(I - J) + eps I) */
void batch_apply(struct batch *batch, const double *u, double *y);

/* Adds the 3 x 3 block diagonal of G' B G, packed xx xy xz yy yz zz, particles x 6. */
void batch_diagonal(struct batch *batch, double *blocks);

/* Products, for particles from first to before last, and diagonal without one-sided constraints:
 * the part of H that always acts. Rows select only these particles. */
void batch_apply_remainder(struct batch *batch, int first, int last, const double *u, double *y);
void batch_diagonal_remainder(struct batch *batch, double *blocks);

/* ---- forces and impacts at the end of a step ------------------------------------------------- */

struct velocity_change {  /* by a step of effective length h, s */
    const double *slowed; /* particles x 3: velocities before the step minus those after, m/s */
    const double *after;  /* particles x 3: velocities after the step, m/s */
    const double *start;  /* particles x 3: positions before the step, m */
    const pdyn_neighbours *lists; /* NULL in a scene without SPH sums */
    double taken; /* part of the impulse of an impact that is taken off the velocities */
    int particles;
    const double *mass;            /* particles, kg */
    const struct rigid_map *rigid; /* NULL: there are no rigid bodies */
    double h;
    bool solved; /* to the tolerance of the scene */
    /* particles: the part of the acceleration by one-sided forces that a particle makes, because
     * other forces, as of pins, hold it; NULL: all of it */
    const double *yield;
    /* particles x 3, m/s^2: minus the acceleration by all forces of a batch
     * (batch_find_acceleration); in batch_impacts times the yield */
    double *acceleration;
};

/* Whether the forces of a batch can be impacts. */
bool batch_has_impacts(const struct batch *batch);
/* Whether a batch holds a body by pins. */
bool batch_pins(const struct batch *batch, const pdyn_body *body);
/* Whether pins of a batch hold this particle. */
bool batch_pins_particle(const struct batch *batch, int particle);

/* Computes change->acceleration at the last local step: the gradient of the batch's energy over the
 * masses. Ignores change->yield. */
void batch_find_acceleration(struct batch *batch, const struct velocity_change *change);

/* One-sided constraints: force += the impact part (one_sided.h) of their forces at the last local
 * step, N, with the sign of the gradient. Returns the number of constraints or rows with an impact.
 * Overwrites the flux of rows. */
int batch_impacts(struct batch *batch, const struct velocity_change *change, double *force);
/* After batch_impacts, rows tier: adds the impacts between particles alone, and none of solids.
 * Returns whether there are rows. */
bool batch_impacts_between(const struct batch *batch, double *force);
/* Joins the particles of each row with such an impact (base/groups.h). */
void batch_join_impacts(const struct batch *batch, int *group);
/* Rows tier: joins the particles of each row of a batch that has particles of several bodies. */
void batch_join_bodies(const struct batch *batch, int *group);
/* After batch_impacts, rows tier: of the impacts between particles and solids, keeps the part that
 * the particles (kept: one part each, weighted by coefficients) have kept. */
void batch_keep_impacts(struct batch *batch, const double *kept);

/* ---- what operators add to a step ------------------------------------------------------------ */

/* Calls `velocity`, `limit` and `accept` of pdyn_operator, where the batch has these callbacks. For
 * batch_limit, x ends with the samples. */
void batch_velocity(struct batch *batch, double *v);
void batch_limit(struct batch *batch, const double *x, double *max_step);
/* left_out: the part of the impacts that the integrator left out; 0: batch_impacts was not called.
 * solved: the step was solved to the tolerance of the scene. */
void batch_accept(struct batch *batch, double left_out, bool solved);

/* Operator tier: rate_i = grad C_i . u for the constraints marked in `which`; y += sum of
 * multiplier_i grad C_i. u, y: particles x 3 */
void batch_rate(struct batch *batch, const bool *which, const double *u, double *rate);
void batch_force(struct batch *batch, const double *multiplier, double *y);

/* ---- the model along a direction ------------------------------------------------------------- */

/* The model along a direction u, see one_sided.h. */
void batch_set_direction(struct batch *batch, const double *u);
int batch_count_side_changes(struct batch *batch);
double batch_slope(struct batch *batch, double t, double *curvature);
void batch_step_along(struct batch *batch, double t, double *y);

/* ---- what rows and types are ----------------------------------------------------------------- */

/* Sets selected[i] to true for each particle i that a row selects. */
void batch_mark_selected(const struct batch *batch, bool *selected);

/* Whether J of the type's elements is not 0. */
static inline bool type_has_tangent(const pdyn_constraint_type *type) {
    return type->tangent || type->tangent_rank1 || type->flags & PDYN_NUMERIC_TANGENT;
}
/* Whether its elements act on one side only. */
static inline bool type_is_one_sided(const pdyn_constraint_type *type, const void *params) {
    return type->flags & PDYN_ONE_SIDED || (type->one_sided && type->one_sided(params));
}
/* Whether its energy is stored, not dissipated in the step. */
static inline bool type_stores_energy(const pdyn_constraint_type *type) {
    return !(type->flags & PDYN_LOSSY);
}
/* Rows tier: whether B is stored by blocks, because it is not w I. */
static inline bool batch_has_blocks(const struct batch *b) {
    return b->eps < 1.0 && !b->linear && type_has_tangent(b->type);
}
/* Rows tier: the 3 x 3 part of B between the rows of two entries of one element. */
void batch_block(const struct batch *batch, int k, int m, double B[9]);

#endif
