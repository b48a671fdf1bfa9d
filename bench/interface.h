/* What the measurements of the interface between water and what it touches share. A scene is a JSON
 * text in which ' stands for "; body 0 is the water, body 1 what is in it. Lengths are in m, and d
 * is the particle spacing (two radii) everywhere. */
#ifndef INTERFACE_H
#define INTERFACE_H

#include "bench.h"

static const double density = 1000.0; /* kg/m^3, of water */

enum { SETS = 32 };

/* A command: where its files go, what every scene is changed by, its arguments. */
struct job {
    pdyn_context *context;
    const char *directory;
    const char *set[SETS]; /* "path=value" */
    int sets;
    double tolerance; /* of the solver: a step above it is unsolved */
    int count;
    char **argument;
};

double job_number(const struct job *job, int argument, double otherwise);

/* DIRECTORY/NAME, to be written; `path` gets 4096 bytes. */
FILE *job_file(const struct job *job, const char *name, char *path);

/* XSPH's, for water that is to come to rest, and the default. */
static const double calming = 0.2, plain = 0.02;
/* Steps of at most 5 ms or a radius, as the shipped scenes with water and cloth have. */
static const char ordinary[] = "'maximum': 0.005, 'cfl': 1";

/* ---- scenes ---------------------------------------------------------------------------------- */

struct scene {
    char text[262144];
    size_t length;
};

void scene_put(struct scene *s, const char *format, ...) PDYN_PRINTF(2, 3);
/* JSON of time_step, contact of a thickness in m (0: none); up to the bodies. */
void scene_start(struct scene *s, const char *time_step, double contact);
/* Water of spacing d and XSPH's viscosity, so stiff that it is 0.1 % too dense under `depth`;
 * `fill` is the JSON of one entry of `fill`. */
void scene_water(struct scene *s, double d, double depth, double viscosity, const char *fill, ...)
    PDYN_PRINTF(5, 6);
/* A surface that is to follow the water. Ends before its constraints. */
void scene_sheet(struct scene *s, const char *mesh, double area_density);
/* A tank open at the top with a corner at the origin, and an outlet for what leaves it; ends the
 * scene. */
void scene_tank(struct scene *s, double x, double y, double z);
pdyn_sim *scene_load(const struct job *job, const struct scene *s);

/* ---- files for scenes ------------------------------------------------------------------------ */

/* Particles on the lattice of a box with a corner at the origin, those that `keep` wants (NULL:
 * all) where it moves them to; as PLY. Returns their number. */
int lattice_write(FILE *file, double d, const int cells[3],
                  bool (*keep)(const void *user, double x[3]), const void *user);

/* These particles as PLY. */
void particles_write(FILE *file, int count, const double *x);

/* A rectangle of along x across cells, bent to `place` of its two parameters from 0 to 1; as OBJ.
 */
void sheet_write(FILE *file, int along, int across,
                 void (*place)(const void *user, double s, double t, double x[3]),
                 const void *user);

/* A ball of radius 1 of n x n x n cells, n even, in six tetrahedra each: DIRECTORY/NAME.node, whose
 * path is written to `path` (4096 bytes), and NAME.ele. */
void ball_write(const struct job *job, const char *name, int n, char *path);

/* ---- measures -------------------------------------------------------------------------------- */

/* Weights, weighted sums. */
struct sample {
    double n, sum, squares;
};
void sample_add(struct sample *s, double weight, double value);
double sample_mean(const struct sample *s);
double sample_deviation(const struct sample *s); /* standard deviation */

/* Of a body: weight in N, area of its triangles in m^2, mean position of its points in m. */
double body_weight(const pdyn_sim *sim, int body);
double body_area(const pdyn_sim *sim, int body);
void body_middle(const pdyn_sim *sim, int body, double x[3]);

/* Volume inside a closed surface, m^3. */
double body_volume(const pdyn_sim *sim, int body);

/* The share of a solid's volume that is below a level. */
double body_submerged(const pdyn_sim *sim, int body, double level);

/* The points of a body that are lowest and highest when it is made. */
struct ends {
    int *low, *high; /* points of the state */
    int lows, highs;
};
void ends_find(struct ends *ends, const pdyn_sim *sim, int body);
/* The middles of these points now. */
void body_ends(const pdyn_sim *sim, const struct ends *ends, double low[3], double high[3]);
void ends_free(struct ends *ends);

/* Height of the water's surface, m: `low` and the volume of the particles above `low` over the
 * area of a frame, which is what is within `outer` but not within `inner` of the middle (in x and
 * z, half widths; inner < 0: all). A particle counts as a cube with the edges d. */
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
