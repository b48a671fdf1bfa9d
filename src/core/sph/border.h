/* Borders of surfaces. Around a border a fluid is on both sides at once: in a strip beside it a
 * surface hides no particles (occlusion.h) and adds less to their density (surface_samples.h). */
#ifndef PDYN_BORDER_H
#define PDYN_BORDER_H

#include "base/context.h"
#include "geometry/mesh.h"
#include "projdyn/module.h"

struct border {
    pdyn_context *context;
    double width;  /* m, of the strip; 0: there is none, and no list */
    int triangles; /* of all bodies that hide, in order */
    int *start;    /* triangles + 1: the first side of each triangle's list; NULL: no lists */
    int sides;     /* of all lists */
    int *end;      /* sides x 2: the ends of a side, particles of the system */
};

/* The number of triangles of a body that hide particles on one side from those on the other. */
static inline int hiding_triangles(const pdyn_body *body) {
    return body->permeability > 0.0 ? 0 : body->triangles;
}

struct border_wall { /* a surface that nothing goes around, as it starts */
    const struct mesh *mesh;
    int body; /* index; -1: a solid */
};

struct border_def { /* what borders are made from */
    int bodies;
    const pdyn_body *body;
    const double *rest; /* of the system, m */
    int walls;
    const struct border_wall *wall;
    double width; /* of the strip, m */
};

/* Lists, for each triangle, the sides of its body's border whose strip it meets at rest, but for
 * the sides that a wall closes: one that is within half of the strip's width of a place as far
 * beyond the middle of the side. *out must be 0; after a failure it is to be freed, too. */
pdyn_status border_create(pdyn_context *context, const struct border_def *def, struct border *out);
void border_free(struct border *border);

/* Whether the triangle has sides in its list. */
static inline bool border_is_near(const struct border *border, int triangle) {
    return border->start && border->start[triangle + 1] > border->start[triangle];
}

/* Distance of `at`, a point of the triangle, to the border, m, at most the width of the strip,
 * which there is. x: positions of the system, m. */
double border_distance(const struct border *border, int triangle, const double *x,
                       const double at[3]);

#endif
