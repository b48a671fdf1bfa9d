/* Boundary points with density constraints of their own, C_b = sum_j V W(x_b - x_j) - s_b over the
 * fluid's particles j: s_b is what the fluid may share in the density at b. Without them a wall has
 * no pressure: next to it a particle feels only its own constraint push it off, and none of the
 * slope of the pressure along the wall; what it does not carry, others carry (cf. Band et al. 2018,
 * where boundary points are unknowns of the pressure equation).
 *
 * A lattice that touches a flat wall has the share 0.105 (by summing the kernel); in 0.085 water at
 * rest keeps its volume (measured). A point first grants what it sees, and then gives way slowly,
 * so that nothing is thrown off a wall at the start. Memory: 20 bytes per boundary point and 4 per
 * neighbour. */
#ifndef PDYN_FLUID_WALLS_H
#define PDYN_FLUID_WALLS_H

#include "projdyn/module.h"

#include <stdbool.h>
#include <stddef.h>

struct fluid;

struct fluid_walls {
    int *start;           /* boundary + 2: first neighbour of each point */
    int *particle;        /* neighbours: the particles that have the point in their lists */
    size_t capacity;      /* of these */
    double *share, *seen; /* boundary: s_b, 0 before it saw fluid; what it saw at last */
};

/* Turns the particles' lists round. false: no memory. */
bool fluid_walls_neighbours(struct fluid *f);
void fluid_walls_free(struct fluid *f);

/* The C_b of point b, where it sees the fluid with this density. */
double fluid_walls_see(struct fluid_walls *walls, int b, double density);

/* The step ended where the last local step was. */
void fluid_walls_settle(struct fluid *f);

/* Writes or reads what the walls have seen. */
void fluid_walls_persist(struct fluid *f, pdyn_archive *archive);

#endif
