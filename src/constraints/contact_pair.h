/* The row of a contact and its barrier, for the constraints contact and friction. */
#ifndef PDYN_CONTACT_PAIR_H
#define PDYN_CONTACT_PAIR_H

#include "projdyn/barrier.h"
#include "projdyn/module.h"

#include <string.h>

/* Fills column and coefficient of element e from contact e. */
static inline void contact_select(const pdyn_batch *b, int e) {
    const pdyn_contact *contact = &b->contacts->contact[e];
    memcpy(b->column + 4 * e, contact->particle, sizeof contact->particle);
    memcpy(b->coefficient + 4 * e, contact->coefficient, sizeof contact->coefficient);
}

/* k of the barrier of a contact, N/m */
static inline double contact_stiffness(const pdyn_batch *b, const pdyn_contact *contact) {
    return contact->share * b->contacts->stiffness;
}

/* Fills the weights of a range: b'' at the distance at which the contact was found. */
static inline void contact_weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const pdyn_contact *contact = &b->contacts->contact[e];
        b->weight[e] =
            barrier_stiffness(contact_stiffness(b, contact), contact->thickness, contact->distance);
    }
}

#endif
