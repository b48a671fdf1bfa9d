/* Strips and sheets for validations: mesh (regular or irregular), material, and the rest position.
 */
#ifndef STRIP_H
#define STRIP_H

#include "projdyn/projdyn.h"

/* `along` segments; the first has the length `segment`, each further one is longer by `growth`.
 * `across` segments of length `segment` along z, symmetric to z = 0. The strip is flat along x, or
 * lies on the curve `place`. */
struct strip {
    const char *name;  /* name of the mesh file */
    int along, across; /* segments */
    double segment;    /* m */
    double growth;     /* 1: equal segments */
    double random; /* 0: a grid with alternating diagonals; otherwise inner vertices are displaced
                      by up to so many segments (at most 0.2) and diagonals are random */
    double first;  /* x of the first row, m */
    /* x and y of a vertex at an arc length from the first row, m; NULL: first + arc, 0 */
    void (*place)(const struct strip *strip, double arc, double xy[2]);
    double shape;            /* parameter of `place` */
    double area_density;     /* kg/m^2 */
    const char *constraints; /* items of "constraints", JSON */
    double h;                /* fixed step, s */
    double gravity[3];       /* m/s^2 */
    double tolerance;        /* tolerance, step residual */
    const char *solver;      /* NULL: cholesky */
};

/* Writes DIRECTORY/NAME.obj and loads a scene with this strip. */
pdyn_sim *strip_load(pdyn_context *context, const char *directory, const struct strip *strip);

/* Length of the first so many segments, m. */
double strip_length(const struct strip *strip, int segments);

/* Position of vertex j of row i; vertices are numbered along z first. */
int strip_vertex(const struct strip *strip, int i, int j);

/* Takes steps until no vertex moves by more than `still` segments in a step. */
void strip_settle(pdyn_sim *sim, const struct strip *strip, double still);

/* Mean position of a row, m. */
void strip_row(const pdyn_sim *sim, const struct strip *strip, int i, double mean[3]);

#endif
