/* Strips and sheets of cloth for the validations: a mesh, regular or not, its material, and the
 * shape in which it comes to rest. */
#ifndef STRIP_H
#define STRIP_H

#include "projdyn/projdyn.h"

/* In the x-z plane: from x = first on, `along` segments of `segment` each; `across` of the same
 * length along z, symmetric to z = 0. */
struct strip {
    const char *name;    /* of the mesh file */
    int along, across;   /* segments */
    double segment;      /* m */
    double first;        /* m, x of the first row of vertices */
    double random;       /* 0: a grid with alternating diagonals; else inner vertices are off theirs
                            by so many segments, at most 0.2, and diagonals lie at random */
    double area_density; /* kg/m^2 */
    const char *constraints; /* JSON, inside the brackets */
    double h;                /* s, of every step */
    const char *solver;      /* JSON, inside the braces */
    const char *more;        /* JSON, more entries of the scene, each after a comma */
};

/* Writes DIRECTORY/NAME.obj and loads a scene of that sheet alone. */
pdyn_sim *strip_load(pdyn_context *context, const char *directory, const struct strip *strip);

/* Vertices go along z first: vertex j of row i. */
int strip_vertex(const struct strip *strip, int i, int j);

/* Steps until no vertex moves by more than `still` times the segment in a step. */
void strip_settle(pdyn_context *context, pdyn_sim *sim, const struct strip *strip, double still);

/* Mean position of a row, m. */
void strip_row(const pdyn_sim *sim, const struct strip *strip, int i, double mean[3]);

#endif
