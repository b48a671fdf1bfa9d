/* Contacts: pairs that are closer than their thickness, with the weights of their closest points.
 * contact_parts.h has two lists of them: of the last local step, and of the beginning of the step.
 */
#include "bearings.h"
#include "contact_parts.h"

#include "base/groups.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- lists ----------------------------------------------------------------------------------- */

/* Makes room for so many contacts; those in the list are lost where it grows. */
static pdyn_status reserve(pdyn_context *context, struct contact_list *list, int count) {
    if (count <= list->room) return PDYN_OK;
    contact_list_free(context, list);
    list->room = count + count / 2;
    list->view.contact = list->contact = NEW_ARRAY(context, list->room, pdyn_contact);
    list->stencil = NEW_ARRAY(context, list->room, struct stencil);
    list->key = NEW_ARRAY(context, list->room, uint64_t);
    list->force = NEW_ARRAY(context, list->room, double);
    if (list->contact && list->stencil && list->key && list->force) return PDYN_OK;
    contact_list_free(context, list);
    return PDYN_NO_MEMORY;
}

void contact_list_free(pdyn_context *context, struct contact_list *list) {
    FREE_ARRAY(context, list->contact, list->room);
    FREE_ARRAY(context, list->stencil, list->room);
    FREE_ARRAY(context, list->key, list->room);
    FREE_ARRAY(context, list->force, list->room);
    list->view.contact = NULL, list->view.count = list->room = 0;
}

/* ---- of a local step ------------------------------------------------------------------------- */

/* A pair is skipped where its distance exceeds its thickness by more than this part of it. The
 * slack is far above the rounding of the lower bounds: a resumed run adds these up in another
 * order, and must find the same pairs. */
static const double rounding = 1e-6;

/* Writes the pairs of a block that are closer than their thickness to c->hits.hit + first. A pair
 * that is farther away keeps a lower bound of its distance. */
static void find_hits(void *arg, int first, int last, int block) {
    struct contact *c = arg;
    int count = 0;
    for (int k = first; k < last; k++) {
        struct pair *p = &c->pairs.pair[k];
        p->distance -= pair_largest(p, c->pairs.moved);
        if (p->distance > (1.0 + rounding) * p->thickness) continue;
        const double *x[4];
        struct hit hit = {.pair = k};
        pair_load(p->point, c->at, x);
        p->distance = hit.distance = sqrt(pair_kind_of(p->key)->closest(x, hit.c));
        if (hit.distance < p->thickness && !contact_is_beyond_flat_side(c, p, &hit))
            c->hits.hit[first + count++] = hit;
    }
    c->hits.count[block] = count;
}

/* Squared sine of the angle below which edges are nearly parallel: 1.8 degrees. */
static const double parallel = 1e-3;

/* The share of its stiffness that a contact has: for edges the mollifier of Li et al. (2020), 0
 * where they are parallel. There the closest points are not unique, and the moment of the force
 * would jump: a soft block whose edges lie along the diagonal of a plane had unsolved steps. A pair
 * of a vertex and a face has the same distance and carries the force. The directions are those at
 * the beginning of the step, so that the share is constant within it. */
static double share_of(const struct contact *c, uint64_t key, const int point[4]) {
    const double *x[4];
    double d[2][3], normal[3];
    if (pair_kind_of(key) != &pair_edge_edge) return 1.0;
    pair_load(point, c->start_at, x);
    for (int k = 0; k < 2; k++) vec3_subtract(d[k], x[2 * k + 1], x[2 * k]);
    vec3_cross(normal, d[0], d[1]);
    double squares = vec3_dot(d[0], d[0]) * vec3_dot(d[1], d[1]);
    double t = vec3_dot(normal, normal) / (parallel * squares);
    return t < 1.0 ? t * (2.0 - t) : 1.0;
}

static void set_offset(const struct contact *c, const struct stencil *s, double offset[3]) {
    memset(offset, 0, 3 * sizeof *offset);
    for (int k = 0; k < 4; k++)
        if (s->point[k] >= c->free) vec3_add(offset, s->c[k], c->at + 3 * (size_t)s->point[k]);
}

/* Sets contact e of the current list. A point of a solid adds to the offset; in its place, the row
 * selects a free point of the pair with the coefficient 0. */
static void set_contact(struct contact *c, int e, const struct hit *hit) {
    const struct pair *p = &c->pairs.pair[hit->pair];
    struct stencil *s = &c->current.stencil[e];
    pdyn_contact *to = &c->current.contact[e];
    int some = p->point[0] < c->free ? p->point[0] : p->point[3];
    *to = (pdyn_contact){.key = contact_key(c, p),
                         .distance = hit->distance,
                         .thickness = p->thickness,
                         .share = share_of(c, p->key, p->point)};
    memcpy(s->point, p->point, sizeof s->point);
    memcpy(s->c, hit->c, sizeof s->c);
    for (int k = 0; k < 4; k++) {
        bool free = p->point[k] < c->free;
        to->particle[k] = c->column[free ? p->point[k] : some];
        to->coefficient[k] = free ? hit->c[k] : 0.0;
        vec3_add(to->separation, hit->c[k], c->at + 3 * (size_t)p->point[k]);
    }
    set_offset(c, s, to->offset);
    contact_side(c, p, to->side);
}

static void set_contacts(void *arg, int first, int last, int block) {
    struct contact *c = arg;
    (void)block;
    for (int e = first; e < last; e++) set_contact(c, e, &c->hits.hit[c->hits.sorted[e].place]);
}

/* Sorts the hits of all blocks by the keys of their pairs; returns their number. */
static int sort_hits(struct contact *c) {
    int count = 0;
    for (int b = 0; b < pool_blocks(c->pairs.count, CONTACT_GRAIN); b++)
        for (int k = b * CONTACT_GRAIN; k < b * CONTACT_GRAIN + c->hits.count[b]; k++)
            c->hits.sorted[count++] = (struct keyed){c->pairs.pair[c->hits.hit[k].pair].key, k};
    sort_by_key(c->hits.sorted, count);
    return count;
}

pdyn_status contact_find(struct contact *c) {
    pool_for(c->context->pool, c->pairs.count, CONTACT_GRAIN, find_hits, c);
    memcpy(c->pairs.seen, c->at, 3 * (size_t)c->points * sizeof *c->pairs.seen);
    int count = sort_hits(c);
    pdyn_status status = reserve(c->context, &c->current, count);
    if (status == PDYN_OK)
        status = row_memory_reserve(c->context, &c->pressed, count, sizeof *c->current.force);
    if (status != PDYN_OK) return status;
    c->current.view.count = count;
    pool_for(c->context->pool, count, CONTACT_GRAIN, set_contacts, c);
    return PDYN_OK;
}

/* ---- of the beginning of a step -------------------------------------------------------------- */

/* The barrier acts on particles of fluids, friction does not. */
static bool has_fluid(const struct contact *c, const struct stencil *s) {
    return is_particle(c, s->point[0]);
}

/* What solids add to the shortest vector on their way to their goals. */
static void set_shift(const struct contact *c, const struct stencil *s, double shift[3]) {
    for (int k = 0; k < 4 && c->moving; k++) {
        if (s->point[k] < c->free) continue;
        vec3_add(shift, s->c[k], c->goal + 3 * (size_t)(s->point[k] - c->free));
        vec3_add(shift, -s->c[k], c->at + 3 * (size_t)s->point[k]);
    }
}

void contact_set_start_positions(struct contact *c) {
    struct contact_list *list = &c->current;
    memcpy(c->start_at, c->at, 3 * (size_t)c->points * sizeof *c->at);
    for (int e = 0; e < list->view.count; e++)
        list->contact[e].share = share_of(c, list->contact[e].key, list->stencil[e].point);
}

static void set_keys(struct contact_list *list) {
    for (int e = 0; e < list->view.count; e++) list->key[e] = list->contact[e].key;
}

void contact_store_forces(struct contact *c) {
    struct contact_list *list = &c->current;
    if (c->bearings) bearings_add_forces(c);
    set_keys(list);
    row_memory_set(&c->pressed, list->key, list->force, list->view.count, sizeof *list->force);
}

/* The normal forces of the step before. */
static void recall_forces(const struct contact *c, struct contact_list *list) {
    set_keys(list);
    row_memory_get(&c->pressed, list->key, list->force, list->view.count, sizeof *list->force);
    for (int e = 0; e < list->view.count; e++) list->contact[e].force = list->force[e];
}

pdyn_status contact_set_start(struct contact *c) {
    const struct contact_list *from = &c->current;
    struct contact_list *to = &c->start;
    int count = 0;
    for (int e = 0; e < from->view.count; e++) count += !has_fluid(c, &from->stencil[e]);
    pdyn_status status = reserve(c->context, to, count);
    if (status != PDYN_OK) return status;
    to->view.count = 0;
    for (int e = 0; e < from->view.count; e++) {
        if (has_fluid(c, &from->stencil[e])) continue;
        to->contact[to->view.count] = from->contact[e];
        set_shift(c, &from->stencil[e], to->contact[to->view.count].shift);
        to->stencil[to->view.count++] = from->stencil[e];
    }
    recall_forces(c, to);
    return PDYN_OK;
}

void contact_follow_solids(struct contact *c) {
    struct contact_list *start = &c->start;
    for (int e = 0; e < start->view.count; e++)
        set_offset(c, &start->stencil[e], start->contact[e].offset);
}

/* ---- for the rest of core -------------------------------------------------------------------- */

const pdyn_contacts *contact_current(const struct contact *c) { return &c->current.view; }
const pdyn_contacts *contact_at_start(const struct contact *c) { return &c->start.view; }
const pdyn_body *contact_body(const struct contact *c) { return &c->body; }
double *contact_normal_forces(struct contact *c) { return c->current.force; }

int contact_list_vertices(const struct contact *c, const pdyn_contacts *contacts, int e,
                          struct contact_vertex vertex[4]) {
    const struct stencil *s = &((const struct contact_list *)contacts)->stencil[e];
    int count = 0;
    for (int k = 0; k < 4; k++)
        if (s->point[k] >= c->free)
            vertex[count++] = (struct contact_vertex){c->group[s->point[k]] - c->bodies, s->c[k],
                                                      c->at + 3 * (size_t)s->point[k]};
    return count;
}

void contact_join(const struct contact *c, int *group) {
    for (int k = 0; k < c->pairs.count; k++) {
        const int *point = c->pairs.pair[k].point;
        groups_join(group, c->column[point[0]], c->column[point[3]]);
    }
}
