/* Strips and sheets of cloth for the validations: a mesh, regular or not, its material, and the
 * shape in which it comes to rest. */
#ifndef STRIP_H
#define STRIP_H

#include "projdyn/projdyn.h"

/* `along` segments, the first of them of `segment`, each next one longer by the factor `growth`;
 * `across` of `segment` along z, symmetric to z = 0. Flat along x, unless `place` puts it
 * elsewhere. */
struct strip {
    const char *name;  /* of the mesh file */
    int along, across; /* segments */
    double segment;    /* m */
    double growth;     /* 1: all segments are alike */
    double random; /* 0: a grid with alternating diagonals; else inner vertices are off theirs by
                      so many segments, at most 0.2, and diagonals lie at random */
    double first;  /* m, x of the first row */
    /* x and y of a vertex at an arc length from the first row, m; NULL: first + arc, 0 */
    void (*place)(const struct strip *strip, double arc, double xy[2]);
    double shape;            /* for `place` */
    double area_density;     /* kg/m^2 */
    const char *constraints; /* JSON, inside the brackets */
    double h;                /* s, of every step */
    double gravity[3];       /* m/s^2 */
    double tolerance;        /* step residual */
    const char *solver;      /* NULL: cholesky */
};

/* Writes DIRECTORY/NAME.obj and loads a scene of that sheet alone. */
pdyn_sim *strip_load(pdyn_context *context, const char *directory, const struct strip *strip);

/* m, of so many segments from the first one on. */
double strip_length(const struct strip *strip, int segments);

/* Vertices go along z first: vertex j of row i. */
int strip_vertex(const struct strip *strip, int i, int j);

/* Steps until no vertex moves by more than `still` times the segment in a step. */
void strip_settle(pdyn_context *context, pdyn_sim *sim, const struct strip *strip, double still);

/* Mean position of a row, m. */
void strip_row(const pdyn_sim *sim, const struct strip *strip, int i, double mean[3]);

#endif
