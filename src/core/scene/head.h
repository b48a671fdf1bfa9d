/* The head of a body: the height from which it can fall, m, with the initial speed as additional
 * height. */
#ifndef PDYN_HEAD_H
#define PDYN_HEAD_H

#include "scene.h"

/* Computes the head, m; 0 without gravity. With heights along -gravity:
 *
 *     head = max over the body's initial positions and inlets (height + speed^2 / (2 |gravity|))
 *            - min over all bodies, inlets and solids (height)
 *
 * rho g head is the hydrostatic pressure at the bottom of a fluid at rest and, by Bernoulli's
 * equation, the largest pressure in a steady flow that starts from the body. Heights of particles
 * include their radius; solids are at their initial placement. */
double scene_head(const struct scene *scene, const struct scene_body *body);

#endif
