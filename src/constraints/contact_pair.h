/* The row of a contact and its barrier, for the constraints contact and friction. Where the
 * distance d of a pair (pdyn_contact) is below its thickness T, it has the energy
 *
 *     b(d) = k (T - d)^3 / (2 d),    -b' = k/2 (T - d)^2 (T + 2 d) / d^2,    b'' = k (T^3/d^3 - 1),
 *
 * with two continuous derivatives at T; k is the stiffness of the scene's contact, N/m, times the
 * share of the pair. */
#ifndef PDYN_CONTACT_PAIR_H
#define PDYN_CONTACT_PAIR_H

#include "projdyn/module.h"

#include <string.h>

/* Fills column and coefficient of element e from contact e. */
static inline void contact_select(const pdyn_batch *b, int e) {
    const pdyn_contact *contact = &b->contacts->contact[e];
    memcpy(b->column + 4 * e, contact->particle, sizeof contact->particle);
    memcpy(b->coefficient + 4 * e, contact->coefficient, sizeof contact->coefficient);
}

/* The force -b' at a distance d below the thickness, N. */
static inline double contact_force(const pdyn_batch *b, const pdyn_contact *contact, double d) {
    double depth = contact->thickness - d;
    double stiffness = contact->share * b->contacts->stiffness;
    return 0.5 * stiffness * depth * depth * (contact->thickness + 2.0 * d) / (d * d);
}

/* Fills the weights of a range: b'' at the distance at which the contact was found. */
static inline void contact_weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const pdyn_contact *contact = &b->contacts->contact[e];
        double ratio = contact->thickness / contact->distance;
        b->weight[e] = contact->share * b->contacts->stiffness * (ratio * ratio * ratio - 1.0);
    }
}

#endif
