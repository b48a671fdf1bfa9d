/* Shared by the measurements of the interface between water and sheets or solids. A scene is JSON
 * text with ' for "; body 0 is the water, body 1 the other body. Lengths in m; d: particle spacing,
 * two radii. */
#ifndef INTERFACE_H
#define INTERFACE_H

#include "bench.h"

static const double density = 1000.0; /* kg/m^3, of water */

enum { SETS = 32 };

/* Arguments of a command: output folder, changes of every scene, positional arguments. */
struct job {
    pdyn_context *context;
    const char *directory;
    const char *set[SETS]; /* "path=value" */
    int sets;
    double tolerance; /* tolerance of the solver: a step with a larger residual is unsolved */
    int count;
    char **argument;
};

double job_number(const struct job *job, int argument, double otherwise);

/* Opens DIRECTORY/NAME for writing; path: 4096 bytes. */
FILE *job_file(const struct job *job, const char *name, char *path);

/* XSPH viscosity: for water that should come to rest; the default */
static const double calming = 0.2, plain = 0.02;
/* Steps of at most 5 ms, and of at most one radius of motion, as in the shipped scenes of water and
 * cloth. */
static const char ordinary[] = "'maximum': 0.005, 'cfl': 1";

/* ---- scenes ---------------------------------------------------------------------------------- */

struct scene {
    char text[262144];
    size_t length;
};

void scene_put(struct scene *s, const char *format, ...) PDYN_PRINTF(2, 3);
/* Writes the scene up to the bodies: time_step, contact of a thickness in m (0: none). */
void scene_start(struct scene *s, const char *time_step, double contact);
/* Writes the water: spacing d, XSPH viscosity, the stiffness for a density error of 0.1 % at
 * `depth`; fill: JSON of one entry of "fill". */
void scene_water(struct scene *s, double d, double depth, double viscosity, const char *fill, ...)
    PDYN_PRINTF(5, 6);
/* Writes a surface after the water, up to its constraints. */
void scene_sheet(struct scene *s, const char *mesh, double area_density);
void scene_permeable(struct scene *s, const char *mesh, double area_density, double permeability);
/* Writes an open tank with a corner at the origin, and an outlet for what leaves it; ends the
 * scene. */
void scene_tank(struct scene *s, double x, double y, double z);
pdyn_sim *scene_load(const struct job *job, const struct scene *s);

/* ---- files for scenes ------------------------------------------------------------------------ */

/* Writes PLY of particles on a lattice that fills a box with a corner at the origin: those that
 * `keep` accepts (NULL: all), at the positions it gives. Returns their number. */
int lattice_write(FILE *file, double d, const int cells[3],
                  bool (*keep)(const void *user, double x[3]), const void *user);

/* Writes PLY of these particles. */
void particles_write(FILE *file, int count, const double *x);

/* Writes OBJ of a rectangle of along x across cells, mapped by `place` from two parameters in [0,
 * 1]. */
void sheet_write(FILE *file, int along, int across,
                 void (*place)(const void *user, double s, double t, double x[3]),
                 const void *user);

/* Writes OBJ of a sphere about the origin: the surface of a cube of n x n x n cells, projected;
 * 6 n^2 + 2 vertices, triangles face outward. Closes the file. */
void sphere_write(FILE *file, int n, double radius);

/* Writes a ball of radius 1 of n x n x n cells, n even, six tetrahedra each: DIRECTORY/NAME.node
 * (its path: 4096 bytes) and NAME.ele. */
void ball_write(const struct job *job, const char *name, int n, char *path);

/* ---- measures -------------------------------------------------------------------------------- */

/* Weighted mean: sums of weights and weighted values. */
struct sample {
    double n, sum, squares;
};
void sample_add(struct sample *s, double weight, double value);
double sample_mean(const struct sample *s);
double sample_deviation(const struct sample *s); /* standard deviation */

/* Weight, N; triangle area, m^2; mean position of the points, m. */
double body_weight(const pdyn_sim *sim, int body);
double body_area(const pdyn_sim *sim, int body);
void body_middle(const pdyn_sim *sim, int body, double x[3]);

/* Volume inside a closed surface, m^3. */
double body_volume(const pdyn_sim *sim, int body);

/* Fraction of a solid's volume below a level. */
double body_submerged(const pdyn_sim *sim, int body, double level);

/* Lowest and highest points of a body in its initial position. */
struct ends {
    int *low, *high; /* indices of points in the state */
    int lows, highs;
};
void ends_find(struct ends *ends, const pdyn_sim *sim, int body);
/* Current centres of these points, m. */
void body_ends(const pdyn_sim *sim, const struct ends *ends, double low[3], double high[3]);
void ends_free(struct ends *ends);

/* Height of the water's surface, m: `low` plus the particles' volume above `low` over the area of a
 * frame: within `outer` but not within `inner` of the middle (half widths in x and z; inner < 0:
 * none excluded). A particle counts as a cube of edge d. */
struct frame {
    double middle[2], outer[2], inner[2], low;
};
double surface_height(const pdyn_sim *sim, const struct frame *f);

/* Linear least squares, y = sum over k < terms of c_k x_k. */
enum { TERMS = 4 };
struct regression {
    int terms;
    double matrix[TERMS][TERMS], right[TERMS];
};
void regression_add(struct regression *r, double weight, const double x[], double y);
void regression_solve(struct regression *r, double c[]);

/* ---- commands -------------------------------------------------------------------------------- */

void displaced(const struct job *job);
void floating(const struct job *job);
void tank(const struct job *job);
void stream(const struct job *job);
void added_mass(const struct job *job);
void bag(const struct job *job);
void dropped(const struct job *job);
void plate(const struct job *job);
void free_sheets(const struct job *job);

#endif
