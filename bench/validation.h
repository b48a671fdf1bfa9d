/* What the validations share: a block of water in the corner of a tank, order and lines in what is
 * measured, and where results go. */
#ifndef VALIDATION_H
#define VALIDATION_H

#include "bench.h"

enum { DENSITY = 1000 }; /* kg/m^3 */

/* A lattice of particles that touches the floor and the walls at the origin, and the walls across
 * from these where the tank is as wide as the water. */
struct water {
    double spacing;   /* m, two particle radii */
    int cells[3];     /* particles along x, y, z */
    double tank[3];   /* m; open at the top */
    double speed;     /* m/s, along x, at the start */
    double viscosity; /* XSPH */
    double step;      /* s: of every step */
    bool adaptive;    /* `step` is the longest, CFL makes it shorter */
    bool cut_short;   /* one linear solve of ten iterations a step, not as many as it takes */
    double duration;  /* s */
};

void *allocate(size_t count, size_t size); /* zeros */

/* The density constraint is so stiff that the floor is 0.1 % too dense. */
pdyn_sim *water_load(pdyn_context *context, const struct water *water);

void sort(double *values, int count); /* ascending */

/* A line through points by least squares: their number and sums. */
struct fit {
    double n, x, y, xx, xy;
};
void fit_add(struct fit *fit, double x, double y);
double fit_slope(const struct fit *fit);

/* Each writes CSV files into a directory and prints a table as markdown. */
void martin_moyce(pdyn_context *context, const char *directory, int count, char **cells);
void tank(pdyn_context *context, const char *directory, double seconds, int count, char **sizes);
void sloshing(pdyn_context *context, const char *directory, double seconds, int cells);
void catenary(pdyn_context *context, const char *directory, int count, char **segments);
void chain(pdyn_context *context, const char *directory, int segments, int count, char **steps);
void buckling(pdyn_context *context, const char *directory, int count, char **segments);
void stretch(pdyn_context *context, const char *directory, int count, char **segments);
void sheet(pdyn_context *context, const char *directory, int count, char **vertices);
void elastica(pdyn_context *context, const char *directory, int count, char **segments);

#endif
