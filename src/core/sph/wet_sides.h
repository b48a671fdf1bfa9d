/* The sides of surfaces with fluid on them (pdyn_wet_sides), of bodies that have friction with the
 * fluid (src/constraints/slip.c) or let it pass (src/constraints/seepage.c).
 *
 * On a side of a sample s that is wet, the mean position of the fluid less that of the sample is
 *
 *     u = sum_i c_i x_i - S x,     c_i = W(x_i - x_s) / sum_j W(x_j - x_s)
 *
 * over the fluid particles i, j on that side when the step begins; S interpolates the sample
 * between the corners of its triangle. A scene without such bodies has no struct wet_sides. */
#ifndef PDYN_WET_SIDES_H
#define PDYN_WET_SIDES_H

#include "base/context.h"
#include "projdyn/module.h"

struct scene;

struct wet_sides {
    pdyn_context *context;
    const struct surface_samples *samples;
    const pdyn_neighbours *lists;
    pdyn_body all;          /* every particle of the system, for the batch */
    double *along, *across; /* samples, N s/m: friction and resistance times the area at rest */
    int *first;             /* 2 samples + 1: the first wet side of each side */
    int room;
    pdyn_wet_side *side; /* room */
    pdyn_wet_sides view; /* what constraints see */
    const double *x;     /* where the step begins, with the samples */
};

/* After a failure *out is to be freed, too. */
pdyn_status wet_sides_create(pdyn_context *context, const struct scene *scene,
                             const pdyn_body *body, const struct surface_samples *samples,
                             const pdyn_neighbours *lists, struct wet_sides **out);
void wet_sides_free(struct wet_sides *wet_sides);

/* A step begins at x, with the samples; the lists are complete there. */
pdyn_status wet_sides_find(struct wet_sides *wet_sides, const double *x);

#endif
