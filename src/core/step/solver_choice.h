/* The linear solvers of a simulation. A scene with a fluid beside other constraints has two that
 * suit: one for positions (hybrid, cg) and one for the pressures of the fluid (dual). Which one
 * costs less depends on the scene and on the moment: an impact of stiff water takes thousands of
 * iterations in positions and some dozens in pressures, and calm water the other way round.
 *
 * Where the scene asks for "auto", work is counted in products with H, of which `dual` makes parts:
 * those with the rows alone, and those with the gradients of the fluid. A step begins with the
 * solver of which less work is expected, by its last step. When that takes more work than is
 * expected of the other one, the other one continues the step where it is. Counts decide, never
 * times, so that results are the same on every machine. */
#ifndef PDYN_SOLVER_CHOICE_H
#define PDYN_SOLVER_CHOICE_H

#include "base/snapshot_file.h"

struct pdyn_sim;

struct solver_slot {
    const pdyn_global_solver *solver;
    void *state; /* solver->state_size bytes */
    double cost; /* expected work of a step */
};

struct solver_choice {
    struct solver_slot slot[2]; /* the best one by its bid, then a dual one */
    int count, active;          /* number of slots; the slot in use: sim->solver */
    const char *reason;         /* for the first one, in words */
    bool fresh;                 /* the active one has not solved in this step yet */
    bool handed_over;           /* the active one ends this step, whatever its work */
    double spent;               /* work of the step by the one that handed over */
    long dual_steps;            /* accepted steps with the second one */
};

/* Creates the solver that the scene names, or those that suit it. PDYN_BAD_INPUT: it does not
 * exist, or cannot solve the scene. After a failure the choice is to be freed, too. */
pdyn_status solver_choice_create(struct pdyn_sim *sim);
void solver_choice_free(struct pdyn_sim *sim);

/* Warns where a direct solver factors a matrix that changes. */
void solver_choice_warn(struct pdyn_sim *sim);

/* Chooses the solver of the next step. */
void solver_choice_step(struct pdyn_sim *sim, bool solved);

/* Work that the solver in use may take before it has to hand over; INFINITY: any. */
double solver_choice_allowance(const struct pdyn_sim *sim);

/* The other solver continues the step. moved: this one still makes progress. Returns false if there
 * is no other one, or if one has handed over already. */
bool solver_choice_hand_over(struct pdyn_sim *sim, bool moved);

/* After a failed attempt at a step: the solvers forget what they keep, and the next attempt is made
 * in positions. */
void solver_choice_reject(struct pdyn_sim *sim);

void solver_choice_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
