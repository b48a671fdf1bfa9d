/* Bearings: all contacts between a rigid body and another one, or a solid, as one elastic support,
 * and the dashpots that damp the body's oscillation on it (docs/theory/contact.md#damping). */
#ifndef PDYN_BEARINGS_H
#define PDYN_BEARINGS_H

#include "contact_parts.h"
#include "rows/rigid_map.h"

enum { BEARING_DASHPOTS = 4 };

struct bearing {
    int group[2]; /* of contact: a rigid body; another one of a higher number or a solid */
    int next;     /* bearing with the same first group, -1: none */
    double force, stiffness; /* sums of -b', N, and of b'', N/m, over the contacts */
    double normal[3];        /* along the sum of the forces on the first group, length 1 */
    double net;              /* N: length of that sum */
    double centre[2][3];  /* m: mean of the contacts' points on the groups, with the weights b'' */
    double tilt[9];       /* N m: sum of b'' r r', r: from the centre, across the normal */
    double shift;         /* m: what a solid that moves adds to the distance in this step */
    double damping;       /* c of all dashpots together, N s/m */
    double dashpot_force; /* N: of these in the step, negative: they pull */
    double pressed;       /* N: sum of the contacts' forces at its end */
};

struct bearing_contact { /* of a contact of the beginning of the step */
    int bearing;         /* -1: none */
    double stiffness;    /* b'', N/m */
};

struct bearings {
    const struct rigid_map *map;
    int *body;  /* groups: number of the rigid body; -1: none */
    int *first; /* groups: a bearing of which it is the first group; -1: none */
    int count;
    size_t room, dashpot_room, contact_room;
    struct bearing *bearing;         /* room */
    pdyn_dashpot *dashpot;           /* dashpot_room */
    struct bearing_contact *contact; /* contact_room */
};

/* Makes contact->bearings; they stay NULL in a scene without rigid bodies or damping. */
pdyn_status bearings_create(struct contact *contact, const struct rigid_map *map);
void bearings_free(struct contact *contact);

/* Sets the dashpots of the contacts of the beginning of the step. x: positions of the system then,
 * m, particles x 3. */
pdyn_status bearings_update(struct contact *contact, const double *x);

/* Adds dashpot_force of each bearing to the normal forces of its contacts at the end of the step
 * (current.force), in proportion to these. */
void bearings_add_forces(struct contact *contact);

#endif
