/* A coarser twin of a scene, which costs little enough to be run to its end with many settings. */
#ifndef TWIN_H
#define TWIN_H

#include "setting.h"

#include <jansson.h>

/* Particles `factor` times as large, grids of sheets with so many times fewer vertices a side; with
 * steps as long (cfl counts radii), water as stiff (w / d is its bulk modulus) and as viscous. No
 * overrides: nothing of the scene can be made coarser. scene: JSON with overrides done. */
void twin_make(const json_t *scene, double factor, struct setting *twin);

#endif
