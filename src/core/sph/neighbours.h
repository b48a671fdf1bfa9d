/* Neighbour lists for SPH sums. Lists hold every pair closer than its support plus a skin at the
 * time they were built, so they stay complete until some particle has moved by half the skin, or by
 * what moving boundary points have left of it. Pairs are those of a centre (a particle of a fluid)
 * with another centre, with a sample of a surface, both ways, and with a boundary point; but two
 * centres, or a centre and a boundary point, between which there was a surface when the lists were
 * built, are no pair: as long as nothing passes through it, it stays between them. */
#ifndef PDYN_NEIGHBOURS_H
#define PDYN_NEIGHBOURS_H

#include "base/context.h"
#include "occlusion.h"
#include "projdyn/module.h"
#include "surface_samples.h"

struct neighbours;

struct neighbours_points { /* all arrays are copied */
    int particles;         /* of the system, then the samples, which take part and are no centres */
    const bool *centre;    /* particles */
    int boundary;
    const double *boundary_x; /* boundary x 3, m */
    int moving;               /* so many of the last boundary points may move */
    const double *volume;     /* particles, then boundary; 0 for a particle that takes no part */
    const bool *is_wall;      /* boundary: has a volume, and the support of centres */
    double support, surface_support; /* m: see pdyn_neighbours */
    double skin;                     /* m */
    bool has_volumes;                /* the same */
    struct occlusion *sides;         /* what hides centres from each other, or NULL; not copied */
};

/* samples: the last particles, or NULL for none; they must stay. Memory: 129 bytes per particle,
 * 108 per boundary point, 24 more where it may move, and 5 per listed neighbour (about 55 of
 * these); where there are surfaces 40 more per particle, and 4 per listed neighbour. */
pdyn_status neighbours_create(pdyn_context *context, const struct neighbours_points *points,
                              const struct samples *samples, struct neighbours **out);
void neighbours_free(struct neighbours *neighbours);

/* Of the centres only those take part from now on that are live; lists have to be built again. All
 * centres must have the same volume, and takes part what has one at first: there is room for that.
 */
void neighbours_change(struct neighbours *neighbours, const bool *live);
/* The samples' volumes have changed. */
void neighbours_stretch(struct neighbours *neighbours, const struct samples *samples);
/* The boundary points that may move are now at x (moving x 3). */
void neighbours_move(struct neighbours *neighbours, const double *x);

/* Are the lists complete at x (particles x 3)? */
bool neighbours_hold(struct neighbours *neighbours, const double *x);

/* Builds the lists for x and what is less than half the skin away; the revision moves. A position
 * that is not finite or beyond 1e6 supports gives PDYN_DIVERGED. */
pdyn_status neighbours_build(struct neighbours *neighbours, const double *x);

/* Writes where the lists were built, or reads it and builds them there. Who takes part has to be
 * known before; boundary points that move have to be moved after. */
pdyn_status neighbours_persist(struct neighbours *neighbours, pdyn_snapshot *snapshot);

/* A step begins where the system's particles are at x, which stay there until it ends. */
void neighbours_begin(struct neighbours *neighbours, const double *x);

/* The step's first local step is done: lists that are built later hide what they hide now. */
void neighbours_decided(struct neighbours *neighbours);

/* After a step. */
void neighbours_settle(struct neighbours *neighbours);

const pdyn_neighbours *neighbours_view(const struct neighbours *neighbours);

/* Rest volumes of points sampled on a surface, 1 / sum_k W (Akinci et al. 2012), m^3. */
pdyn_status neighbours_surface_volumes(pdyn_context *context, int points, const double *x,
                                       double support, double *volume);

#endif
