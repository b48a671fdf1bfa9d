/* The residual of a step, |grad E| over the scale of each body:
 *
 *     scale = max(|M g|, |M (x - s)/h^2|) + load
 *
 * |M g|: weight. |M (x - s)/h^2|: impact, the force that changes the motion of the body, in scenes
 * with contact, not of fluids. At rest it is the weight. load: norm over the particles of the
 * forces that fluids put on the body. A sheet that is hit, or that carries water, is thus solved to
 * a part of the forces on it. Impact and load are of the x of the last local step. */
#ifndef PDYN_RESIDUAL_H
#define PDYN_RESIDUAL_H

#include "objective.h"

/* After all batches are made: the memory that loads need. PDYN_NO_MEMORY. */
pdyn_status residual_create(struct objective *objective);
void residual_free(struct objective *objective);

/* Begins a local step: measures impacts, forgets the loads of the last one. inertial: gradient of
 * the inertial part of E, particles x 3, N. */
void residual_open(struct objective *objective, const double *inertial);

/* Before and after a batch adds its gradient, particles x 3, N. Other batches than those of fluids
 * beside surfaces are left out. */
void residual_open_load(struct objective *objective, const struct batch *batch,
                        const double *gradient);
void residual_add_load(struct objective *objective, const struct batch *batch,
                       const double *gradient);

/* Measures the residual of every body from the gradient of E; returns the largest. */
double objective_residual(struct objective *objective, const double *gradient);

/* The length of a residual: the root of the sum over bodies of |r|^2 / scale^2, which bounds
 * the residual of every body. */
double objective_norm(struct objective *objective, const double *r);
double objective_norm_between(struct objective *objective, int first, int last, const double *r);

#endif
