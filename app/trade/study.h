/* Study: all runs of `projdyn trade` and their evaluation. It runs the scope of a scene with
 * every setting of a plan and measures the errors against a reference run. */
#ifndef STUDY_H
#define STUDY_H

#include "jobs.h"
#include "plan.h"
#include "scope.h"
#include "trials.h"

struct study {
    struct jobs jobs;    /* scene of the user, output directory, processes */
    double length;       /* length of the time window, s; 0: to be chosen */
    double run_budget_s; /* processor time that one run may take, s */
    struct scope scope;
    struct plan scene_plan; /* settings in terms of the scene, for tables and recommendations */
    struct plan run_plan;   /* the same settings in terms of the scope, for the runs */
    /* Jobs of the references, coarsest first, followed by the jobs of the settings. Errors are
     * measured against the last reference; the one before it estimates its error. */
    struct job *reference_job;
    int references;
    struct job *setting_job; /* reference_job + references; NULL until the references are run */
    struct trial_table table;
};

/* Chooses the scope, runs everything and leaves trials with the Pareto front in study->table.
 * Returns an exit code. The caller calls study_free() in any case. */
int study_run(struct study *study);
void study_free(struct study *study);

#endif
