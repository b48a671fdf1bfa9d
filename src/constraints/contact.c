/* Contact: a barrier (contact_pair.h) keeps surfaces, solids and the particles of fluids apart. */
#include "contact_pair.h"
#include "projdyn/vec3.h"

#include <string.h>

/* An element for every contact, in the same order. */
static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    (void)par, (void)x, (void)v, (void)room;
    return b->contacts->count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) contact_select(b, e);
}

/* Returns d; n: the direction of the shortest vector, length 1. */
static double distance(const pdyn_batch *b, int e, double n[3]) {
    const double *offset = b->contacts->contact[e].offset;
    for (int a = 0; a < 3; a++) n[a] = b->u[3 * e + a] + offset[a];
    double d = vec3_length(n);
    for (int a = 0; a < 3; a++) n[a] /= d;
    return d;
}

/* With the weight b'', the force w (u - p) is -b' n where u - p has the length -b'/b''. */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        double n[3], d = distance(b, e, n), T = b->contacts->contact[e].thickness;
        double length = 0.5 * d * (T - d) * (T + 2.0 * d) / (T * T + T * d + d * d);
        memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *n);
        vec3_add(b->p + 3 * e, length, n);
    }
}

/* I - J = n n' */
static void tangent_rank1(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4) distance(b, e, axis), axis[3] = 1.0;
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    double sum = 0.0;
    for (int e = first; e < last; e++) {
        const pdyn_contact *contact = &b->contacts->contact[e];
        double n[3], d = distance(b, e, n);
        sum += barrier_energy(contact_stiffness(b, contact), contact->thickness, d);
    }
    return sum;
}

const pdyn_constraint_type pdyn_constraint_contact = {
    .name = "contact",
    .summary = "keeps surfaces and solids apart",
    .flags = PDYN_CONTACT | PDYN_ANCHORED | PDYN_ONE_SIDED | PDYN_EVERY_ITERATION,
    .params = (const pdyn_param[]){{0}},
    .update = update,
    .rows = 1,
    .width = 4,
    .select = select,
    .weight = contact_weight,
    .project = project,
    .tangent_rank1 = tangent_rank1,
    .energy = energy,
};
