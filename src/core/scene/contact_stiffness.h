/* The default of `contact.stiffness`. */
#ifndef PDYN_CONTACT_STIFFNESS_H
#define PDYN_CONTACT_STIFFNESS_H

#include "scene.h"

/* N/m: f / thickness, so that the force f holds a vertex at half of the thickness, and at least
 * 1000. f is the weight of the heaviest rigid body, or the largest pressure of the scene times the
 * area of a vertex, if that is more. */
double scene_contact_stiffness(const struct scene *scene);

#endif
