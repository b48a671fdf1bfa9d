/* The statistics of a run over its steps, for its report. */
#include "base/clock.h"
#include "output.h"
#include "sim/measure.h"

#include <math.h>
#include <string.h>

static const struct report_stats empty_stats = {.min = INFINITY, .max = -INFINITY};

static void add_sample(struct report_stats *stats, double number) {
    stats->sum += number;
    stats->min = fmin(stats->min, number);
    stats->max = fmax(stats->max, number);
}

/* Begins with the energies of the initial state. Before the first step there is no constraint
 * energy and no pin reaction. */
pdyn_status report_open(struct report *report, pdyn_sim *sim) {
    *report = (struct report){.opened_ms = clock_ms()};
    report->residual = NEW_ARRAY(sim->context, sim->bodies, struct report_stats);
    if (!report->residual) return PDYN_NO_MEMORY;
    for (int k = 0; k < STEP_COLUMNS; k++) report->stats[k] = empty_stats;
    for (int b = 0; b < sim->bodies; b++) report->residual[b] = empty_stats;
    report->start.time = pdyn_time(sim);
    measure_step(sim, &report->start);
    report->end = report->start;
    return PDYN_OK;
}

void report_close(struct report *report, const pdyn_sim *sim) {
    FREE_ARRAY(sim->context, report->residual, sim->bodies);
}

void step_numbers(const pdyn_step_info *info, double number[STEP_COLUMNS]) {
#define STEP_NUMBER(column, member) (double)info->member,
    const double numbers[] = {STEP_NUMBERS(STEP_NUMBER)};
#undef STEP_NUMBER
    memcpy(number, numbers, sizeof numbers);
}

void report_step(struct report *report, const pdyn_sim *sim, const pdyn_step_info *info) {
    double number[STEP_COLUMNS];
    step_numbers(info, number);
    for (int k = 0; k < STEP_COLUMNS; k++) add_sample(&report->stats[k], number[k]);
    for (int b = 0; b < sim->bodies; b++)
        add_sample(&report->residual[b], sim->objective.body[b].residual);
    report->unsolved += info->step_residual > sim->scene.settings.tolerance;
    report->end = *info;
    report->steps++;
}
