/* Friction by Coulomb's law, one element for each pair that is in contact when a step begins: along
 * the surfaces, its points are tied by a spring that lets go at the friction coefficient times the
 * normal force. Weights, normal and normal force are those of the beginning, so that the step
 * minimises one function (lagged friction, Li et al. 2020); what a spring is stretched by stays
 * with its pair to the next step, so that what sticks does not creep (Cundall & Strack 1979). */
#include "contact.h"

#include "projdyn/vec3.h"

#include <string.h>

static void offset_of(const struct contact *c, struct touching *pair) {
    memset(pair->offset, 0, sizeof pair->offset);
    for (int k = 0; k < 4; k++)
        if (pair->point[k] >= c->free)
            vec3_add(pair->offset, pair->c[k], c->at + 3 * (size_t)pair->point[k]);
}

/* Moves entry k of a heap, the largest key on top, down to its place among the first `count`. */
static void sift(struct remembered *heap, int k, int count) {
    for (int child; (child = 2 * k + 1) < count; k = child) {
        struct remembered moved = heap[k];
        if (child + 1 < count && heap[child + 1].key > heap[child].key) child++;
        if (heap[child].key <= moved.key) return;
        heap[k] = heap[child], heap[child] = moved;
    }
}

static void sort_by_key(struct remembered *heap, int count) {
    for (int k = count / 2 - 1; k >= 0; k--) sift(heap, k, count);
    for (int k = count - 1; k > 0; k--) {
        struct remembered largest = heap[0];
        heap[0] = heap[k], heap[k] = largest;
        sift(heap, 0, k);
    }
}

pdyn_status contact_make_memory(struct contact *c, int count) {
    c->remembered = 0;
    if (count > c->memory) {
        FREE_ARRAY(c->context, c->memory_of, c->memory);
        c->memory_of = NEW_ARRAY(c->context, count + count / 2, struct remembered);
        if (!c->memory_of) return c->memory = 0, PDYN_NO_MEMORY;
        c->memory = count + count / 2;
    }
    c->remembered = count;
    return PDYN_OK;
}

/* Keeps what the elements of the step before are stretched by at its end. */
pdyn_status contact_remember(struct contact *c) {
    const pdyn_batch *v = &c->sticking->view;
    pdyn_status status = contact_make_memory(c, v->elements);
    if (status != PDYN_OK) return status;
    for (int e = 0; e < v->elements; e++) { /* u - p is what is stretched and holds */
        struct remembered *m = &c->memory_of[e];
        m->key = ((const struct sticking *)v->data + e)->pair.key;
        for (int a = 0; a < 3; a++) m->stretch[a] = v->u[3 * e + a] - v->p[3 * e + a];
    }
    sort_by_key(c->memory_of, c->remembered);
    return PDYN_OK;
}

static const double *recall(const struct contact *c, uint64_t key) {
    static const double nothing[3];
    int low = 0, high = c->remembered;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (c->memory_of[middle].key < key) low = middle + 1;
        else high = middle;
    }
    return low < c->remembered && c->memory_of[low].key == key ? c->memory_of[low].stretch
                                                               : nothing;
}

/* Element e from that of contact `of`; its row and weight are taken over. */
static void stick(struct contact *c, int of, int e, const double stretch[3]) {
    const pdyn_batch *from = &c->touching->view;
    pdyn_batch *to = &c->sticking->view;
    struct sticking *data = (struct sticking *)to->data + e;
    *data = (struct sticking){.pair = ((const struct touching *)from->data)[of]};
    memcpy(to->column + 4 * e, from->column + 4 * of, 4 * sizeof *to->column);
    memcpy(to->coefficient + 4 * e, from->coefficient + 4 * of, 4 * sizeof *to->coefficient);
    to->weight[e] = from->weight[of];
    for (int k = 0; k < 4; k++)
        vec3_add(data->anchor, data->pair.c[k], c->at + 3 * (size_t)data->pair.point[k]);
    double d = vec3_length(data->anchor);
    for (int a = 0; a < 3; a++) data->normal[a] = data->anchor[a] / d;
    double along = vec3_dot(stretch, data->normal);
    for (int a = 0; a < 3; a++) data->anchor[a] -= stretch[a] - along * data->normal[a];
    data->limit = c->set->friction * contact_force(c->set->stiffness, data->pair.thickness, d);
}

/* Fluids slide along surfaces. */
static bool rubs(const struct contact *c, const struct touching *pair) {
    return pair->point[0] < c->vertices || pair->point[0] >= c->free;
}

pdyn_status contact_stick(struct contact *c) {
    const struct touching *pair = c->touching->view.data;
    int elements = c->touching->view.elements, count = 0;
    for (int e = 0; e < elements; e++) count += rubs(c, &pair[e]);
    pdyn_status status = batch_resize(c->sticking, count);
    if (status != PDYN_OK) return status;
    for (int e = 0, to = 0; e < elements; e++)
        if (rubs(c, &pair[e])) stick(c, e, to++, recall(c, pair[e].key));
    batch_index(c->sticking);
    return PDYN_OK;
}

void contact_move_friction(struct contact *c) {
    struct sticking *data = c->sticking->view.data;
    for (int e = 0; e < c->sticking->view.elements; e++) offset_of(c, &data[e].pair);
}
