/* The front of what was tried: printed, written, drawn. */
#include "app.h"
#include "csv.h"
#include "trade.h"

#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* ---- finding --------------------------------------------------------------------------------- */

static bool beats(const struct tried *a, const struct tried *b, int by) {
    return tried_counts(a, by) && a->ms <= b->ms && a->error[by] <= b->error[by] &&
           (a->ms < b->ms || a->error[by] < b->error[by] || a < b);
}

void front_find(struct trade *trade) {
    for (int k = 0; k < trade->count; k++) {
        struct tried *t = &trade->tried[k];
        t->front = tried_counts(t, trade->by);
        for (int j = 0; j < trade->count; j++)
            if (j != k && beats(&trade->tried[j], t, trade->by)) t->front = false;
    }
}

/* ---- printing -------------------------------------------------------------------------------- */

static int by_time(const void *a, const void *b) {
    const struct tried *x = *(const struct tried *const *)a, *y = *(const struct tried *const *)b;
    return (x->ms > y->ms) - (x->ms < y->ms);
}

/* What ended well, by time; trade->count pointers, the last of them NULL. NULL without memory. */
static const struct tried **sort(const struct trade *trade) {
    const struct tried **sorted = calloc((size_t)trade->count + 1, sizeof *sorted);
    size_t count = 0;
    for (int k = 0; sorted && k < trade->count; k++)
        if (trade->tried[k].good) sorted[count++] = &trade->tried[k];
    if (sorted) qsort(sorted, count, sizeof *sorted, by_time);
    return sorted;
}

static void print_row(const struct trade *trade, const struct tried *t, FILE *file) {
    fprintf(file, "%10.4g %10.4g", t->ms, 1e-3 * t->ms * trade->per_second);
    fprintf(file, " %9.4f%c", 100.0 * t->error[trade->by],
            t->error[trade->by] < 2.0 * trade->unsure[trade->by] ? '~' : ' ');
    for (int m = 0; m < TRACK_MEASURES; m++) fprintf(file, " %8.4f", 100.0 * t->error[m]);
    fprintf(file, "  %s\n", t->setting->name);
}

void front_print(const struct trade *trade, FILE *file) {
    const struct tried **sorted = sort(trade);
    fprintf(file, "\nms/frame   s per s     error %%");
    for (int m = 0; m < TRACK_MEASURES; m++) fprintf(file, " %8s", track_names[m]);
    fprintf(file, "  settings\n");
    for (int k = 0; sorted && sorted[k]; k++)
        if (sorted[k]->front) print_row(trade, sorted[k], file);
    fprintf(file, "The reference itself (%s), in %%:", trade->reference);
    for (int m = 0; m < TRACK_MEASURES; m++)
        fprintf(file, " %s %.4f%s", track_names[m], 100.0 * trade->unsure[m],
                m + 1 < TRACK_MEASURES ? "," : "; ~: below twice that\n");
    free(sorted);
}

/* ---- writing --------------------------------------------------------------------------------- */

/* The overrides of a setting, one after the other. */
static void put_settings(const struct setting *setting, FILE *file) {
    char *text;
    size_t size;
    FILE *all = open_memstream(&text, &size);
    if (!all) return;
    for (int k = 0; k < setting->sets; k++) fprintf(all, "%s%s", k ? " " : "", setting->set[k]);
    if (!fclose(all)) csv_text(file, text);
    free(text);
}

static void put_row(const struct trade *trade, const struct tried *t, FILE *file) {
    fprintf(file, "%.9g,%.9g,%.9g", t->ms, 1e-3 * t->ms * trade->per_second, t->error[trade->by]);
    for (int m = 0; m < TRACK_MEASURES; m++) fprintf(file, ",%.9g", t->error[m]);
    fprintf(file, ",%.9g,%d,", t->residual, t->front);
    csv_text(file, t->setting->name);
    fputc(',', file);
    put_settings(t->setting, file);
    fputc('\n', file);
}

static int write_table(const struct trade *trade, const char *path) {
    const struct tried **sorted = sort(trade);
    FILE *file = fopen(path, "we");
    if (!file || !sorted) return free(sorted), report_unwritten(path);
    fprintf(file, "ms_per_frame,s_per_s,error");
    for (int m = 0; m < TRACK_MEASURES; m++) fprintf(file, ",%s", track_names[m]);
    fprintf(file, ",step_residual,on_front,name,settings\n");
    for (int k = 0; sorted[k]; k++) put_row(trade, sorted[k], file);
    free(sorted);
    bool bad = ferror(file);
    return fclose(file) || bad ? report_unwritten(path) : EXIT_GOOD;
}

static const char script[] =
    "set datafile separator \",\"\n"
    "set logscale xy\n"
    "set grid lc rgb \"#dddddd\"\n"
    "set xlabel \"ms of one processor, for a frame\"\n"
    "set ylabel sprintf(\"error (%s), %%\", by)\n"
    "set key top right\n"
    "do for [k=1:2] {\n"
    "    if (k == 1) { set terminal svg size 720,480 font \"sans-serif,12\" background \"white\" "
    "}\n"
    "    else { set terminal png size 1080,720 }\n"
    "    set output dir.(k == 1 ? \"/trade.svg\" : \"/trade.png\")\n"
    "    plot dir.\"/trade.csv\" using 1:(100*$3) with points pt 7 ps 0.4 lc rgb \"#a0aec0\" title "
    "\"tried\", \\\n"
    "         \"< awk -F, 'NR > 1 && $11 == 1' '\".dir.\"/trade.csv'\" using 1:(100*$3) with "
    "linespoints pt 7 lc rgb \"#2b6cb0\" title \"front\", \\\n"
    "         100*unsure lc rgb \"#dd6b20\" dt 2 title \"error of the reference\"\n"
    "}\n";

/* DIRECTORY/trade.gnuplot, which draws again what it stands beside. */
static int write_script(const struct trade *trade, const char *path, const char *directory) {
    FILE *file = fopen(path, "we");
    if (!file) return report_unwritten(path);
    fprintf(file, "dir = \"%s\"\nby = \"%s\"\nunsure = %.9g\n%s", directory,
            trade->by == TRADE_WORST ? "the largest" : track_names[trade->by],
            fmax(trade->unsure[trade->by], 1e-12), script);
    return fclose(file) ? report_unwritten(path) : EXIT_GOOD;
}

static bool draw(char *path) {
    char *argv[] = {"gnuplot", path, NULL};
    pid_t pid;
    int status;
    if (posix_spawnp(&pid, "gnuplot", NULL, NULL, argv, environ)) return false;
    return waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

int front_write(const struct trade *trade, const char *directory) {
    char *table = NULL, *path = NULL;
    int code = EXIT_FAILED;
    if (asprintf(&table, "%s/trade.csv", directory) < 0) table = NULL;
    if (asprintf(&path, "%s/trade.gnuplot", directory) < 0) path = NULL;
    if (table && path) code = write_table(trade, table);
    if (code == EXIT_GOOD) code = write_script(trade, path, directory);
    if (code == EXIT_GOOD)
        printf("Written to %s%s\n", table,
               draw(path) ? ", trade.svg and trade.png beside it" : "; no gnuplot, so no picture");
    free(table), free(path);
    return code;
}
