/* The head of a body: how far it can fall, its speed at the start counted as a height. */
#ifndef PDYN_HEAD_H
#define PDYN_HEAD_H

#include "scene.h"

/* m; 0 without gravity. With heights along -gravity:
 *
 *     head = max over the body's start positions and inlets (height + speed^2 / (2 |gravity|))
 *            - min over all bodies, inlets and solids (height)
 *
 * rho g head is the hydrostatic pressure at the bottom of a fluid at rest, and by Bernoulli's
 * equation the largest pressure in a steady flow that starts from the body. Particles count with
 * their radius, solids where the scene puts them. */
double scene_head(const struct scene *scene, const struct scene_body *body);

#endif
