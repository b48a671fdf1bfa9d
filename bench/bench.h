/* Shared by all measuring programs. */
#ifndef BENCH_H
#define BENCH_H

#include "projdyn/projdyn.h"

#include <stdio.h>

static const double g = 9.81; /* m/s^2 */

/* Prints a message and ends the program. */
_Noreturn void die(const char *format, ...) PDYN_PRINTF(1, 2);

/* The context of a program; 0 threads: one per core. A failure ends the program, here and below. */
pdyn_context *make_context(int threads);

/* Loads a scene from a printf format with ' for ". */
pdyn_sim *load_text(pdyn_context *context, const char *format, ...) PDYN_PRINTF(2, 3);

/* Takes a step. */
pdyn_step_info take_step(pdyn_sim *sim);

struct momenta {
    double linear[3], angular[3]; /* kg m/s, kg m^2/s about the origin */
    double size, moment;          /* sums of m |v| and m |x x v| */
};
struct momenta momenta_of(const pdyn_sim *sim);

/* Opens DIRECTORY/NAME.csv for writing. */
FILE *open_csv(const char *directory, const char *name);

/* Writes the triangles of a sheet as OBJ: along + 1 rows of across + 1 vertices, diagonals in turn
 * in both directions. */
void write_triangles(FILE *file, int along, int across);

#endif
