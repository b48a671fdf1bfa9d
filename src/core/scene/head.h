/* The head of a body, m: of a surface, the height from which it can fall; of a fluid, the height of
 * a column of it that has the largest pressure of all fluids at its bottom. The pressure that a
 * fluid may meet in a scene. */
#ifndef PDYN_HEAD_H
#define PDYN_HEAD_H

#include "scene.h"

/* Computes the head, m; 0 without gravity. With heights z along -gravity, from the lowest point of
 * all bodies, inlets and solids:
 *
 *     top_b = max over the initial positions and inlets of body b
 *             (height + speed^2 / (2 |gravity|))
 *     head  = integral over z of (largest rest density of the bodies b with top_b > z) / rho
 *
 * For a surface, and where there is one fluid, head is its top. rho g head is the hydrostatic
 * pressure at the bottom of layers at rest and, by Bernoulli's equation, the largest pressure in a
 * steady flow that starts from the bodies. Heights of particles include their radius; solids are at
 * their initial placement, moving inlets at all of their keys. */
double scene_head(const struct scene *scene, const struct scene_body *body);

/* pdyn_scene_info.pressure of a body of particles, Pa; NULL: of the solid bodies alone. A body that
 * stops on a fluid gives it a part of its energy, a heavy one more than a column of the fluid. */
double scene_pressure(const struct scene *scene, const struct scene_body *fluid);

#endif
