/* The pressure of the fluid on a wall around the place of a probe: force over area of the boundary
 * points of solids, or of the samples on a rigid body. */
#ifndef PDYN_PROBE_WALL_H
#define PDYN_PROBE_WALL_H

#include "probe_place.h"

/* Whether there is a wall within the radius, m. */
bool probe_wall_exists(const struct pdyn_sim *sim, const struct probe_place *place, double radius);
/* Pa, in the last step. */
double probe_wall_pressure(const struct pdyn_sim *sim, const struct probe_place *place,
                           double radius);
/* Sums the forces of fluids on samples (probes->sample_force) after a step. */
void probe_wall_sum(const struct pdyn_sim *sim);

#endif
