/* What programs that measure share. */
#ifndef BENCH_H
#define BENCH_H

#include "projdyn/projdyn.h"

#include <stdio.h>

static const double g = 9.81; /* m/s^2 */

/* Ends the program with a message. */
void die(const char *format, ...) PDYN_PRINTF(1, 2);

/* A step, which has to succeed. */
pdyn_step_info take_step(pdyn_context *context, pdyn_sim *sim);

/* DIRECTORY/NAME.csv, to be written. */
FILE *open_csv(const char *directory, const char *name);

#endif
