/* Occlusion: does a surface lie between two points? Fluid on one side of a sheet must not interact
 * with fluid or walls on the other side. Two points see each other if the segment between them
 * meets no triangle (visibility criterion of meshless methods; Belytschko, Lu, Gu 1994), or meets
 * it in the strip beside a border: then it goes around the border. */
#ifndef PDYN_OCCLUSION_H
#define PDYN_OCCLUSION_H

#include "border.h"
#include "geometry/bvh.h"
#include "projdyn/module.h"

struct occlusion {
    pdyn_context *context;
    int points;                  /* particles of the system, samples, boundary points */
    int triangles;               /* of all surfaces */
    int *corner;                 /* triangles x 3: particles of the system */
    bool *is_sheet;              /* triangles: of a sheet */
    int near_count;              /* number of triangles near the query points */
    int *near_triangle;          /* triangles, near_count in use: these triangles */
    struct box *box;             /* triangles, near_count in use: their bounding boxes, m */
    struct bvh tree;             /* hierarchy of these boxes */
    const double *x;             /* positions of the particles of the system, m; not copied */
    const struct border *border; /* of the surfaces */
    double reach;                /* m, largest distance of a pair */
    double *clearance;           /* points, m: distance to the nearest triangle, at most reach */
    int *nearest;                /* points: 1 + that triangle, 0: there was none */
};

/* Creates the state for pairs up to `reach`, m, apart. border: of the bodies, must stay valid. *out
 * is NULL if no body has a surface that hides. */
pdyn_status occlusion_create(pdyn_context *context, int bodies, const pdyn_body *body,
                             const struct border *border, int points, double reach,
                             struct occlusion **out);
void occlusion_free(struct occlusion *occlusion);

/* Sets the positions of the surfaces: x, of the system, must stay valid. around: a box, m, that
 * contains at least one point of every pair tested. */
void occlusion_update(struct occlusion *occlusion, const double *x, const struct box *around);

/* Computes the clearance of point i at `position`, m, at most `most`: half of the reach, so that
 * two far points see each other, or all of it, so that one is enough. Needed for both points of a
 * pair before occlusion_blocks, but not for the second one if the first is clear. */
void occlusion_compute_clearance(struct occlusion *occlusion, int i, const double *position,
                                 double most);

/* Whether no surface is closer to point i, measured before, than `distance`, m. */
bool occlusion_is_clear(const struct occlusion *occlusion, int i, double distance);

/* Whether point i, measured before, is within reach / 2 of a surface. */
bool occlusion_is_near(const struct occlusion *occlusion, int i);

/* Whether a triangle lies between point i at a and point j at b. Symmetric in (i, j). */
bool occlusion_blocks(const struct occlusion *occlusion, int i, const double *a, int j,
                      const double *b);
/* The same between any two places, without clearances. A triangle whose plane is closer to `to`
 * than `touch`, m, does not count, unless it is of a sheet. */
bool occlusion_separates(const struct occlusion *occlusion, const double *from, const double *to,
                         double touch);

#endif
