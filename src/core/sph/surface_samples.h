/* Points on surfaces through which these act on a fluid, closer together than its particles (see
 * boundary.h), whatever the mesh. A sample lies in a triangle and moves with its corners
 * (barycentric selector rows): with S the matrix of the weights, a vector x of the particles
 * becomes (x, S x), which SPH sums work on, and forces (f, f_s) on these come back as f + S' f_s.
 * So samples have no mass and are no unknowns, and what they exchange with the fluid conserves
 * momentum. */
#ifndef PDYN_SURFACE_SAMPLES_H
#define PDYN_SURFACE_SAMPLES_H

#include "base/context.h"
#include "boundary.h"
#include "projdyn/module.h"

struct samples {
    pdyn_context *context;
    int particles;          /* of the system */
    int count;              /* samples */
    int *vertex;            /* count x 3: particles of the system */
    double *weight;         /* count x 3: barycentric coordinates */
    double *volume;         /* count, m^3: what it counts in SPH sums (boundary.h), now, */
    double *rest_volume;    /* count, m^3: and at rest */
    double *rest_area;      /* count, m^2: of the sample's triangle */
    int live;               /* so many are near to some particle that sums are for: */
    int *near;              /* live: these samples, */
    int touched;            /* which lie on so many particles: */
    int *corner;            /* touched: these, */
    int *touch_start;       /* touched + 1: where each begins in */
    int *touch;             /* 3 live: places in vertex and weight, ascending for each particle */
    int *place;             /* particles: scratch */
    double *x;              /* (particles + count) x 3 and one: positions */
    double *input, *output; /* the same: what goes through an operator */
    double *blocks;         /* (particles + count) x 6 */
};

/* Samples all surfaces at rest (particles x 3) as the model says; thickness: m, of sheets, spacing:
 * m, of the fluid's particles. *out is NULL where there is no surface. */
pdyn_status samples_create(pdyn_context *context, int bodies, const pdyn_body *body, int particles,
                           const double *rest, const struct boundary_model *model, double thickness,
                           double spacing, struct samples **out);
void samples_free(struct samples *samples);

/* out = (x, S x) */
void samples_extend(const struct samples *samples, const double *x, double *out);

/* The lists are new: from now on only samples in them matter, but for samples_extend. */
void samples_reach(struct samples *samples, const pdyn_neighbours *lists);

/* input = (u, S u); u may be input itself. */
void samples_follow(const struct samples *samples, const double *u);

/* y += f + S' f_s; extended: (f, f_s). The f of y itself, where y is `extended`. */
void samples_gather(const struct samples *samples, const double *extended, double *y);

/* Adds a block diagonal, packed, x 6. Those of the samples are lumped to their corners, which
 * bounds S' D S from above. */
void samples_gather_blocks(const struct samples *samples, const double *extended, double *blocks);

/* A particle that samples lie on may move no farther than these (way: particles, then samples). */
void samples_limit(const struct samples *samples, double *way);

/* Volumes where the particles are at x: as the areas of the triangles. */
void samples_stretch(struct samples *samples, const double *x);

#endif
