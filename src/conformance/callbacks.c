/* Checks of a constraint type's callbacks, one by one: a callback may write only its own arrays,
 * there only the entries of its elements, and must give the same result for any range and order of
 * elements. */
#include "base/param_kind.h"
#include "guarded.h"

#include <math.h>
#include <string.h>

static bool all_finite(const double *a, size_t n) {
    for (size_t k = 0; k < n; k++)
        if (!isfinite(a[k])) return false;
    return true;
}

/* elements and row_sizes must give the same numbers in each call. */
static void check_shape(struct check *check, const struct batch *b) {
    const pdyn_constraint_type *t = b->type;
    for (int k = 0; k < 2 && !t->update; k++)
        if (t->elements(b->params, b->view.body) != b->view.elements) {
            fault(check, "elements gives another number when it is called again");
            return;
        }
    for (int e = 0; e < b->view.elements && t->row_sizes; e++) {
        int rows = 0, width = 0, first = b->view.element_row[e];
        t->row_sizes(b->params, &b->view, e, &rows, &width);
        if (rows != b->view.element_row[e + 1] - first ||
            (rows && width != b->view.row_entry[first + 1] - b->view.row_entry[first])) {
            fault(check, "row_sizes gives other rows for element %d when it is called again", e);
            return;
        }
    }
}

/* True if two entries of row r with coefficients other than 0 select the same particle. */
static bool selects_twice(const pdyn_batch *v, int r) {
    for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
        for (int m = v->row_entry[r]; m < k; m++)
            if (v->column[k] == v->column[m] && v->coefficient[k] != 0.0 &&
                v->coefficient[m] != 0.0)
                return true;
    return false;
}

static bool has_equal_keys(const struct batch *b) {
    for (int e = 0; e < b->view.elements && b->type->memory_size; e++)
        for (int other = 0; other < e; other++)
            if (b->view.key[e] == b->view.key[other]) return true;
    return false;
}

/* True if the array holds the guard byte from element `first` on. */
static bool is_filled(const struct guarded *g, int array, int first) {
    size_t begin, end;
    guarded_range(g, array, first, g->view.elements, &begin, &end);
    const unsigned char *bytes = guarded_array(g, array);
    for (; begin < end + GUARD; begin++)
        if (bytes[begin] != 0xA5) return false;
    return true;
}

/* Calls update with room for half of the elements that core found, and for all of them, with
 * neighbour lists that are complete where it is called. */
static void call_update(struct check *check, struct guarded *g, const struct trial *trial) {
    const struct batch *b = g->from;
    bool always = b->type->flags & PDYN_EVERY_ITERATION;
    int n = b->view.elements, room[] = {n / 2, n};
    const double *all;
    if (objective_ensure_lists(&trial->sim->objective, always ? trial->x : trial->sim->x, &all))
        fault(check, "no memory for neighbour lists");
    for (int k = 0; k < 2; k++) {
        guarded_fill(g, 1u << DATA | 1u << KEY, 0, n, 0xA5);
        int count = b->type->update(b->params, &g->view, always ? trial->x : trial->sim->x,
                                    always ? NULL : trial->sim->v, room[k]);
        if (count != n)
            fault(check, "update gives %d elements, then %d at the same positions", n, count);
        if (!is_filled(g, DATA, room[k]) || !is_filled(g, KEY, room[k]))
            fault(check, "update writes beyond the %d elements that there is room for", room[k]);
    }
}

/* Checks that update gives the number and the rows that core found, and writes only within the
 * room; no row selects a particle twice. */
static void check_update(struct check *check, struct guarded *g, const struct trial *trial) {
    const struct batch *b = g->from;
    int faults = check->faults;
    if (!b->type->update) return;
    call_update(check, g, trial);
    if (check->faults != faults) return;
    b->type->select(b->params, &g->view, 0, b->view.elements);
    if (b->entries && memcmp(g->view.column, b->view.column, g->array[COLUMN].bytes))
        fault(check, "update gives other elements at the same positions");
    if (b->view.key && memcmp(guarded_array(g, KEY), b->view.key, g->array[KEY].bytes))
        fault(check,
              "update gives other keys at the same positions, or does not write all of them");
    if (has_equal_keys(b)) fault(check, "update gives two elements the same key");
    for (int r = 0; r < b->rows && check->faults == faults; r++)
        if (selects_twice(&b->view, r)) fault(check, "row %d selects one particle twice", r);
}

static struct call tangent_call(const pdyn_constraint_type *t) {
    return (struct call){.name = t->tangent ? "tangent" : "tangent_rank1",
                         .tangent = t->tangent ? t->tangent : t->tangent_rank1,
                         .writes = 1u << TANGENT,
                         .zeroed = t->tangent != NULL};
}

static void check_finite(struct check *check, const struct guarded *g, const struct call *call,
                         const char *where) {
    int array = call->tangent ? TANGENT : P;
    if (!all_finite(guarded_array(g, array), g->array[array].bytes / sizeof(double)))
        fault(check, "%s gives a %s that is not finite%s", call->name, guarded_name[array], where);
}

/* Whether core expects no energy from the type (module.h, `energy`). */
static bool gives_nothing(const pdyn_constraint_type *t) {
    return !type_gives_energy(t) && !t->matrix_free && !type_has_kind(t, PDYN_PATH);
}

/* A p that depends on time gives energy: without `begin`, core refuses steps that have it. b has
 * the p of the trial. */
static void check_time(struct check *check, struct guarded *a, const struct guarded *b) {
    static const double times[] = {0.1, 1.0, 10.0, 1000.0};
    const struct call project = call_of("project", check->type->project, 1u << P);
    const pdyn_batch view = a->view;
    bool depends = false;
    for (int k = 0; k < 4 && !depends && gives_nothing(check->type); k++) {
        a->view.time = times[k];
        guarded_run(a, &project, 0, a->view.elements);
        depends = !guarded_same(a, b, P);
    }
    a->view = view;
    guarded_run(a, &project, 0, a->view.elements);
    if (depends)
        fault(check, "project depends on `time`, but without `begin` core expects that the "
                     "constraint gives no energy, and refuses steps: add one, even an empty one");
}

/* Checks project and tangent, first at the u of the trial, then at other times and where u = 0. */
static void check_maps(struct check *check, struct guarded *a, struct guarded *b) {
    const pdyn_constraint_type *t = check->type;
    const struct call map[] = {call_of("project", t->project, 1u << P), tangent_call(t)};
    int faults = check->faults, maps = map[1].tangent ? 2 : 1, n = a->view.elements;
    for (int k = 0; k < maps && check->faults == faults; k++) {
        guarded_compare(check, a, b, &map[k], map[k].writes);
        if (check->faults == faults) check_finite(check, a, &map[k], "");
    }
    if (check->faults != faults) return;
    check_time(check, a, b);
    guarded_fill(a, 1u << U | 1u << TANGENT, 0, n, 0);
    for (int k = 0; k < maps; k++) {
        guarded_run(a, &map[k], 0, n);
        check_finite(check, a, &map[k], " where u = 0");
    }
    guarded_restore_u(a);
    guarded_run(a, &map[0], 0, n);
}

/* The energy of all elements is the sum of those of RANGES of them, and at least 0 where core
 * expects no energy from the type. */
static void check_energy(struct check *check, const struct batch *b) {
    double sum = 0.0;
    int n = b->view.elements;
    if (!b->type->energy) return;
    double all = b->type->energy(b->params, &b->view, 0, n);
    if (all < 0.0 && gives_nothing(b->type))
        fault(check, "energy is %.6g J, expected at least 0: add a constant to each element", all);
    for (int k = 0; k < RANGES; k++)
        sum += b->type->energy(b->params, &b->view, k * n / RANGES, (k + 1) * n / RANGES);
    if (!(fabs(sum - all) <= 1e-9 * fabs(all)))
        fault(check, "energy of all elements is %.6g J, but %.6g J as the sum of %d ranges", all,
              sum, RANGES);
}

/* Whether weight gives another weight in the view of `a` than in that of b. */
static bool weighs_otherwise(struct guarded *a, const struct guarded *b,
                             const struct call *weight) {
    guarded_run(a, weight, 0, a->view.elements);
    return memcmp(a->view.weight, b->view.weight, a->array[WEIGHT].bytes) != 0;
}

/* Weights that are not computed in every step may not depend on what changes from step to step. b
 * has the weights at the state of the trial. */
static void check_lasting_weight(struct check *check, struct guarded *a, const struct guarded *b,
                                 const struct call *weight) {
    static const double times[] = {0.1, 1.0, 10.0, 1000.0};
    const pdyn_constraint_type *t = a->from->type;
    const struct call end = call_of("end", t->end, 1u << MEMORY);
    const pdyn_batch view = a->view;
    const char *changes = NULL;
    if (type_weighs_in_steps(t) || t->update) return;
    for (int k = 0; k < 4 && !changes; k++) {
        a->view.time = times[k];
        if (weighs_otherwise(a, b, weight)) changes = "`time`";
    }
    a->view = view, a->view.h *= 2.0, a->view.length *= 2.0;
    if (!changes && weighs_otherwise(a, b, weight)) changes = "the length of the step";
    a->view = view;
    if (t->end) {
        guarded_run(a, &end, 0, a->view.elements);
        if (!changes && weighs_otherwise(a, b, weight)) changes = "`memory`";
        memcpy(guarded_array(a, MEMORY), a->from->view.memory, a->array[MEMORY].bytes);
    }
    weighs_otherwise(a, b, weight);
    if (changes)
        fault(check, "weight depends on %s, but %s", changes,
              t->begin ? "with PDYN_STEADY it is not called in every step: do not set this flag"
                       : "without `begin` it is not called in every step: add one, even an empty "
                         "one");
}

static void check_weight(struct check *check, struct guarded *a, struct guarded *b) {
    const struct call weight = call_of("weight", a->from->type->weight, 1u << WEIGHT);
    int faults = check->faults;
    guarded_compare(check, a, b, &weight, 1u << WEIGHT);
    if (check->faults == faults) check_lasting_weight(check, a, b, &weight);
    if (check->faults == faults &&
        memcmp(a->view.weight, a->from->view.weight, a->array[WEIGHT].bytes))
        fault(check, "weight gives another weight at other positions");
    for (int e = 0; e < a->view.elements; e++)
        if (!(a->view.weight[e] >= 0.0 && isfinite(a->view.weight[e]))) {
            fault(check, "weight gives %g, expected a finite number of at least 0",
                  a->view.weight[e]);
            break;
        }
}

/* data is not compared: begin has changed it. */
static void check_select(struct check *check, struct guarded *a, struct guarded *b) {
    unsigned rows = 1u << COLUMN | 1u << COEFFICIENT;
    const struct call select = call_of("select", a->from->type->select, rows | 1u << DATA);
    guarded_compare(check, a, b, &select, rows);
    if (!a->from->entries) return;
    if (memcmp(a->view.column, a->from->view.column, a->array[COLUMN].bytes) ||
        memcmp(a->view.coefficient, a->from->view.coefficient, a->array[COEFFICIENT].bytes))
        fault(check, "select gives other rows when it is called again");
}

/* Checks damping_rest, begin and end. */
static void check_others(struct check *check, struct guarded *a, struct guarded *b) {
    const pdyn_constraint_type *t = a->from->type;
    const struct call damping_rest = call_of("damping_rest", t->damping_rest, 1u << DATA),
                      begin = call_of("begin", t->begin,
                                      1u << DATA | (unsigned)type_weighs_in_steps(t) << WEIGHT);
    struct call end = call_of("end", t->end, 1u << MEMORY);
    end.zeroed = true; /* it may read the memory, too */
    if (t->damping_rest) guarded_compare(check, a, b, &damping_rest, 0);
    if (t->begin) guarded_compare(check, a, b, &begin, 0);
    if (t->end) guarded_compare(check, a, b, &end, 1u << MEMORY);
}

static void report_no_element(struct check *check) {
    static const char *const text[BODY_KINDS] = {
        [SURFACE] =
            "a surface, which has triangles and edges but no tetrahedra: say PDYN_ON_VOLUME "
            "or PDYN_ON_PARTICLES, whichever it needs",
        [PARTICLES] = "a body of particles, which has no triangles, edges and tetrahedra: say "
                      "PDYN_ON_SURFACE or PDYN_ON_VOLUME, whichever it needs",
        [VOLUME] = "a soft solid, which has triangles, edges and tetrahedra: say PDYN_ON_PARTICLES "
                   "if it needs particles"};
    fault(check, "`elements` is 0 on %s", text[check->kind]);
}

void check_callbacks(struct check *check, struct trial *trial) {
    struct guarded a, b;
    batch_local(trial->rows, trial->x, trial->y);
    if (!trial->rows->view.elements) {
        if (!check->type->update) report_no_element(check);
        return;
    }
    check_shape(check, trial->rows);
    if (!guarded_create(&a, trial->rows)) return;
    if (guarded_create(&b, trial->rows)) {
        check_energy(check, trial->rows);
        check_maps(check, &a, &b);
        check_weight(check, &a, &b);
        check_select(check, &a, &b);
        check_others(check, &a, &b);
        check_update(check, &a, trial);
        guarded_free(&b);
    }
    guarded_free(&a);
}
