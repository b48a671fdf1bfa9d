/* Setting up single.h: which particles are neighbours, and what ties them. */
#include "single.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* ---- what goes which way --------------------------------------------------------------------- */

/* All of its rows are differences of two particles, their blocks m m' + a I. */
static bool is_links(const struct batch *b) {
    if (b->type->tangent || !b->single || b->width != 2) return false;
    for (int k = 0; k < b->entries; k += 2)
        if (fabs(b->view.coefficient[k]) != 1.0 ||
            b->view.coefficient[k + 1] != -b->view.coefficient[k])
            return false;
    return true;
}

/* All of its rows are one particle's, their blocks w I. */
static bool is_weights(const struct batch *b) {
    return !b->type->tangent && !b->type->tangent_rank1 && b->single && b->width == 1;
}

/* Beside what is left out, rows stay where they are: they would go through doubles and floats. */
static enum single_way way_of(const struct batch *b, bool changing) {
    if (!batch_is_static(b)) return LEFT_OUT;
    if (b->linear) return NUMBERS;
    if (is_links(b)) return LINKS;
    if (is_weights(b)) return WEIGHTS;
    return changing ? LEFT_OUT : ROWS;
}

static bool choose_ways(struct single *s) {
    struct objective *sys = s->objective;
    bool all = true;
    s->way = NEW_ARRAY(sys->context, sys->batches, enum single_way);
    if (sys->batches && !s->way) return false;
    for (int b = 0; b < sys->batches; b++) {
        s->way[b] = way_of(sys->batch[b], sys->dynamic_rows);
        all &= s->way[b] != LEFT_OUT;
    }
    s->patches = (sys->particles + PATCH - 1) / PATCH;
    if (all) return true;
    s->wide_u = sys->samples ? sys->samples->input : NEW_VECTOR(sys->context, sys->particles);
    s->wide_y = sys->samples ? sys->samples->output : NEW_VECTOR(sys->context, sys->particles);
    return s->wide_u && s->wide_y;
}

/* ---- patches and their numbers --------------------------------------------------------------- */

/* A walk over the numbers of particle i, K_ij of j != i in all linear batches. */
struct walk {
    const struct single *s;
    int i, batch, at, end;
    const struct linear_rows *k;
};

static struct walk walk_begin(const struct single *s, int i) {
    return (struct walk){.s = s, .i = i, .batch = -1};
}

static bool walk_next(struct walk *w) {
    while (++w->at >= w->end) {
        if (++w->batch >= w->s->objective->batches) return false;
        w->k = w->s->objective->batch[w->batch]->linear;
        w->at = w->end = 0;
        if (!w->k || w->i < w->k->first || w->i >= w->k->first + w->k->count) continue;
        w->at = w->k->start[w->i - w->k->first] - 1, w->end = w->k->start[w->i - w->k->first + 1];
    }
    return true;
}

struct builder {
    struct single *s;
    int *patch; /* particles: whose member each is, or -1 */
    int *seen;  /* particles: the last patch that met it, and */
    int *place; /* where */
    int next;   /* particles before this one are members */
};

/* How many neighbours of particle j patch k has not met. */
static int new_neighbours(const struct builder *b, int k, int j) {
    int count = 0;
    for (struct walk w = walk_begin(b->s, j); walk_next(&w);)
        count += b->seen[w.k->column[w.at]] != k;
    return count;
}

/* The particle to join the members so far: the neighbour with most in common, or any. */
static int choose_member(struct builder *b, int k, int members) {
    int best = -1, fewest = INT_MAX;
    for (int m = 0; m < members; m++)
        for (struct walk w = walk_begin(b->s, b->s->member[PATCH * k + m]); walk_next(&w);) {
            int j = w.k->column[w.at];
            int more = b->patch[j] < 0 ? new_neighbours(b, k, j) : INT_MAX;
            if (more < fewest) best = j, fewest = more;
        }
    if (best >= 0) return best;
    while (b->next < b->s->objective->particles && b->patch[b->next] >= 0) b->next++;
    return b->next;
}

static void choose_patches(struct builder *b) {
    struct single *s = b->s;
    int n = s->objective->particles;
    for (int i = 0; i < n; i++) b->patch[i] = b->seen[i] = -1;
    for (int k = 0; k < s->patches; k++)
        for (int m = 0; m < PATCH; m++) {
            int i = s->member[PATCH * k + m] = choose_member(b, k, m);
            if (i == n) continue;
            b->patch[i] = k, b->seen[i] = k;
            for (struct walk w = walk_begin(s, i); walk_next(&w);) b->seen[w.k->column[w.at]] = k;
        }
}

/* Where the number of particle j is in patch k; a new one if it has not met it yet. */
static int find_place(struct builder *b, int k, int j, int *end) {
    if (b->seen[j] != k) b->seen[j] = k, b->place[j] = (*end)++;
    return b->place[j];
}

/* How many particles the members of patch k are tied to. */
static int count_patch(struct builder *b, int k) {
    int count = 0;
    for (int m = 0; m < PATCH; m++) {
        int i = b->s->member[PATCH * k + m];
        struct walk w = walk_begin(b->s, i);
        if (!walk_next(&w)) continue;
        find_place(b, k, i, &count);
        do find_place(b, k, w.k->column[w.at], &count);
        while (walk_next(&w));
    }
    return count;
}

/* The number for particle j and member m. */
static float *number_at(struct builder *b, int k, int j, int m, int *count) {
    int place = find_place(b, k, j, count);
    struct numbers *n = b->s->numbers + b->s->number_start[k] + place / 4;
    n->column[place % 4] = 4 * j;
    return n->number + 4 * (place % 4) + m;
}

static void fill_patch(struct builder *b, int k) {
    struct single *s = b->s;
    int count = 0;
    for (int t = s->number_start[k]; t < s->number_start[k + 1]; t++)
        for (int c = 0; c < 4; c++) s->numbers[t].column[c] = 4 * s->member[PATCH * k];
    for (int m = 0; m < PATCH; m++) {
        int i = s->member[PATCH * k + m];
        struct walk w = walk_begin(s, i);
        double sum = 0.0;
        if (!walk_next(&w)) continue;
        float *own = number_at(b, k, i, m, &count);
        do {
            float number = (float)w.k->value[w.at];
            *number_at(b, k, w.k->column[w.at], m, &count) += number;
            sum += (double)number;
        } while (walk_next(&w));
        *own = (float)-sum;
    }
}

static bool take_numbers(struct builder *b) {
    struct single *s = b->s;
    int n = s->objective->particles;
    choose_patches(b);
    for (int i = 0; i < n; i++) b->seen[i] = -1;
    for (int k = 0; k < s->patches; k++)
        s->number_start[k + 1] = s->number_start[k] + (count_patch(b, k) + 3) / 4;
    int count = s->number_start[s->patches];
    s->numbers = NEW_ARRAY(s->objective->context, count, struct numbers);
    if (count && !s->numbers) return false;
    for (int i = 0; i < n; i++) b->seen[i] = -1;
    for (int k = 0; k < s->patches; k++) fill_patch(b, k);
    for (int k = 0; k < s->objective->batches; k++) {
        const struct linear_rows *from = s->objective->batch[k]->linear;
        for (int i = 0; from && i < from->count; i++) s->own[from->first + i] += from->own[i];
    }
    return true;
}

static bool create_numbers(struct single *s) {
    pdyn_context *c = s->objective->context;
    size_t n = (size_t)s->objective->particles;
    struct builder b = {.s = s,
                        .patch = NEW_ARRAY(c, n, int),
                        .seen = NEW_ARRAY(c, n, int),
                        .place = NEW_ARRAY(c, n, int)};
    bool good = !n || (b.patch && b.seen && b.place && take_numbers(&b));
    FREE_ARRAY(c, b.patch, n);
    FREE_ARRAY(c, b.seen, n);
    FREE_ARRAY(c, b.place, n);
    return good;
}

/* ---- links ----------------------------------------------------------------------------------- */

/* A walk over the links of member m of patch k; puts them down if there is where. */
static int links_of(const struct single *s, int k, int m, struct links *links,
                    struct origin *origin) {
    int count = 0, i = s->member[PATCH * k + m];
    for (int n = 0; n < s->objective->batches; n++) {
        const struct batch *b = s->objective->batch[n];
        int at = i - b->touch_first;
        if (s->way[n] != LINKS || at < 0 || at >= b->touch_count) continue;
        for (int t = b->touch_start[at]; t < b->touch_start[at + 1]; t++, count++)
            if (links) {
                links[count].to[m] = 4 * b->view.column[b->touch[t].entry ^ 1];
                origin[PATCH * count + m] = (struct origin){n, b->touch[t].row};
            }
    }
    return count;
}

static void count_links(struct single *s) {
    for (int k = 0; k < s->patches; k++) {
        int most = 0;
        for (int m = 0; m < PATCH; m++) {
            int count = links_of(s, k, m, NULL, NULL);
            if (count > most) most = count;
        }
        s->link_start[k + 1] = s->link_start[k] + most;
    }
}

static bool create_links(struct single *s) {
    pdyn_context *c = s->objective->context;
    count_links(s);
    size_t count = (size_t)s->link_start[s->patches];
    if (!count) return true;
    s->links = NEW_ARRAY(c, count, struct links);
    s->origin = NEW_ARRAY(c, PATCH * count, struct origin);
    if (!s->links || !s->origin) return false;
    for (int k = 0; k < s->patches; k++)
        for (int m = 0; m < PATCH; m++) {
            int start = s->link_start[k];
            for (int t = start; t < s->link_start[k + 1]; t++) {
                s->links[t].to[m] = 4 * s->member[PATCH * k + m];
                s->origin[PATCH * t + m].row = -1;
            }
            links_of(s, k, m, s->links + start, s->origin + PATCH * (size_t)start);
        }
    return true;
}

/* ---- rows ------------------------------------------------------------------------------------ */

static void take_rows(struct single *s, int batch, int *next) {
    const struct batch *b = s->objective->batch[batch];
    const pdyn_batch *v = &b->view;
    int row = s->batch_row[batch], before = s->row_start[row];
    for (int r = 0; r < b->rows; r++) s->row_start[row + r + 1] = before + v->row_entry[r + 1];
    for (int k = 0; k < b->entries; k++) {
        float coefficient = (float)v->coefficient[k];
        s->entry[before + k] = (struct selected){coefficient, v->column[k]};
        s->touch[next[v->column[k]]++] = (struct selected){coefficient, row + b->entry_row[k]};
    }
}

/* Counts of particle i go to start[i + 1]; summed up, they are where its part begins. */
static void sum_up(int *start, int count) {
    for (int i = 0; i < count; i++) start[i + 1] += start[i];
}

static void count_rows(struct single *s) {
    for (int b = 0; b < s->objective->batches; b++) {
        const struct batch *batch = s->objective->batch[b];
        bool rows = s->way[b] == ROWS;
        for (int k = 0; rows && k < batch->entries; k++)
            s->touch_start[batch->view.column[k] + 1]++;
        s->batch_row[b + 1] = s->batch_row[b] + (rows ? batch->rows : 0);
        s->entries += rows ? batch->entries : 0;
    }
    sum_up(s->touch_start, s->objective->particles + 1);
    s->rows = s->batch_row[s->objective->batches];
}

static bool allocate(struct single *s) {
    pdyn_context *c = s->objective->context;
    size_t n = (size_t)s->objective->particles, batches = (size_t)s->objective->batches;
    s->member = NEW_ARRAY(c, PATCH * (size_t)s->patches, int);
    s->number_start = NEW_ARRAY(c, s->patches + 1, int);
    s->link_start = NEW_ARRAY(c, s->patches + 1, int);
    s->touch_start = NEW_ARRAY(c, n + 2, int);
    s->batch_row = NEW_ARRAY(c, batches + 1, int);
    s->block = NEW_ARRAY(c, batches, float *);
    s->own = NEW_ARRAY(c, n, double);
    s->diagonal = NEW_ARRAY(c, 6 * n, double);
    s->self = NEW_ARRAY(c, n + 1, float);
    s->partial = NEW_ARRAY(c, pool_blocks(s->patches, SINGLE_GRAIN), double);
    return s->number_start && s->link_start && s->touch_start && s->batch_row &&
           (!batches || s->block) && s->self && (!n || (s->own && s->diagonal)) &&
           (!s->patches || (s->member && s->partial));
}

static bool allocate_rows(struct single *s) {
    pdyn_context *c = s->objective->context;
    s->row_start = NEW_ARRAY(c, s->rows + 1, int);
    s->entry = NEW_ARRAY(c, s->entries, struct selected);
    s->touch = NEW_ARRAY(c, s->entries, struct selected);
    s->flux = NEW_ARRAY(c, 4 * (size_t)s->rows, float);
    return s->row_start && (!s->entries || (s->entry && s->touch)) && (!s->rows || s->flux);
}

static bool create_rows(struct single *s) {
    pdyn_context *c = s->objective->context;
    int n = s->objective->particles;
    count_rows(s);
    if (!allocate_rows(s)) return false;
    int *next = NEW_ARRAY(c, n + 1, int);
    if (!next) return false;
    memcpy(next, s->touch_start, ((size_t)n + 1) * sizeof *next);
    bool good = true;
    for (int b = 0; good && b < s->objective->batches; b++) {
        const struct batch *batch = s->objective->batch[b];
        if (s->way[b] != ROWS) continue;
        s->block[b] = NEW_ARRAY(c, batch_block_numbers(batch), float);
        good = s->block[b];
        take_rows(s, b, next);
    }
    FREE_ARRAY(c, next, n + 1);
    return good;
}

pdyn_status single_create(struct single *s, struct objective *objective) {
    s->objective = objective;
    bool good =
        choose_ways(s) && allocate(s) && create_numbers(s) && create_rows(s) && create_links(s);
    return good ? PDYN_OK : PDYN_NO_MEMORY;
}

void single_free(struct single *s) {
    if (!s->objective) return;
    pdyn_context *c = s->objective->context;
    size_t n = (size_t)s->objective->particles;
    size_t links = s->link_start ? (size_t)s->link_start[s->patches] : 0;
    for (int b = 0; s->block && b < s->objective->batches; b++)
        if (s->block[b]) FREE_ARRAY(c, s->block[b], batch_block_numbers(s->objective->batch[b]));
    FREE_ARRAY(c, s->block, s->objective->batches);
    FREE_ARRAY(c, s->way, s->objective->batches);
    if (!s->objective->samples) {
        FREE_VECTOR(c, s->wide_u, n);
        FREE_VECTOR(c, s->wide_y, n);
    }
    FREE_ARRAY(c, s->member, PATCH * (size_t)s->patches);
    FREE_ARRAY(c, s->numbers, s->number_start ? s->number_start[s->patches] : 0);
    FREE_ARRAY(c, s->number_start, s->patches + 1);
    FREE_ARRAY(c, s->links, links);
    FREE_ARRAY(c, s->origin, PATCH * links);
    FREE_ARRAY(c, s->link_start, s->patches + 1);
    FREE_ARRAY(c, s->own, n);
    FREE_ARRAY(c, s->diagonal, 6 * n);
    FREE_ARRAY(c, s->self, n + 1);
    FREE_ARRAY(c, s->row_start, s->rows + 1);
    FREE_ARRAY(c, s->entry, s->entries);
    FREE_ARRAY(c, s->touch_start, n + 2);
    FREE_ARRAY(c, s->touch, s->entries);
    FREE_ARRAY(c, s->batch_row, s->objective->batches + 1);
    FREE_ARRAY(c, s->flux, 4 * (size_t)s->rows);
    FREE_ARRAY(c, s->partial, pool_blocks(s->patches, SINGLE_GRAIN));
}
