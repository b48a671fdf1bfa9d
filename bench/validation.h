/* Shared by the validations of the fluid: water in the corner of a tank, statistics, results. */
#ifndef VALIDATION_H
#define VALIDATION_H

#include "bench.h"

enum { DENSITY = 1000 }; /* kg/m^3 */

/* A lattice of particles that touches the floor and two walls at the origin, and the opposite walls
 * where the tank has the width of the water. */
struct water {
    double spacing;   /* m, two particle radii */
    int cells[3];     /* particles along x, y, z */
    double tank[3];   /* m; open at the top */
    double speed;     /* initial velocity along x, m/s */
    double viscosity; /* XSPH viscosity */
    double step;      /* fixed step, s */
    bool adaptive;    /* `step` is the maximum; the CFL condition shortens steps */
    bool cut_short;   /* one linear solve of ten iterations per step instead of a converged solve */
    double duration;  /* s */
    const char *integrator; /* NULL: "euler" */
};

void *allocate(size_t count, size_t size); /* zeros */

/* Stiffness at which the density error at the floor is 0.1 %. */
pdyn_sim *water_load(pdyn_context *context, const struct water *water);

void sort(double *values, int count); /* ascending */

/* Least-squares line: number and sums of the points. */
struct fit {
    double n, x, y, xx, xy;
};
void fit_add(struct fit *fit, double x, double y);
double fit_slope(const struct fit *fit);

/* The commands of validation.c: each writes CSV files into a directory and prints a markdown table.
 */
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
