/* Warnings of a simulation (base/warnings.h): about values of its scene, and about its steps. */
#ifndef PDYN_WARN_H
#define PDYN_WARN_H

#include "projdyn/box.h"
#include "projdyn/projdyn.h"

struct pdyn_sim;

/* Raises warnings about values that are legal but surely not meant. */
pdyn_status warn_of_scene(struct pdyn_sim *sim);

/* The bounding box of all solids and live particles. */
struct box warn_extent(const struct pdyn_sim *sim);

/* The height, m, against gravity, below which a particle fell out of the scene: it is as far below
 * everything that the scene has at the start as that is wide and high. */
double warn_floor(const struct pdyn_sim *sim);

/* Raises warnings about the step that was just accepted. */
void warn_of_step(struct pdyn_sim *sim, const pdyn_step_info *info);

#endif
