/* Shared by the measurements of coupled fluid and cloth. */
#ifndef COUPLING_H
#define COUPLING_H

#include "bench.h"

static const double density = 1000.0; /* kg/m^3 */

/* The commands of coupling.c: each writes CSV files into a directory and prints a markdown table.
 */
void momentum(pdyn_context *context, const char *directory, int steps, double seconds);
void basin(pdyn_context *context, const char *directory, double seconds, int count,
           char **spacings);
void lintearia(pdyn_context *context, const char *directory, double seconds, int count,
               char **spacings);
void elastic_gate(pdyn_context *context, const char *directory, int count, char **runs);
void leaks(pdyn_context *context, const char *directory, int count, char **runs);

#endif
