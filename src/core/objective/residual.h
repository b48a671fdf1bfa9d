/* The residual of a step, |grad E| over the scale of each body. The scale is |M g|, the body's
 * weight, plus its load: the norm over its particles of the forces that fluids put on it. A light
 * sheet below water is thus solved to a part of what it carries. Both are of the x of the last
 * local step. */
#ifndef PDYN_RESIDUAL_H
#define PDYN_RESIDUAL_H

#include "objective.h"

/* After all batches are made: the memory that loads need. PDYN_NO_MEMORY. */
pdyn_status residual_create(struct objective *objective);
void residual_free(struct objective *objective);

/* Loads in a local step: forgets those of the last one; before and after a batch adds its gradient,
 * particles x 3, N. Other batches than those of fluids beside surfaces are left out. */
void residual_forget_loads(struct objective *objective);
void residual_open_load(struct objective *objective, const struct batch *batch,
                        const double *gradient);
void residual_add_load(struct objective *objective, const struct batch *batch,
                       const double *gradient);

#endif
