/* The head of the fluids of a scene: the height of a column of one of them that has the largest
 * pressure at its bottom, m. */
#ifndef PDYN_HEAD_H
#define PDYN_HEAD_H

#include "scene.h"

/* Computes the head in a fluid of rest density rho, m; 0 without gravity, and for rho = 0. With
 * heights z along -gravity, from the lowest point of all bodies, inlets and solids:
 *
 *     top_b = max over the body's initial positions and inlets (height + speed^2 / (2 |gravity|))
 *     head  = integral over z of (largest rest density of the bodies b with top_b > z) / rho
 *
 * Of one fluid it is top - lowest point. rho g head is the hydrostatic pressure at the bottom of
 * layers at rest and, by Bernoulli's equation, the largest pressure in a steady flow that starts
 * from the bodies. Heights of particles include their radius; solids are at their initial
 * placement. */
double scene_head(const struct scene *scene, double rest_density);

#endif
