/* Friction between a fluid and the surfaces in it, by Navier's law of slip (1823): each wet side of
 * a surface is pulled along by the stress beta v, v the velocity of the fluid there, along the
 * surface and relative to it, beta the surface's `fluid_friction`, Pa s/m.
 *
 * Every sample of a surface has for each of its sides that is wet an element, the row
 *
 *     u = sum_i c_i x_i - S x,     c_i = W(x_i - x_s) / sum_j W(x_j - x_s)
 *
 * of the fluid particles on that side at the beginning of the step, less the sample. Along the
 * surface a spring of stiffness beta A / h ties it to where it is then: after a step of length h,
 * that is the force beta A v of implicit Euler, A the sample's area. What the water loses the
 * corners of the sample's triangle get, so momentum stays. A scene without it has no struct
 * surface_friction.
 */
#ifndef PDYN_SURFACE_FRICTION_H
#define PDYN_SURFACE_FRICTION_H

#include "rows/batch.h"

struct scene;

struct surface_friction {
    pdyn_context *context;
    const struct samples *samples;
    const pdyn_neighbours *lists;
    pdyn_body all;       /* every particle of the system, for the batch */
    double *rate;        /* samples, N s/m: beta times the area at rest */
    int *first;          /* 2 samples + 1: the first element of each side */
    struct batch *batch; /* the system's */
    const double *x;     /* where the step begins, with the samples */
};

/* Of bodies with `fluid_friction`, with an empty batch over all particles of the system; *out stays
 * NULL where there are none. After a failure *out is to be freed, too. */
pdyn_status surface_friction_create(pdyn_context *context, const struct scene *scene,
                                    const pdyn_body *body, int particles,
                                    const struct samples *samples, const pdyn_neighbours *lists,
                                    struct surface_friction **out);
void surface_friction_free(struct surface_friction *surface_friction);

/* A step begins at x, with the samples; the lists are complete there. */
pdyn_status surface_friction_begin(struct surface_friction *surface_friction, const double *x);

#endif
