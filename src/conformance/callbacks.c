/* Checks of a constraint type's callbacks on arrays with guard bytes at both ends: a callback may
 * write only its own arrays, there only the entries of its elements, and must give the same result
 * for any range and order of elements. */
#include "conformance.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMN, COEFFICIENT, U, P, WEIGHT, DATA, KEY, MEMORY, ARRAYS, GUARD = 256 /* bytes */ };

static const char *const array_name[ARRAYS] = {"column", "coefficient", "u",   "p",
                                               "weight", "data",        "key", "memory"};

struct guarded { /* copy of a batch whose arrays have guard bytes */
    const struct batch *from;
    pdyn_batch view;
    struct {
        unsigned char *memory, *before; /* bytes + 2 GUARD each; before: content before a call */
        size_t bytes;
    } array[ARRAYS];
};

/* The byte range [*begin, *end) of an array that belongs to the elements [first, last). */
static void byte_range(const struct guarded *g, int array, int first, int last, size_t *begin,
                       size_t *end) {
    const pdyn_batch *v = &g->from->view;
    const pdyn_constraint_type *t = g->from->type;
    size_t unit[ARRAYS] = {sizeof(int),
                           sizeof(double),
                           3 * sizeof(double),
                           3 * sizeof(double),
                           sizeof(double),
                           t->data_size,
                           t->memory_size ? sizeof(uint64_t) : 0,
                           t->memory_size};
    int from = first, to = last;
    if (array < WEIGHT) from = v->element_row[first], to = v->element_row[last];
    if (array == COLUMN || array == COEFFICIENT) from = v->row_entry[from], to = v->row_entry[to];
    *begin = (size_t)from * unit[array], *end = (size_t)to * unit[array];
}

static void *inside(const struct guarded *g, int array) { return g->array[array].memory + GUARD; }

static void guarded_free(struct guarded *g) {
    for (int k = 0; k < ARRAYS; k++) {
        FREE_ARRAY(g->from->context, g->array[k].memory, g->array[k].bytes + 2 * GUARD);
        FREE_ARRAY(g->from->context, g->array[k].before, g->array[k].bytes + 2 * GUARD);
    }
}

/* Copies the arrays of a batch. false: no memory. */
static bool guarded_create(struct guarded *g, const struct batch *b) {
    const pdyn_batch *v = &b->view;
    const void *from[ARRAYS] = {v->column, v->coefficient, v->u,   v->p,
                                v->weight, v->data,        v->key, v->memory};
    *g = (struct guarded){.from = b, .view = b->view};
    for (int k = 0; k < ARRAYS; k++) {
        size_t begin, end;
        byte_range(g, k, 0, b->view.elements, &begin, &end);
        g->array[k].bytes = end;
        g->array[k].memory = NEW_ARRAY(b->context, end + 2 * GUARD, unsigned char);
        g->array[k].before = NEW_ARRAY(b->context, end + 2 * GUARD, unsigned char);
        if (!g->array[k].memory || !g->array[k].before) return guarded_free(g), false;
        memset(g->array[k].memory, 0xA5, end + 2 * GUARD);
        if (end) memcpy(inside(g, k), from[k], end);
    }
    g->view.column = inside(g, COLUMN), g->view.coefficient = inside(g, COEFFICIENT);
    g->view.weight = inside(g, WEIGHT), g->view.data = inside(g, DATA);
    g->view.u = inside(g, U), g->view.p = inside(g, P);
    g->view.key = inside(g, KEY), g->view.memory = inside(g, MEMORY);
    return true;
}

/* ---- one call -------------------------------------------------------------------------------- */

typedef void callback(const void *params, const pdyn_batch *batch, int first, int last);

struct call {
    const char *name;
    callback *run;
    unsigned writes; /* bit k: it may write array k */
};

/* Fills the arrays in the bit set `writes`, at the elements [first, last), with one byte. */
static void fill(struct guarded *g, unsigned writes, int first, int last, int byte) {
    for (int k = 0; k < ARRAYS; k++) {
        size_t begin, end;
        byte_range(g, k, first, last, &begin, &end);
        if (writes & 1u << k) memset((unsigned char *)inside(g, k) + begin, byte, end - begin);
    }
}

/* Calls for the elements [first, last). A write to any other place is a fault, and is undone. */
static void call_guarded(struct check *check, struct guarded *g, const struct call *call, int first,
                         int last) {
    for (int k = 0; k < ARRAYS; k++)
        memcpy(g->array[k].before, g->array[k].memory, g->array[k].bytes + 2 * GUARD);
    call->run(g->from->params, &g->view, first, last);
    for (int k = 0; k < ARRAYS; k++) {
        size_t begin, end, all = g->array[k].bytes + 2 * GUARD;
        const unsigned char *after = g->array[k].memory, *before = g->array[k].before;
        byte_range(g, k, first, last, &begin, &end);
        if (!(call->writes & 1u << k)) begin = end = 0;
        if (memcmp(after, before, GUARD + begin) == 0 &&
            memcmp(after + GUARD + end, before + GUARD + end, all - GUARD - end) == 0)
            continue;
        fault(check, "%s writes %s %s", call->name, array_name[k],
              call->writes & 1u << k ? "outside of its elements" : "which is not its to write");
        memcpy(g->array[k].memory, before, all);
    }
}

static bool same(const struct guarded *a, const struct guarded *b, int array) {
    return !memcmp(inside(a, array), inside(b, array), a->array[array].bytes);
}

/* Calls once for all elements, and for thirds of them in descending order on other initial content.
 * The arrays in the bit set `compared` must be equal afterwards. */
static void check_call(struct check *check, struct guarded *a, struct guarded *b,
                       const struct call *call, unsigned compared) {
    int n = a->view.elements, faults = check->faults;
    fill(a, call->writes & compared, 0, n, 0xFF), fill(b, call->writes & compared, 0, n, 0x11);
    call_guarded(check, a, call, 0, n);
    for (int k = 2; k >= 0 && check->faults == faults; k--)
        call_guarded(check, b, call, k * n / 3, (k + 1) * n / 3);
    for (int k = 0; k < ARRAYS && check->faults == faults; k++)
        if ((compared & 1u << k) && !same(a, b, k))
            fault(check,
                  "%s gives another %s for the same elements in another range or order, or does "
                  "not write all of it",
                  call->name, array_name[k]);
}

/* ---- all calls ------------------------------------------------------------------------------- */

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

/* True if the array holds the guard byte from element `first` on. */
static bool is_filled(const struct guarded *g, int array, int first) {
    size_t begin, end;
    byte_range(g, array, first, g->view.elements, &begin, &end);
    const unsigned char *bytes = inside(g, array);
    for (; begin < end + GUARD; begin++)
        if (bytes[begin] != 0xA5) return false;
    return true;
}

/* Calls update with room for half of the elements that core found, and for all of them. */
static void call_update(struct check *check, struct guarded *g, const struct trial *trial) {
    const struct batch *b = g->from;
    bool always = b->type->flags & PDYN_EVERY_ITERATION;
    int n = b->view.elements, room[] = {n / 2, n};
    for (int k = 0; k < 2; k++) {
        fill(g, 1u << DATA | 1u << KEY, 0, n, 0xA5);
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
    for (int r = 0; r < b->rows && check->faults == faults; r++)
        if (selects_twice(&b->view, r)) fault(check, "row %d selects one particle twice", r);
}

/* Checks project, weight and select. data is not compared after select: begin has changed it. */
static void check_all(struct check *check, struct guarded *a, struct guarded *b) {
    const pdyn_constraint_type *t = a->from->type;
    unsigned rows = 1u << COLUMN | 1u << COEFFICIENT;
    const struct call select = {"select", t->select, rows | 1u << DATA},
                      weight = {"weight", t->weight, 1u << WEIGHT},
                      project = {"project", t->project, 1u << P};
    size_t points = 3 * (size_t)a->from->rows;
    check_call(check, a, b, &project, 1u << P);
    if (!all_finite(a->view.p, points)) fault(check, "project gives a p that is not finite");
    check_call(check, a, b, &weight, 1u << WEIGHT);
    for (int e = 0; e < a->view.elements; e++)
        if (!(a->view.weight[e] >= 0.0 && isfinite(a->view.weight[e]))) {
            fault(check, "weight gives %g, expected a finite number of at least 0",
                  a->view.weight[e]);
            break;
        }
    check_call(check, a, b, &select, rows);
    if (!a->from->entries) return;
    if (memcmp(a->view.column, a->from->view.column, a->array[COLUMN].bytes) ||
        memcmp(a->view.coefficient, a->from->view.coefficient, a->array[COEFFICIENT].bytes))
        fault(check, "select gives other rows when it is called again");
}

/* Checks damping_rest, begin and end. */
static void check_others(struct check *check, struct guarded *a, struct guarded *b) {
    const pdyn_constraint_type *t = a->from->type;
    const struct call damping_rest = {"damping_rest", t->damping_rest, 1u << DATA},
                      begin = {"begin", t->begin, 1u << DATA | 1u << WEIGHT},
                      end = {"end", t->end, 1u << MEMORY};
    if (t->damping_rest) check_call(check, a, b, &damping_rest, 0);
    if (t->begin) check_call(check, a, b, &begin, 0);
    if (t->end) check_call(check, a, b, &end, 1u << MEMORY);
}

void check_callbacks(struct check *check, struct trial *trial) {
    struct guarded a, b;
    if (!trial->rows->view.elements) fault(check, "no element on a body of this kind");
    batch_local(trial->rows, trial->x, 0.0, trial->y);
    check_shape(check, trial->rows);
    if (!guarded_create(&a, trial->rows)) return;
    if (guarded_create(&b, trial->rows)) {
        check_all(check, &a, &b);
        check_others(check, &a, &b);
        check_update(check, &a, trial);
        guarded_free(&b);
    }
    guarded_free(&a);
}
