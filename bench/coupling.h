/* What the measurements of fluid and cloth as one system share. */
#ifndef COUPLING_H
#define COUPLING_H

#include "bench.h"

static const double density = 1000.0; /* kg/m^3 */

/* A scene from a text with ' for ", as printf has it. */
pdyn_sim *load(pdyn_context *context, const char *format, ...) PDYN_PRINTF(2, 3);

/* Each writes CSV files into a directory and prints a table as markdown. */
void momentum(pdyn_context *context, const char *directory, int steps, double seconds);
void basin(pdyn_context *context, const char *directory, double seconds, int count,
           char **spacings);
void lintearia(pdyn_context *context, const char *directory, double seconds, int count,
               char **spacings);
void elastic_gate(pdyn_context *context, const char *directory, int count, char **runs);
void leaks(pdyn_context *context, const char *directory, int count, char **runs);
void ratios(pdyn_context *context, const char *directory, double seconds);
void solvers(pdyn_context *context, const char *directory, int count, char **runs);
void sizes(pdyn_context *context, const char *directory, const char *file, int count, char **runs);

#endif
