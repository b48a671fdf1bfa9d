#include "solver_choice.h"

#include "base/registry.h"
#include "sim.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { MAX_DENSE = 300 }; /* vertices of a dense matrix: a factor takes 0.1 s */
/* Work is counted in products with H (objective.h). Steps with less are not worth a trial. */
static const double cheap = 50.0;

/* In a step, a solver may take so many times the work that is expected of the other one. */
static const double patience = 1.5;

/* The expected work of the solver in use is the mean of the last expectation and the last step.
 * That of the other one is at first a multiple of the first step; after it has handed over, a
 * multiple of the work that it has taken. It falls by a factor in each step, until the other one is
 * tried. */
static const double guess = 1.5, caution = 1.5, decay = 0.985;

/* The work of an unsolved step, or of one without progress, counts so many times. */
static const double unsolved_penalty = 4.0;

/* ---- which solvers --------------------------------------------------------------------------- */

static int bid_of(struct pdyn_sim *sim, const pdyn_global_solver *solver, const char **reason) {
    return solver->suits ? solver->suits(&sim->model.model, reason) : 1;
}

/* The solver with the highest bid; `dual`: among the dual ones. */
static const pdyn_global_solver *best_solver(struct pdyn_sim *sim, bool dual, const char **reason) {
    const pdyn_global_solver *best = NULL, *solver;
    int highest = 0;
    for (int k = 0; (solver = registry_solver_at(sim->context, k)); k++) {
        const char *why = "";
        int bid = dual && !solver->dual ? 0 : bid_of(sim, solver, &why);
        if (bid > highest) best = solver, highest = bid, *reason = why;
    }
    return best;
}

/* A direct solver factors H, and an element that couples all its particles makes that dense. */
static pdyn_status check_dense(struct pdyn_sim *sim, const pdyn_global_solver *solver) {
    for (int k = 0; k < sim->objective.batches; k++) {
        const struct batch *b = sim->objective.batch[k];
        if (!solver->direct || !sim->scene.settings.newton || !b->wide || b->rows <= MAX_DENSE)
            continue;
        return context_fail(sim->context, PDYN_BAD_INPUT,
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
    if (!solver)
        return context_fail(sim->context, PDYN_BAD_INPUT, "this build has no solver \"%s\"", name);
    if (!bid_of(sim, solver, &reason))
        return context_fail(sim->context, PDYN_BAD_INPUT,
                            "solver \"%s\" does not fit this scene: %s", name, solver->summary);
    return check_dense(sim, solver);
}

void solver_choice_warn(struct pdyn_sim *sim) {
    bool newton = sim->scene.settings.newton, dynamic = sim->objective.dynamic_rows;
    if (!sim->solver->direct || !(dynamic || newton)) return;
    warnings_say(sim->context,
                 warnings_count(&sim->warnings, WARNING_FACTOR, sim->solver->name, 0.0, 1, 0.0),
                 "the matrix of this scene changes (%s), so it is factored in every iteration, %s; "
                 "\"cg\" needs no factor",
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

static pdyn_status create_slot(struct pdyn_sim *sim, const pdyn_global_solver *solver) {
    struct solver_choice *c = &sim->choice;
    struct solver_slot *slot = &c->slot[c->count++];
    slot->solver = solver;
    slot->state = context_array(sim->context, 1, solver->state_size);
    if (!slot->state) return PDYN_NO_MEMORY;
    pdyn_status status = solver->create(slot->state, &sim->model.model);
    return status == PDYN_NO_MEMORY ? context_no_memory(sim->context) : status;
}

pdyn_status solver_choice_create(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    const char *name = sim->scene.settings.solver_type, *unused = "";
    const pdyn_global_solver *first = NULL, *second = NULL;
    pdyn_status status = PDYN_OK;
    c->reason = "as the scene asks";
    if (strcmp(name, "auto")) status = find_solver(sim, name, &first);
    else {
        first = best_solver(sim, false, &c->reason);
        if (!first->dual && sim->scene.settings.newton) second = best_solver(sim, true, &unused);
    }
    if (status == PDYN_OK) status = create_slot(sim, first);
    if (status == PDYN_OK && second) status = create_slot(sim, second);
    if (status != PDYN_OK) return status;
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
}

/* ---- from step to step ----------------------------------------------------------------------- */

void solver_choice_step(struct pdyn_sim *sim, bool solved) {
    struct solver_choice *c = &sim->choice;
    struct solver_slot *now = &c->slot[c->active], *other = &c->slot[!c->active];
    double work = sim->objective.work;
    if (c->count < 2) return;
    c->dual_steps += c->active;
    double taken = (work - c->spent) * (solved ? 1.0 : unsolved_penalty);
    now->cost = now->cost > 0.0 ? 0.5 * (now->cost + taken) : taken;
    other->cost = other->cost > 0.0 ? decay * other->cost : guess * now->cost;
    c->handed_over = false, c->spent = 0.0;
    if (now->cost > cheap && now->cost > other->cost) activate(sim, !c->active);
}

double solver_choice_allowance(const struct pdyn_sim *sim) {
    const struct solver_choice *c = &sim->choice;
    double other = c->slot[!c->active].cost;
    if (c->count < 2 || c->handed_over || other == 0.0) return INFINITY;
    return fmax(cheap, patience * other) - sim->objective.work;
}

bool solver_choice_hand_over(struct pdyn_sim *sim, bool moved) {
    struct solver_choice *c = &sim->choice;
    if (c->count < 2 || c->handed_over) return false;
    c->handed_over = true, c->spent = sim->objective.work, sim->damping = 0.0;
    c->slot[c->active].cost = caution * c->spent * (moved ? 1.0 : unsolved_penalty);
    activate(sim, !c->active);
    return true;
}

void solver_choice_reject(struct pdyn_sim *sim) {
    struct solver_choice *c = &sim->choice;
    if (sim->solver->forget) sim->solver->forget(sim->solver_state);
    c->handed_over = true, c->spent = 0.0;
    if (c->active) activate(sim, 0);
}

/* ---- saved states ---------------------------------------------------------------------------- */

static void persist_numbers(struct solver_choice *c, struct snapshot_file *a) {
    snapshot_file_flags(a, &c->handed_over, 1,
                        "the flag of a step in one solver is neither 0 nor 1");
    snapshot_file_long(a, &c->dual_steps, LONG_MAX, "the number of dual steps is negative");
    for (int k = 0; k < c->count; k++)
        snapshot_file_numbers(a, &c->slot[k].cost, 1, "the cost of a step is not finite");
}

void solver_choice_persist(struct pdyn_sim *sim, struct snapshot_file *a) {
    struct solver_choice *c = &sim->choice;
    long active = c->active;
    snapshot_file_long(a, &active, c->count - 1, "the solver in use is out of range");
    persist_numbers(c, a);
    if (a->view.reading && a->status == PDYN_OK) activate(sim, (int)active);
    for (int k = 0; k < c->count && a->status == PDYN_OK; k++) {
        const pdyn_global_solver *solver = c->slot[k].solver;
        if (solver->persist) a->status = solver->persist(c->slot[k].state, &a->view);
    }
}
