/* The solvers of a simulation: the best bids, and trials of the other one from step to step. */
#include "solver_choice.h"

#include "base/registry.h"
#include "sim.h"

#include <float.h>
#include <limits.h>
#include <string.h>

enum { SHORTEST_WAIT = 8, LONGEST_WAIT = 64 }; /* steps between trials */

/* Steps with fewer linear iterations are not worth a trial. */
enum { CHEAP = 30 };

/* A step with more linear iterations than these, and so many times the work of those before, goes
 * on with the other solver: an impact begins, or a sheet becomes slack. */
enum { MANY = 200 };
static const double surprise = 4.0;

/* A step in positions that ends far from solved shortens the wait by so many steps. */
enum { FAR_OFF = 16 };

/* Steps of a trial that is won, and of the mean cost of a solver. A trial may be lost after two. */
enum { TRIAL = 4, LOST = 2 };

/* A step of a trial ends after so many times the cost of the other solver. */
static const double patience = 1.5;

/* An unsolved step counts as so many times its work. */
static const double unsolved_penalty = 4.0;

/* ---- which solvers --------------------------------------------------------------------------- */

static int bid_of(struct pdyn_sim *sim, const pdyn_global_solver *solver, const char **reason) {
    return solver->suits ? solver->suits(&sim->model.model, reason) : 1;
}

static bool has_dense_rows(const struct pdyn_sim *sim) {
    for (int k = 0; k < sim->objective.batches; k++)
        if (sim->objective.batch[k]->dense) return true;
    return false;
}

/* The solver with the highest bid; `dual`: among the dual ones. None that factors a dense H. */
static const pdyn_global_solver *best_solver(struct pdyn_sim *sim, bool dual, const char **reason) {
    const pdyn_global_solver *best = NULL, *solver;
    int highest = 0;
    for (int k = 0; (solver = registry_solver_at(sim->context, k)); k++) {
        const char *why = "";
        if ((dual && !solver->dual) || (solver->direct && has_dense_rows(sim))) continue;
        int bid = bid_of(sim, solver, &why);
        if (bid > highest) best = solver, highest = bid, *reason = why;
    }
    return best;
}

/* A direct solver factors H, and an element that couples all its particles makes that dense. */
static pdyn_status check_dense(struct pdyn_sim *sim, const pdyn_global_solver *solver) {
    for (int k = 0; k < sim->objective.batches; k++) {
        const struct batch *b = sim->objective.batch[k];
        if (!solver->direct || !sim->model.model.newton || !b->wide || b->rows <= MAX_DENSE)
            continue;
        return set_error(PDYN_BAD_INPUT,
                         "solver \"%s\": constraint \"%s\" on body \"%s\" couples %d vertices "
                         "with each other, and the newton step's matrix is dense; expected at "
                         "most %d, or the solver \"hybrid\" or \"cg\"",
                         solver->name, b->type->name, b->view.body->name, b->view.body->count,
                         MAX_DENSE);
    }
    return PDYN_OK;
}

static pdyn_status find_solver(struct pdyn_sim *sim, const char *name,
                               const pdyn_global_solver **out) {
    const char *reason = "";
    const pdyn_global_solver *solver = *out = registry_solver(sim->context, name);
    if (!solver) return set_error(PDYN_BAD_INPUT, "this build has no solver \"%s\"", name);
    if (!bid_of(sim, solver, &reason))
        return set_error(PDYN_BAD_INPUT,
                         "solver \"%s\" does not fit this scene: %s; expected another one, or "
                         "\"auto\", which takes one that fits",
                         name, *reason ? reason : solver->summary);
    return check_dense(sim, solver);
}

void solver_choice_warn(struct pdyn_sim *sim) {
    bool newton = sim->model.model.newton, dynamic = sim->objective.dynamic;
    if (!sim->solver->direct) return;
    if (has_dense_rows(sim))
        warnings_say(sim->context, sim_warning(sim, WARNING_FACTOR, sim->solver->name, 1, 0.0),
                     "a row of a constraint has more than %d entries, so the matrix is dense and "
                     "its factor takes long; \"cg\" needs no factor",
                     MAX_DENSE);
    if (dynamic || newton)
        warnings_say(sim->context, sim_warning(sim, WARNING_FACTOR, sim->solver->name, 1, 0.0),
                     "the matrix of this scene changes (%s), so it is factored in every iteration, "
                     "%s; \"cg\" needs no factor",
                     dynamic ? "constraints change every step" : "newton step",
                     newton ? "with 3 unknowns a particle"
                            : "after a new analysis where neighbours change");
}

static void activate(struct pdyn_sim *sim, int k) {
    struct solver_choice *c = &sim->choice;
    c->active = k, c->fresh = true;
    sim->solver = c->slot[k].solver, sim->solver_state = c->slot[k].state;
    if (k && sim->solver->forget) sim->solver->forget(sim->solver_state);
}

/* The other solver is in use from now on, with the damping that it had. */
static void change_solver(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    c->slot[c->active].damping = sim->eps;
    c->used = 0;
    activate(sim, !c->active);
    sim->eps = c->slot[c->active].damping;
}

static pdyn_status create_slot(struct pdyn_sim *sim, const pdyn_global_solver *solver) {
    struct solver_choice *c = &sim->choice;
    struct solver_slot *slot = &c->slot[c->count++];
    slot->solver = solver;
    slot->state = context_array(sim->context, 1, solver->state_size);
    if (!slot->state) return PDYN_NO_MEMORY;
    unsigned errors = error_count();
    return error_of_module(solver->name, solver->create(slot->state, &sim->model.model), errors);
}

pdyn_status solver_choice_create(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    const char *name = sim->scene.settings.solver_type, *unused = "";
    const pdyn_global_solver *first = NULL, *second = NULL;
    pdyn_status status = solver_view_create(&sim->model, &sim->objective,
                                            sim->scene.settings.newton, &sim->services);
    if (status != PDYN_OK) return status;
    c->reason = "as the scene asks";
    if (strcmp(name, "auto")) status = find_solver(sim, name, &first);
    else {
        first = best_solver(sim, false, &c->reason);
        if (!first->dual && sim->scene.settings.newton) second = best_solver(sim, true, &unused);
    }
    if (status == PDYN_OK) status = create_slot(sim, first);
    if (status == PDYN_OK && second) status = create_slot(sim, second);
    if (status != PDYN_OK) return status;
    c->wait = SHORTEST_WAIT, c->next = sim->steps + SHORTEST_WAIT;
    activate(sim, 0);
    return PDYN_OK;
}

void solver_choice_free(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    for (int k = 0; k < c->count; k++) {
        struct solver_slot *slot = &c->slot[k];
        if (!slot->state) continue;
        slot->solver->free(slot->state);
        context_resize(sim->context, slot->state, slot->solver->state_size, 0);
    }
    solver_view_free(&sim->model);
    *c = (struct solver_choice){.dual_steps = c->dual_steps}, sim->model = (struct solver_view){0};
}

/* ---- from step to step ----------------------------------------------------------------------- */

/* A step that was cut short far from its minimum has moved too little with a solver for positions.
 * With a dual one it may be anywhere, and the scene would stop within a few steps. */
static bool dual_has_failed(const struct pdyn_sim *sim) {
    return sim->far_off && sim->solver->dual;
}

/* The solver in use stays for a while; lost: the other one was tried in vain. */
static void wait_for_trial(struct pdyn_sim *sim, bool lost) {
    struct solver_choice *c = &sim->choice;
    c->wait = !lost ? SHORTEST_WAIT : 2 * c->wait < LONGEST_WAIT ? 2 * c->wait : LONGEST_WAIT;
    c->next = sim->steps + c->wait, c->trial = false;
}

/* Where neither solver solves the steps, every second step has a dual solver at first, and one in
 * five after the longest wait. */
static void shorten_wait(struct pdyn_sim *sim) {
    long *next = &sim->choice.next;
    *next = sim->steps + FAR_OFF < *next ? *next - FAR_OFF : sim->steps;
}

void solver_choice_open(struct pdyn_sim *sim) { sim->choice.opened = sim->objective.work; }

static double work_of_step(const struct pdyn_sim *sim) {
    return (double)(sim->objective.work - sim->choice.opened);
}

/* The mean of the first steps in use, then a running one. */
static void update_cost(struct solver_choice *c, double cost) {
    double *mean = &c->slot[c->active].cost;
    c->used = c->used < TRIAL ? c->used + 1 : TRIAL;
    *mean = c->used == 1 ? cost : *mean + (cost - *mean) / (double)c->used;
}

static bool is_worse(const struct solver_choice *c) {
    return c->slot[c->active].cost > c->slot[!c->active].cost;
}

/* Decides a trial, or after a step that failed. shared: the other solver began the step. Returns
 * whether the next step has the solver in use. */
static bool decide(struct pdyn_sim *sim, bool shared) {
    struct solver_choice *c = &sim->choice;
    bool failed = dual_has_failed(sim), lost = shared && c->trial;
    if (failed) c->slot[c->active].cost = DBL_MAX; /* no trial before the end of the wait */
    if (failed || (c->trial && !shared && c->used >= LOST && is_worse(c))) {
        change_solver(sim);
        lost = true;
    }
    if (lost) c->used = TRIAL; /* its cost is the mean that it had */
    bool decided = lost || shared || (c->trial && c->used == TRIAL);
    if (decided) wait_for_trial(sim, lost);
    if (shared && !lost) c->trial = true; /* of the solver that ended the step */
    return decided;
}

void solver_choice_step(struct pdyn_sim *sim, int iterations) {
    struct solver_choice *c = &sim->choice;
    double cost = work_of_step(sim) * (sim->solved ? 1.0 : unsolved_penalty);
    bool shared = c->handed_over;
    c->handed_over = false;
    c->dual_steps += sim->solver->dual;
    if (c->count < 2) return;
    if (shared) c->slot[!c->active].cost = cost;
    if (!shared || !c->trial) update_cost(c, cost); /* else the trial has spoilt the step */
    if (decide(sim, shared) || c->trial || iterations <= CHEAP) return;
    if (sim->far_off) shorten_wait(sim);
    if (sim->steps < c->next && !is_worse(c)) return;
    change_solver(sim);
    c->trial = true;
}

bool solver_choice_has_lost(const struct pdyn_sim *sim, int iterations) {
    const struct solver_choice *c = &sim->choice;
    double work = work_of_step(sim);
    if (c->count < 2 || c->handed_over) return false;
    if (c->trial) return work > patience * c->slot[!c->active].cost;
    return iterations > MANY && work > surprise * c->slot[c->active].cost;
}

bool solver_choice_hand_over(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    if (c->count < 2 || c->handed_over) return false;
    c->handed_over = true;
    change_solver(sim);
    return true;
}

void solver_choice_reject(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    if (sim->solver->forget) sim->solver->forget(sim->solver_state);
    c->trial = c->handed_over = false, c->next = sim->steps + c->wait;
    if (c->active) change_solver(sim);
}

/* ---- saved states ---------------------------------------------------------------------------- */

static void persist_numbers(struct solver_choice *c, struct snapshot_file *file) {
    snapshot_file_flags(file, &c->trial, 1, "the flag of a trial is neither 0 nor 1");
    snapshot_file_long(file, &c->used, TRIAL, "the steps of a solver are out of range");
    snapshot_file_long(file, &c->wait, LONGEST_WAIT, "the steps between trials are out of range");
    snapshot_file_long(file, &c->next, LONG_MAX, "the step of the next trial is negative");
    snapshot_file_long(file, &c->dual_steps, LONG_MAX, "the number of dual steps is negative");
    for (int k = 0; k < c->count; k++) {
        snapshot_file_numbers(file, &c->slot[k].cost, 1, "the cost of a step is not finite");
        snapshot_file_range(file, &c->slot[k].damping, 1, 1.0,
                            "the damping is not between 0 and 1");
    }
}

void solver_choice_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    struct solver_choice *c = &sim->choice;
    long active = c->active;
    snapshot_file_long(file, &active, c->count - 1, "the solver in use is out of range");
    persist_numbers(c, file);
    if (file->view.reading && file->status == PDYN_OK) activate(sim, (int)active);
    for (int k = 0; k < c->count && file->status == PDYN_OK; k++) {
        const pdyn_global_solver *solver = c->slot[k].solver;
        unsigned errors = error_count();
        if (solver->persist)
            file->status = error_of_module(solver->name,
                                           solver->persist(c->slot[k].state, &file->view), errors);
    }
}
