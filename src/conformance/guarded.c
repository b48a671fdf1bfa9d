#include "guarded.h"

#include <string.h>

const char *const guarded_name[ARRAYS] = {"column", "coefficient", "u",      "p", "weight",
                                          "data",   "key",         "memory", "J"};

void guarded_range(const struct guarded *g, int array, int first, int last, size_t *begin,
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
                           t->memory_size,
                           t->tangent || t->tangent_rank1 ? sizeof(double) : 0};
    size_t from = (size_t)first, to = (size_t)last;
    if (array < WEIGHT) from = (size_t)v->element_row[first], to = (size_t)v->element_row[last];
    if (array == COLUMN || array == COEFFICIENT)
        from = (size_t)v->row_entry[from], to = (size_t)v->row_entry[to];
    if (array == TANGENT) from = g->from->block_start[first], to = g->from->block_start[last];
    *begin = from * unit[array], *end = to * unit[array];
}

void *guarded_array(const struct guarded *g, int array) { return g->array[array].memory + GUARD; }

void guarded_free(struct guarded *g) {
    for (int k = 0; k < ARRAYS; k++) {
        FREE_ARRAY(g->from->context, g->array[k].memory, g->array[k].bytes + 2 * GUARD);
        FREE_ARRAY(g->from->context, g->array[k].before, g->array[k].bytes + 2 * GUARD);
    }
}

bool guarded_create(struct guarded *g, const struct batch *b) {
    const pdyn_batch *v = &b->view;
    const void *from[ARRAYS] = {v->column, v->coefficient, v->u,      v->p, v->weight,
                                v->data,   v->key,         v->memory, NULL};
    *g = (struct guarded){.from = b, .view = b->view};
    for (int k = 0; k < ARRAYS; k++) {
        size_t begin, end;
        guarded_range(g, k, 0, b->view.elements, &begin, &end);
        g->array[k].bytes = end;
        g->array[k].memory = NEW_ARRAY(b->context, end + 2 * GUARD, unsigned char);
        g->array[k].before = NEW_ARRAY(b->context, end + 2 * GUARD, unsigned char);
        if (!g->array[k].memory || !g->array[k].before) return guarded_free(g), false;
        memset(g->array[k].memory, 0xA5, end + 2 * GUARD);
        if (end && from[k]) memcpy(guarded_array(g, k), from[k], end);
    }
    g->view.column = guarded_array(g, COLUMN), g->view.coefficient = guarded_array(g, COEFFICIENT);
    g->view.weight = guarded_array(g, WEIGHT), g->view.data = guarded_array(g, DATA);
    g->view.u = guarded_array(g, U), g->view.p = guarded_array(g, P);
    if (v->key) g->view.key = guarded_array(g, KEY);
    if (v->memory) g->view.memory = guarded_array(g, MEMORY);
    return true;
}

/* ---- one call -------------------------------------------------------------------------------- */

void guarded_run(const struct guarded *g, const struct call *call, int first, int last) {
    size_t begin, end;
    guarded_range(g, TANGENT, first, last, &begin, &end);
    unsigned char *J = (unsigned char *)guarded_array(g, TANGENT) + begin;
    if (call->tangent) call->tangent(g->from->params, &g->view, first, last, (double *)J);
    else call->plain(g->from->params, &g->view, first, last);
}

void guarded_fill(struct guarded *g, unsigned arrays, int first, int last, int byte) {
    for (int k = 0; k < ARRAYS; k++) {
        size_t begin, end;
        guarded_range(g, k, first, last, &begin, &end);
        if (arrays & 1u << k)
            memset((unsigned char *)guarded_array(g, k) + begin, byte, end - begin);
    }
}

/* Calls for the elements [first, last). A write to any other place is a fault, and is undone. */
static void guarded_call(struct check *check, struct guarded *g, const struct call *call, int first,
                         int last) {
    for (int k = 0; k < ARRAYS; k++)
        memcpy(g->array[k].before, g->array[k].memory, g->array[k].bytes + 2 * GUARD);
    guarded_run(g, call, first, last);
    for (int k = 0; k < ARRAYS; k++) {
        size_t begin, end, all = g->array[k].bytes + 2 * GUARD;
        const unsigned char *after = g->array[k].memory, *before = g->array[k].before;
        guarded_range(g, k, first, last, &begin, &end);
        if (!(call->writes & 1u << k)) begin = end = 0;
        if (memcmp(after, before, GUARD + begin) == 0 &&
            memcmp(after + GUARD + end, before + GUARD + end, all - GUARD - end) == 0)
            continue;
        fault(check, "%s writes %s%s", call->name, guarded_name[k],
              call->writes & 1u << k ? " outside of its elements" : ", which it may only read");
        memcpy(g->array[k].memory, before, all);
    }
}

bool guarded_same(const struct guarded *a, const struct guarded *b, int array) {
    return !memcmp(guarded_array(a, array), guarded_array(b, array), a->array[array].bytes);
}

void guarded_restore_u(struct guarded *g) {
    if (g->array[U].bytes) memcpy(guarded_array(g, U), g->from->view.u, g->array[U].bytes);
}

/* Calls for the elements [first, last), with an arbitrary u of all others. */
static void call_alone(struct check *check, struct guarded *g, const struct call *call, int first,
                       int last) {
    guarded_fill(g, 1u << U, 0, first, 0x41);
    guarded_fill(g, 1u << U, last, g->view.elements, 0x41);
    guarded_call(check, g, call, first, last);
    guarded_restore_u(g);
}

void guarded_compare(struct check *check, struct guarded *a, struct guarded *b,
                     const struct call *call, unsigned compared) {
    int n = a->view.elements, faults = check->faults;
    guarded_fill(a, call->writes & compared, 0, n, call->zeroed ? 0 : 0xFF);
    guarded_fill(b, call->writes & compared, 0, n, call->zeroed ? 0 : 0x11);
    guarded_call(check, a, call, 0, n);
    for (int k = RANGES - 1; k >= 0 && check->faults == faults; k--)
        call_alone(check, b, call, k * n / RANGES, (k + 1) * n / RANGES);
    for (int k = 0; k < ARRAYS && check->faults == faults; k++)
        if ((compared & 1u << k) && !guarded_same(a, b, k))
            fault(check,
                  "%s gives another %s for the same elements in another range or order, or does "
                  "not write all of it",
                  call->name, guarded_name[k]);
}
