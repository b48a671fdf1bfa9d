/* Checks that elements keep state in `memory` alone. What they keep elsewhere, in `data` from step
 * to step or in variables of the plug-in, is not in saved states, and bodies share the variables.
 */
#include "guarded.h"

#include <string.h>

static void run(const struct guarded *g, const char *name, callback *plain) {
    const struct call call = call_of(name, plain, 0);
    if (plain) guarded_run(g, &call, 0, g->view.elements);
}

static void scale_u(struct guarded *g, double factor) {
    double *u = guarded_array(g, U);
    for (size_t k = 0; k < g->array[U].bytes / sizeof *u; k++) u[k] *= factor;
}

/* `select`, then `begin` at these multiples of u. */
static void begin_steps(struct guarded *g, const double *factor, int steps) {
    const pdyn_constraint_type *type = g->from->type;
    guarded_fill(g, 1u << DATA | 1u << WEIGHT, 0, g->view.elements, 0);
    run(g, "select", type->select);
    for (int k = 0; k < steps; k++) {
        scale_u(g, factor[k]);
        run(g, "begin", type->begin);
        guarded_restore_u(g);
    }
}

/* The data of a step follow from u at its beginning, whatever was before. */
static void check_begin(struct check *check, struct guarded *a, struct guarded *b) {
    static const double once[] = {1.0}, after_larger[] = {2.0, 1.0}, after_smaller[] = {0.5, 1.0};
    if (!a->from->type->begin) return;
    begin_steps(a, once, 1), begin_steps(b, after_larger, 2);
    bool keeps = !guarded_same(a, b, DATA);
    begin_steps(b, after_smaller, 2);
    if (keeps || !guarded_same(a, b, DATA))
        fault(check, "begin writes other data after another step: data keep state, which saved "
                     "states lack; it belongs in `memory`");
}

/* PDYN_STEADY: the weights are those before the first step, whatever `begin` writes. */
static void check_steady(struct check *check, struct guarded *g) {
    static const double larger[] = {2.0};
    if (!(g->from->type->flags & PDYN_STEADY)) return;
    begin_steps(g, larger, g->from->type->begin ? 1 : 0);
    run(g, "weight", g->from->type->weight);
    if (memcmp(g->view.weight, g->from->view.weight, g->array[WEIGHT].bytes))
        fault(check, "weight depends on what `begin` writes, but with PDYN_STEADY it is not called "
                     "in every step: do not set this flag");
}

/* Calls the callbacks as for another body, in another step. */
static void call_for_another(struct guarded *g) {
    const pdyn_constraint_type *type = g->from->type;
    g->view.time += 0.37, g->view.h *= 2.0, g->view.length *= 2.0;
    scale_u(g, 1.5);
    run(g, "select", type->select), run(g, "begin", type->begin);
    run(g, "weight", type->weight), run(g, "project", type->project);
    run(g, "end", type->end);
}

/* Weights and p follow from the arrays of the batch alone. b has the results before the calls for
 * another body. */
static void check_variables(struct check *check, struct guarded *a, struct guarded *b) {
    const pdyn_constraint_type *type = a->from->type;
    struct guarded other;
    if (!guarded_create(&other, a->from)) return;
    struct guarded *both[] = {b, a};
    for (int k = 0; k < 2; k++) {
        if (k) call_for_another(&other);
        run(both[k], "weight", type->weight), run(both[k], "project", type->project);
    }
    static const char *const message =
        "%s gives another %s after callbacks have run for another body: it keeps state in a "
        "variable of the plug-in; state belongs in `data` or `memory`";
    if (!guarded_same(a, b, WEIGHT)) fault(check, message, "weight", "weight");
    else if (!guarded_same(a, b, P)) fault(check, message, "project", "p");
    guarded_free(&other);
}

void check_state(struct check *check, struct trial *trial) {
    struct guarded a, b;
    batch_local(trial->rows, trial->x, trial->y);
    if (check->type->update || !trial->rows->view.elements) return;
    if (!guarded_create(&a, trial->rows)) return;
    if (guarded_create(&b, trial->rows)) {
        check_variables(check, &a, &b);
        check_begin(check, &a, &b);
        check_steady(check, &b);
        guarded_free(&b);
    }
    guarded_free(&a);
}
