/* The linear solvers of a simulation. A scene with a fluid beside other constraints has two that
 * suit: one for positions (hybrid, cg) and one for the pressures of the fluid (dual). Which one
 * costs less depends on the scene and on the moment: an impact of stiff water takes thousands of
 * iterations in positions and some dozens in pressures, and calm water the other way round.
 *
 * Where the scene asks for "auto", work is counted (objective.work): the solver in use is the one
 * whose steps take less. The cost of a solver is the mean of its last steps. The other one is tried
 * when its cost is less, as last known, or after a number of steps, which grows with every trial
 * that it loses. It wins with four steps whose mean is less: a single cheap step decides nothing. A
 * step that takes many times the work of the steps before it is ended by the other solver: the
 * first step of its trial. After a step in pressures that ends far from solved, positions are used
 * for a while; steps in positions that end far from solved, too, shorten this wait. A solver that
 * comes back into use has the damping that it had: to find it again would take up to three times
 * the work of a step. Counts decide, never times, so that results are the same on every machine.
 */
#ifndef PDYN_SOLVER_CHOICE_H
#define PDYN_SOLVER_CHOICE_H

#include "base/snapshot_file.h"

#include <stdint.h>

struct pdyn_sim;

struct solver_slot {
    const pdyn_global_solver *solver;
    void *state;    /* solver->state_size bytes */
    double cost;    /* mean work of its last steps */
    double damping; /* eps at the end of its last step, while it is not in use */
};

struct solver_choice {
    struct solver_slot slot[2]; /* the best one by its bid, then a dual one */
    int count, active;          /* number of slots; the slot in use: sim->solver */
    const char *reason;         /* for the first one, in words */
    bool trial;                 /* this step is a trial of the active one */
    bool fresh;                 /* the active one has not solved in this step yet */
    bool handed_over;           /* this step goes on with the solver that did not begin it */
    long used;                  /* steps in the cost of the active one, up to those of a trial */
    long wait, next;            /* steps between two trials; step of the next trial */
    int64_t opened;             /* objective.work at the beginning of this attempt at a step */
    long dual_steps;            /* accepted steps with a dual solver */
};

/* Creates the model that solvers get (sim->model), and the solver that the scene names or those
 * that suit it. PDYN_BAD_INPUT: it does not exist, or cannot solve the scene. After a failure the
 * choice is to be freed, too. */
pdyn_status solver_choice_create(struct pdyn_sim *sim);
/* Frees the solvers and the model, which refer to batches; they can be created again. The number of
 * dual steps stays. */
void solver_choice_free(struct pdyn_sim *sim);

/* Warns where a direct solver factors a matrix that changes. */
void solver_choice_warn(struct pdyn_sim *sim);

/* An attempt at a step begins: its work is counted from here. */
void solver_choice_open(struct pdyn_sim *sim);

/* Chooses the solver of the next step after an accepted one that took so many linear iterations. */
void solver_choice_step(struct pdyn_sim *sim, int iterations);

/* Whether the solver on trial has taken more work than it may, or the solver in use has taken many
 * times its mean work. */
bool solver_choice_has_lost(const struct pdyn_sim *sim, int iterations);

/* The other solver continues the step: after a lost trial, in an impact, or where a dual solver
 * makes no progress. Returns false if there is no other one, or if it has handed over already. */
bool solver_choice_hand_over(struct pdyn_sim *sim);

/* After a failed attempt at a step: the solvers forget what they keep, and the next attempt is made
 * in positions. */
void solver_choice_reject(struct pdyn_sim *sim);

void solver_choice_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
