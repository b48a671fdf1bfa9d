/* What `projdyn run` prints while it runs and at its end. */
#ifndef RUN_PROGRESS_H
#define RUN_PROGRESS_H

#include "app.h"

struct run_totals {
    double start_s, progress_s; /* wall-clock times of the start and of the last progress line */
    double end;                 /* s of simulated time, at which the run ends */
    long steps, frames;
    /* Mean density error of each step: sum over the steps, and maximum. */
    double density_error_sum, density_error_max;
    bool has_fluid; /* there was a particle */
};

/* Adds a step. */
void run_totals_add(struct run_totals *totals, const pdyn_step_info *info);

/* Shows the progress after a step: a bar on a terminal, otherwise one line per frame. */
void run_show_progress(const pdyn_step_info *info, struct run_totals *totals);

/* Prints the warnings that have grown since they were printed first, in their last form, to
 * stderr. */
void run_print_grown_warnings(const pdyn_sim *sim);

/* Prints a summary of the run in the directory `output`, and its warnings. */
void run_print_summary(const pdyn_sim *sim, const char *output, const struct run_totals *totals);

#endif
