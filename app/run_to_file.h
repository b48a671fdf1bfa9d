/* Commands that make one file of a run: `usd`, `replay`. */
#ifndef RUN_TO_FILE_H
#define RUN_TO_FILE_H

#include "run_directory.h"

/* The command `projdyn NAME DIR [-o FILE]` (argv[0]: NAME), whose `write` opens the run and writes
 * FILE; by default DIR/`file`. */
int run_to_file(int argc, char **argv, const char *usage, const char *file,
                int (*write)(struct run *run, const char *output));

#endif
