/* A few hundred nodes of sheets and solids, and how particles between them follow: what varies
 * slowly over a body, x = P X. Nodes are particles that static rows tie; P is the classical
 * interpolation of algebraic multigrid (Ruge and Stueben 1987), level upon level. */
#ifndef PDYN_INTERPOLATION_H
#define PDYN_INTERPOLATION_H

#include "objective/objective.h"
#include "sparse.h"

struct interpolation {
    int nodes;               /* those that share rows have near numbers */
    struct sparse particles; /* P: what each particle follows, particles x nodes */
    struct sparse followers; /* P' */
};

/* Zeroed before. The weights of rows are known. At most so many nodes, unless there are more pieces
 * that nothing ties. */
pdyn_status interpolation_create(struct interpolation *p, struct objective *objective, int most);
void interpolation_free(struct interpolation *p);

#endif
