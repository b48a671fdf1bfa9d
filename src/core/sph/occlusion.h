/* Whether a surface lies between two points: fluid on one side of a sheet feels neither fluid nor
 * walls on the other. Two points see each other where the segment between them meets no triangle
 * (the visibility criterion of meshless methods, Belytschko, Lu, Gu 1994). */
#ifndef PDYN_OCCLUSION_H
#define PDYN_OCCLUSION_H

#include "geometry/bvh.h"
#include "projdyn/module.h"

struct occlusion {
    pdyn_context *context;
    int points;        /* of the system, samples, boundary points */
    int triangles;     /* of all surfaces */
    int *corner;       /* triangles x 3: particles of the system */
    int planted;       /* so many are near to what asks: */
    int *planted_as;   /* triangles, planted used: these, */
    struct box *box;   /* the same: around each */
    struct bvh tree;   /* of these */
    const double *x;   /* where they are */
    double reach;      /* m: of pairs */
    double *clearance; /* points, m: to the next triangle, at most reach / 2 */
};

/* Pairs up to `reach` (m) apart will be asked for. *out is NULL where there is no surface. */
pdyn_status occlusion_create(pdyn_context *context, int bodies, const pdyn_body *body, int points,
                             double reach, struct occlusion **out);
void occlusion_free(struct occlusion *sides);

/* The surfaces are at x (of the system) from now on; of a pair, one point will lie in `around`. */
void occlusion_update(struct occlusion *sides, const double *x, const struct box *around);

/* Notes how far point i, there, is from them; needed of both points of a pair. */
void occlusion_measure(struct occlusion *sides, int i, const double *there);

/* Is point i, approached before, near to a surface? */
bool occlusion_is_near(const struct occlusion *sides, int i);

/* Is a triangle between i and j, which are at a and b? The same for (j, i). */
bool occlusion_blocks(const struct occlusion *sides, int i, const double *a, int j,
                      const double *b);

#endif
