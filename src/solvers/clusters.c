#include "clusters.h"

#include "../core/assemble.h"

#include <string.h>

/* Members: so few that what they do among themselves is left to 3 x 3 blocks; more where there
 * would be too many clusters for a factor of them. */
enum { MEMBERS = 16, MOST_CLUSTERS = 300 };

/* ---- graphs: who shares a row with whom ------------------------------------------------------ */

struct graph {
    pdyn_context *context;
    int nodes, links;
    int *start, *link; /* nodes + 1; links: neighbours of each node, ascending */
};

static void graph_free(struct graph *g) {
    if (!g->context) return;
    FREE_ARRAY(g->context, g->start, g->nodes + 1);
    FREE_ARRAY(g->context, g->link, g->links);
}

/* Of the particles, by the pattern of the static rows. */
static pdyn_status graph_of_pattern(struct graph *g, const struct matrix *m) {
    int n = m->particles;
    g->context = m->context, g->nodes = n, g->links = 2 * (m->block_start[n] - n);
    g->start = NEW_ARRAY(g->context, n + 1, int);
    g->link = NEW_ARRAY(g->context, g->links, int);
    if (!g->start || (g->links && !g->link)) return PDYN_NO_MEMORY;
    for (int j = 0; j < n; j++)
        for (int k = m->block_start[j] + 1; k < m->block_start[j + 1]; k++)
            g->start[j]++, g->start[m->block_row[k]]++;
    for (int i = 0, sum = 0; i <= n; i++) {
        int own = i < n ? g->start[i] : 0;
        g->start[i] = sum, sum += own;
    }
    for (int j = 0; j < n; j++)
        for (int k = m->block_start[j] + 1; k < m->block_start[j + 1]; k++) {
            int i = m->block_row[k];
            g->link[g->start[j]++] = i, g->link[g->start[i]++] = j;
        }
    memmove(g->start + 1, g->start, (size_t)n * sizeof *g->start);
    g->start[0] = 0;
    return PDYN_OK;
}

/* Marks what is linked to a node and marked below `below`, near before far, at most so many; queue:
 * in this order. Returns how many. */
static int walk(const struct graph *g, int from, int most, int below, int mark, int *marks,
                int *queue) {
    int found = 1;
    queue[0] = from, marks[from] = mark;
    for (int k = 0; k < found; k++)
        for (int l = g->start[queue[k]]; l < g->start[queue[k] + 1] && found < most; l++) {
            int to = g->link[l];
            if (marks[to] >= below) continue;
            marks[to] = mark;
            queue[found++] = to;
        }
    return found;
}

/* ---- clusters -------------------------------------------------------------------------------- */

/* The held ones (marks -1) of each connected piece, from one of its ends to the other. Returns how
 * many. */
static int put_in_order(const struct graph *g, int *marks, int *order) {
    int done = 0;
    for (int i = 0; i < g->nodes; i++) {
        if (marks[i] >= 0) continue;
        int found = walk(g, i, g->nodes, 0, 0, marks, order + done);
        walk(g, order[done + found - 1], g->nodes, 1, 1, marks, order + done);
        done += found;
    }
    return done;
}

/* In this order, so that clusters that are linked have near numbers. */
static void grow(struct clusters *s, const struct graph *g, const int *order, int held) {
    int members = held / MOST_CLUSTERS > MEMBERS ? held / MOST_CLUSTERS : MEMBERS, found = 0;
    for (int k = 0; k < held; k++) {
        if (s->of[order[k]] >= 0) continue;
        found += walk(g, order[k], members, 0, s->count, s->of, s->member + found);
        s->first[++s->count] = found;
    }
}

static pdyn_status gather(struct clusters *s, const struct graph *g) {
    struct system *sys = s->system;
    int n = sys->particles, *marks = NEW_ARRAY(sys->context, n, int),
        *order = NEW_ARRAY(sys->context, n, int);
    bool *held = NEW_ARRAY(sys->context, n, bool), good = marks && order && held;
    if (good) {
        for (int b = 0; b < sys->batches; b++)
            if (batch_is_static(sys->batch[b])) batch_mark_held(sys->batch[b], held);
        for (int i = 0; i < n; i++) marks[i] = held[i] ? -1 : 1, s->of[i] = -1;
        grow(s, g, order, put_in_order(g, marks, order));
    }
    FREE_ARRAY(sys->context, held, n);
    FREE_ARRAY(sys->context, marks, n);
    FREE_ARRAY(sys->context, order, n);
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

static pdyn_status find(struct clusters *s) {
    struct system *sys = s->system;
    struct batch **rows = NEW_ARRAY(sys->context, sys->batches, struct batch *);
    struct matrix pattern = {0};
    struct graph graph = {0};
    if (sys->batches && !rows) return PDYN_NO_MEMORY;
    for (int b = 0; b < sys->batches; b++)
        if (batch_is_static(sys->batch[b])) rows[b] = sys->batch[b];
    pdyn_status status = matrix_pattern(&pattern, sys, rows, 1);
    if (status == PDYN_OK) status = graph_of_pattern(&graph, &pattern);
    if (status == PDYN_OK) status = gather(s, &graph);
    FREE_ARRAY(sys->context, rows, sys->batches);
    matrix_free(&pattern);
    graph_free(&graph);
    return status;
}

pdyn_status clusters_create(struct clusters *s, struct system *system) {
    size_t n = (size_t)system->particles;
    s->system = system;
    s->of = NEW_ARRAY(system->context, n, int);
    s->member = NEW_ARRAY(system->context, n, int);
    s->first = NEW_ARRAY(system->context, n + 1, int);
    return !s->first || (n && (!s->of || !s->member)) ? PDYN_NO_MEMORY : find(s);
}

void clusters_free(struct clusters *s) {
    if (!s->system) return;
    pdyn_context *context = s->system->context;
    FREE_ARRAY(context, s->first, s->system->particles + 1);
    FREE_ARRAY(context, s->member, s->system->particles);
    FREE_ARRAY(context, s->of, s->system->particles);
}
