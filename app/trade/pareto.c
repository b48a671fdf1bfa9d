/* Pareto front of error and processor time: dominance, printed table, trade.csv, plots. */
#include "pareto.h"
#include "app.h"
#include "csv.h"
#include "new_file.h"

#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>

extern char **environ;

/* ---- dominance ------------------------------------------------------------------------------- */

/* Whether a dominates b: at least as good in both, better in one. Of two equal trials the first
 * one dominates. */
static bool dominates(const struct trial *a, const struct trial *b, int metric) {
    return trial_is_usable(a, metric) && a->ms <= b->ms && a->error[metric] <= b->error[metric] &&
           (a->ms < b->ms || a->error[metric] < b->error[metric] || a < b);
}

void pareto_mark(struct trial_table *table) {
    for (int k = 0; k < table->count; k++) {
        struct trial *t = &table->trial[k];
        t->pareto = trial_is_usable(t, table->metric);
        for (int j = 0; j < table->count; j++)
            if (j != k && dominates(&table->trial[j], t, table->metric)) t->pareto = false;
    }
}

/* ---- printing -------------------------------------------------------------------------------- */

static int compare_times(const void *a, const void *b) {
    const struct trial *x = *(const struct trial *const *)a, *y = *(const struct trial *const *)b;
    return (x->ms > y->ms) - (x->ms < y->ms);
}

/* Trials that succeeded, fastest first, then NULL; the caller frees the array. NULL if memory
 * ran out. */
static const struct trial **sort_by_time(const struct trial_table *table) {
    const struct trial **sorted = calloc((size_t)table->count + 1, sizeof *sorted);
    size_t count = 0;
    for (int k = 0; sorted && k < table->count; k++)
        if (table->trial[k].good) sorted[count++] = &table->trial[k];
    if (sorted) qsort(sorted, count, sizeof *sorted, compare_times);
    return sorted;
}

static void print_row(const struct trial_table *table, const struct trial *t, FILE *file) {
    fprintf(file, "%10.4g %10.4g", t->ms, 1e-3 * t->ms * table->frames_per_second);
    fprintf(file, " %9.4f%c", 100.0 * t->error[table->metric],
            t->error[table->metric] < 2.0 * table->reference_error[table->metric] ? '~' : ' ');
    for (int m = 0; m < RUN_METRICS_COUNT; m++) fprintf(file, " %8.4f", 100.0 * t->error[m]);
    fprintf(file, "  %s%s\n", t->setting->name, t->pareto ? "" : " (not on the front)");
}

void pareto_print(const struct trial_table *table, FILE *file) {
    const struct trial **sorted = sort_by_time(table);
    fprintf(file, "\nms/frame   s per s     error %%");
    for (int m = 0; m < RUN_METRICS_COUNT; m++) fprintf(file, " %8s", run_metric_names[m]);
    fprintf(file, "  settings\n");
    for (int k = 0; sorted && sorted[k]; k++)
        if (sorted[k]->pareto || sorted[k] == table->trial) print_row(table, sorted[k], file);
    fprintf(file, "Estimated error of the reference (%s), in %%:", table->reference);
    for (int m = 0; m < RUN_METRICS_COUNT; m++)
        fprintf(file, " %s %.4f%s", run_metric_names[m], 100.0 * table->reference_error[m],
                m + 1 < RUN_METRICS_COUNT ? "," : "; ~: error below twice this\n");
    free(sorted);
}

/* ---- writing --------------------------------------------------------------------------------- */

/* A CSV cell with the overrides of a setting, separated by spaces. */
static void put_settings(const struct setting *setting, FILE *file) {
    char *text;
    size_t size;
    FILE *all = open_memstream(&text, &size);
    if (!all) return;
    for (int k = 0; k < setting->sets; k++) fprintf(all, "%s%s", k ? " " : "", setting->set[k]);
    if (!fclose(all)) csv_write_text(file, text);
    free(text);
}

/* A trial as a row of trade.csv; the columns are those of write_table(). */
static void put_row(const struct trial_table *table, const struct trial *t, FILE *file) {
    fprintf(file, "%.9g,%.9g,%.9g", t->ms, 1e-3 * t->ms * table->frames_per_second,
            t->error[table->metric]);
    for (int m = 0; m < RUN_METRICS_COUNT; m++) fprintf(file, ",%.9g", t->error[m]);
    fprintf(file, ",%.9g,%d,", t->residual, t->pareto);
    csv_write_text(file, t->setting->name);
    fputc(',', file);
    put_settings(t->setting, file);
    fputc('\n', file);
}

static int write_table(const struct trial_table *table, const char *path) {
    const struct trial **sorted = sort_by_time(table);
    char *temporary;
    FILE *file = sorted ? new_file_open(path, &temporary) : NULL;
    if (!file) return free(sorted), report_write_error(path);
    fprintf(file, "ms_per_frame,s_per_s,error");
    for (int m = 0; m < RUN_METRICS_COUNT; m++) fprintf(file, ",%s", run_metric_names[m]);
    fprintf(file, ",step_residual,on_front,name,settings\n");
    for (int k = 0; sorted[k]; k++) put_row(table, sorted[k], file);
    free(sorted);
    return new_file_close(file, temporary, path, true) ? EXIT_GOOD : report_write_error(path);
}

static const char script[] =
    "set datafile separator \",\"\n"
    "set logscale xy\n"
    "set grid lc rgb \"#dddddd\"\n"
    "set xlabel \"processor time per frame, ms\"\n"
    "set ylabel sprintf(\"error (%s), %%\", metric)\n"
    "set key top right\n"
    "do for [k=1:2] {\n"
    "    if (k == 1) { set terminal svg size 720,480 font \"sans-serif,12\" background \"white\" "
    "}\n"
    "    else { set terminal png size 1080,720 }\n"
    "    set output dir.(k == 1 ? \"/trade.svg\" : \"/trade.png\")\n"
    "    plot dir.\"/trade.csv\" using 1:(100*$3) with points pt 7 ps 0.4 lc rgb \"#a0aec0\" title "
    "\"settings\", \\\n"
    "         \"< awk -F, 'NR > 1 && $11 == 1' '\".dir.\"/trade.csv'\" using 1:(100*$3) with "
    "linespoints pt 7 lc rgb \"#2b6cb0\" title \"Pareto front\", \\\n"
    "         100*reference_error lc rgb \"#dd6b20\" dt 2 title \"error of the reference\"\n"
    "}\n";

/* Writes the gnuplot script that draws trade.csv of the same directory. */
static int write_script(const struct trial_table *table, const char *path, const char *directory) {
    char *temporary;
    FILE *file = new_file_open(path, &temporary);
    if (!file) return report_write_error(path);
    fprintf(file, "dir = \"%s\"\nmetric = \"%s\"\nreference_error = %.9g\n%s", directory,
            table->metric == TRIAL_MAX_ERROR ? "maximum" : run_metric_names[table->metric],
            fmax(table->reference_error[table->metric], 1e-12), script);
    return new_file_close(file, temporary, path, true) ? EXIT_GOOD : report_write_error(path);
}

/* Runs gnuplot on a script; false if it is not installed or fails. */
static bool run_gnuplot(char *path) {
    char *argv[] = {"gnuplot", path, NULL};
    pid_t pid;
    int status;
    if (posix_spawnp(&pid, "gnuplot", NULL, NULL, argv, environ)) return false;
    return waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

int pareto_write(const struct trial_table *table, const char *directory) {
    char *csv = NULL, *path = NULL;
    int code = EXIT_FAILED;
    if (asprintf(&csv, "%s/trade.csv", directory) < 0) csv = NULL;
    if (asprintf(&path, "%s/trade.gnuplot", directory) < 0) path = NULL;
    if (csv && path) code = write_table(table, csv);
    if (code == EXIT_GOOD) code = write_script(table, path, directory);
    if (code == EXIT_GOOD)
        printf("Written to %s%s\n", csv,
               run_gnuplot(path) ? ", trade.svg and trade.png in the same directory"
                                 : "; no plots: gnuplot is not installed or failed");
    free(csv), free(path);
    return code;
}
