/* Replica: a coarser copy of a scene, cheap enough to be run to its end with many settings. */
#ifndef REPLICA_H
#define REPLICA_H

#include "setting.h"

#include <jansson.h>

/* Adds to `replica` the overrides that coarsen a scene by the factor c:
 *
 *     particle radius          r -> c r
 *     vertices per grid side   n -> 1 + (n - 1)/c
 *     cell of a volume         a -> c a
 *     fluid stiffness          w -> c w          (bulk modulus ~ w/d is unchanged)
 *     fluid viscosity          nu -> nu/c^2      (kinematic viscosity ~ nu d^2/h is unchanged)
 *     time_step.cfl            -> cfl/c          (counts radii: the step length h is unchanged)
 *
 * with the particle spacing d. A fluid with "compression" or "sound_speed" derives its stiffness
 * from the radius. Particles and meshes from files, and grids with pins by vertex number, are
 * not coarsened. No overrides are added if nothing in the scene can be coarsened. scene: JSON
 * with the user's overrides applied. */
void replica_make(const json_t *scene, double factor, struct setting *replica);

/* Expected processor time of a scene over that of its replica: c^REPLICA_COST_EXPONENT. Three
 * powers for the number of particles, one for the iterations: information travels one spacing per
 * linear iteration. Measured on water alone and with cloth, c from 1.5 to 3: 3.5 to 4.2. */
enum { REPLICA_COST_EXPONENT = 4 };

#endif
