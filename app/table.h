/* What the runs of a sweep have given, in one file: OUTPUT/sweep.csv, a row for each. */
#ifndef TABLE_H
#define TABLE_H

#include "choices.h"
#include "farm.h"

/* EXIT_GOOD: all runs are there and good; EXIT_FAILED with a message otherwise. */
int table_write(const struct farm *farm, const struct choices *choices);

#endif
