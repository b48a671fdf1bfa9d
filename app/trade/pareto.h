/* Pareto front of trials in error and processor time: marking, printing, writing. */
#ifndef PARETO_H
#define PARETO_H

#include "trials.h"

#include <stdio.h>

/* Sets trial->pareto of all trials. */
void pareto_mark(struct trial_table *table);
/* Prints the front and the first trial, which is the scene itself, fastest trial first. */
void pareto_print(const struct trial_table *table, FILE *file);
/* Writes all trials to DIRECTORY/trade.csv, a plot script to DIRECTORY/trade.gnuplot and, if
 * gnuplot is installed, its output trade.svg and trade.png. Returns an exit code. */
int pareto_write(const struct trial_table *table, const char *directory);

#endif
