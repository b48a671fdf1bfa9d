#include "contact.h"

#include "base/clock.h"
#include "scene/poses.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- the contacts at x ------------------------------------------------------------------------
 */

/* The points at x; solids are where they are. */
static void gather(const struct contact *c, const double *x, double *at) {
    for (int i = 0; i < c->free; i++) memcpy(at + 3 * i, x + 3 * c->column[i], 3 * sizeof *at);
    if (at == c->at) return;
    size_t solids = 3 * (size_t)(c->points - c->free);
    memcpy(at + 3 * (size_t)c->free, c->at + 3 * (size_t)c->free, solids * sizeof *at);
}

static double most_moved(const struct contact *c, const int point[4], int first) {
    double one = c->moved[point[0]], other = fmax(c->moved[point[2]], c->moved[point[3]]);
    if (first == 2) one = fmax(one, c->moved[point[1]]);
    else other = fmax(other, c->moved[point[1]]);
    return one + other;
}

/* The pairs of a block that are closer than their thickness, at the block's place. */
static void find_hits(void *arg, int first, int last, int block) {
    struct contact *c = arg;
    int count = 0;
    for (int k = first; k < last; k++) {
        const struct pair *p = &c->pair[k];
        const struct pair_kind *kind = pair_kind_of(p->key);
        if (p->distance - most_moved(c, p->point, kind->first) >= p->thickness) continue;
        const double *x[4];
        struct hit hit = {.pair = k};
        pair_load(p->point, c->at, x);
        double squared = kind->closest(x, hit.c);
        if (squared >= p->thickness * p->thickness) continue;
        hit.distance = sqrt(squared);
        c->hit[first + count++] = hit;
    }
    c->hit_count[block] = count;
}

static void set_offset(const struct contact *c, const struct stencil *s, double offset[3]) {
    memset(offset, 0, 3 * sizeof *offset);
    for (int k = 0; k < 4; k++)
        if (s->point[k] >= c->free) vec3_add(offset, s->c[k], c->at + 3 * (size_t)s->point[k]);
}

/* Contact number e of the list. */
static void set_contact(struct contact *c, int e, const struct hit *hit) {
    const struct pair *p = &c->pair[hit->pair];
    struct stencil *s = &c->current.stencil[e];
    pdyn_contact *to = &c->current.contact[e];
    int some = p->point[0] < c->free ? p->point[0] : p->point[3];
    *to = (pdyn_contact){.key = p->key, .distance = hit->distance, .thickness = p->thickness};
    memcpy(s->point, p->point, sizeof s->point);
    memcpy(s->c, hit->c, sizeof s->c);
    for (int k = 0; k < 4; k++) {
        bool free = p->point[k] < c->free;
        to->particle[k] = c->column[free ? p->point[k] : some];
        to->coefficient[k] = free ? hit->c[k] : 0.0;
        vec3_add(to->separation, hit->c[k], c->at + 3 * (size_t)p->point[k]);
    }
    set_offset(c, s, to->offset);
}

static void set_contacts(void *arg, int first, int last, int block) {
    struct contact *c = arg;
    (void)last;
    for (int k = 0, e = c->hit_start[block]; k < c->hit_count[block]; k++, e++)
        set_contact(c, e, &c->hit[first + k]);
}

pdyn_status contact_list_reserve(pdyn_context *context, struct contact_list *list, int count) {
    if (count <= list->room) return PDYN_OK;
    contact_list_free(context, list);
    list->room = count + count / 2;
    list->view.contact = list->contact = NEW_ARRAY(context, list->room, pdyn_contact);
    list->stencil = NEW_ARRAY(context, list->room, struct stencil);
    return list->contact && list->stencil ? PDYN_OK : PDYN_NO_MEMORY;
}

void contact_list_free(pdyn_context *context, struct contact_list *list) {
    FREE_ARRAY(context, list->contact, list->room);
    FREE_ARRAY(context, list->stencil, list->room);
    list->view.contact = NULL, list->view.count = list->room = 0;
}

static pdyn_status find_contacts(struct contact *c) {
    int blocks = pool_blocks(c->pairs, CONTACT_GRAIN), count = 0;
    pool_for(c->context->pool, c->pairs, CONTACT_GRAIN, find_hits, c);
    for (int b = 0; b < blocks; b++) c->hit_start[b] = count, count += c->hit_count[b];
    pdyn_status status = contact_list_reserve(c->context, &c->current, count);
    if (status != PDYN_OK) return status;
    c->current.view.count = count;
    pool_for(c->context->pool, c->pairs, CONTACT_GRAIN, set_contacts, c);
    return PDYN_OK;
}

/* Solids may have moved since the step began. */
static void follow_solids(struct contact *c) {
    struct contact_list *start = &c->start;
    for (int e = 0; e < start->view.count; e++)
        set_offset(c, &start->stencil[e], start->contact[e].offset);
}

pdyn_status contact_local(struct contact *c, const double *x) {
    double start = clock_ms();
    gather(c, x, c->at);
    pdyn_status status = contact_cover(c, c->at, NULL);
    if (status == PDYN_OK) status = find_contacts(c);
    if (c->moving) follow_solids(c);
    c->ms += clock_ms() - start;
    return status;
}

/* ---- paths ----------------------------------------------------------------------------------- */

/* Solids go the part of their steps that was found free. */
static void move_solids(struct contact *c) {
    size_t first = (size_t)c->free, count = 3 * (size_t)(c->points - c->free);
    c->behind = false;
    for (size_t k = 0; c->moving && k < count; k++)
        c->at[3 * first + k] = c->x[3 * first + k] + c->step[3 * first + k];
    for (size_t i = first; c->moving && i < (size_t)c->points; i++) c->behind |= c->taken[i] < 1.0;
}

static void step_solids(struct contact *c) {
    size_t first = 3 * (size_t)c->free, count = 3 * (size_t)(c->points - c->free);
    for (size_t k = 0; k < count; k++)
        c->step[first + k] = c->moving ? c->goal[k] - c->x[first + k] : 0.0;
}

pdyn_status contact_start(struct contact *c, const double *x, double *target) {
    double start = clock_ms();
    size_t solids = 3 * (size_t)(c->points - c->free) * sizeof *c->at;
    if (solids) memcpy(c->at + 3 * (size_t)c->free, c->begin, solids);
    gather(c, x, c->x);
    for (int i = 0; i < c->free; i++)
        for (int a = 0; a < 3; a++)
            c->step[3 * i + a] = target[3 * c->column[i] + a] - c->x[3 * i + a];
    step_solids(c);
    pdyn_status status = contact_free_paths(c);
    for (int i = 0; i < c->free; i++)
        if (c->taken[i] < 1.0)
            for (int a = 0; a < 3; a++)
                target[3 * c->column[i] + a] = c->x[3 * i + a] + c->step[3 * i + a];
    move_solids(c);
    c->ms += clock_ms() - start;
    return status;
}

pdyn_status contact_filter(struct contact *c, const double *x, double *direction) {
    double start = clock_ms();
    size_t first = 3 * (size_t)c->free, count = 3 * (size_t)(c->points - c->free);
    gather(c, x, c->x);
    gather(c, direction, c->step);
    if (count) memset(c->step + first, 0, count * sizeof *c->step);
    pdyn_status status = contact_free_paths(c);
    for (int i = 0; i < c->free; i++)
        if (c->taken[i] < 1.0)
            memcpy(direction + 3 * c->column[i], c->step + 3 * i, 3 * sizeof *direction);
    c->ms += clock_ms() - start;
    return status;
}

double contact_least(const struct contact *c) {
    double least = 1.0;
    for (int i = 0; i < c->free; i++) least = fmin(least, c->taken[i]);
    return least;
}

pdyn_status contact_advance(struct contact *c, const double *x) {
    double start = clock_ms();
    gather(c, x, c->x);
    memset(c->step, 0, 3 * (size_t)c->free * sizeof *c->step);
    step_solids(c);
    pdyn_status status = contact_free_paths(c);
    move_solids(c);
    c->ms += clock_ms() - start;
    return status;
}

static void set_goal(struct contact *c, double time) {
    for (int s = 0; s < c->groups - c->bodies; s++) {
        const struct contact_solid *solid = &c->solid[s];
        if (solid->solid->keys)
            pose_place(solid->solid, c->rest + 3 * (size_t)solid->first, solid->count, time,
                       c->goal + 3 * (size_t)(solid->first - c->free));
    }
}

/* Fluids slide along surfaces: the barrier alone acts on them. */
static bool has_fluid(const struct contact *c, const struct stencil *s) {
    return s->point[0] >= c->vertices && s->point[0] < c->free;
}

/* The contacts of surfaces and solids become those of the beginning of the step. */
static pdyn_status set_start(struct contact *c) {
    const struct contact_list *from = &c->current;
    struct contact_list *to = &c->start;
    int count = 0;
    for (int e = 0; e < from->view.count; e++) count += !has_fluid(c, &from->stencil[e]);
    pdyn_status status = contact_list_reserve(c->context, to, count);
    if (status != PDYN_OK) return status;
    to->view.count = 0;
    for (int e = 0; e < from->view.count; e++) {
        if (has_fluid(c, &from->stencil[e])) continue;
        to->contact[to->view.count] = from->contact[e];
        to->stencil[to->view.count++] = from->stencil[e];
    }
    return PDYN_OK;
}

pdyn_status contact_begin(struct contact *c, double time) {
    double start = clock_ms();
    size_t solids = 3 * (size_t)(c->points - c->free) * sizeof *c->at;
    c->ms = 0.0;
    if (solids) memcpy(c->begin, c->at + 3 * (size_t)c->free, solids);
    if (c->moving) set_goal(c, time);
    pdyn_status status = set_start(c);
    c->ms += clock_ms() - start;
    return status;
}

pdyn_status contact_take_back(struct contact *c, const double *x) {
    size_t solids = 3 * (size_t)(c->points - c->free) * sizeof *c->at;
    if (solids) memcpy(c->at + 3 * (size_t)c->free, c->begin, solids);
    return contact_local(c, x);
}

/* The pairs are listed again where they were, for their order decides how sums are rounded. */
void contact_persist(struct contact *c, const double *x, struct snapshot_file *a) {
    size_t n = (size_t)c->points;
    snapshot_file_bytes(a, c->region, n * sizeof *c->region);
    snapshot_file_bytes(a, c->reach, n * sizeof *c->reach);
    snapshot_file_bytes(a, c->built, 3 * n * sizeof *c->built);
    snapshot_file_bytes(a, c->at, 3 * n * sizeof *c->at);
    ARCHIVE(a, c->behind);
    pdyn_status status = a->status;
    if (status == PDYN_OK && a->view.reading) status = contact_list(c);
    if (status == PDYN_OK && a->view.reading) status = contact_local(c, x);
    if (a->status == PDYN_OK) a->status = status;
}
