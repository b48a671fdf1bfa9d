/* What `projdyn run` prints while it runs and at its end. */
#include "run_progress.h"

#include <math.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <unistd.h>

void run_totals_add(struct run_totals *t, const pdyn_step_info *info) {
    t->steps++;
    t->density_error_sum += info->density_error_mean;
    t->has_fluid |= info->particles > 0;
    t->density_error_max = fmax(t->density_error_max, info->density_error_mean);
}

/* What tells most about the last step: the density error of a fluid, called `density`, or the step
 * residual. */
static const char *accuracy(const pdyn_step_info *info, const struct run_totals *t,
                            const char *density, char text[64]) {
    if (t->has_fluid) snprintf(text, 64, "%s %.4f%%", density, 100.0 * info->density_error_mean);
    else snprintf(text, 64, "residual %.2g", info->step_residual);
    return text;
}

static int terminal_columns(void) {
    struct winsize size;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/* Redraws the progress line of a terminal, at most ten times per second. The line is cut to the
 * width of the terminal, because a wrapped line cannot be erased. */
static void show_bar(const pdyn_step_info *info, struct run_totals *t) {
    double time = wall_seconds(), part = fmin(1.0, info->time / t->end);
    if (time - t->progress_s < 0.1) return;
    t->progress_s = time;
    int filled = (int)(10.0 * part);
    double ms = 1e3 * (time - t->start_s) / (double)t->steps;
    char line[256], text[64];
    snprintf(line, sizeof line, "[%.*s%.*s] %.0f%% %.3f/%g s, ETA %s, %s, %d outer, %.*f ms/step",
             filled, "##########", 10 - filled, "..........", 100.0 * part, info->time, t->end,
             rounded_time(ceil((time - t->start_s) * (1.0 / part - 1.0))).text,
             accuracy(info, t, "density", text), info->outer_iterations, ms < 10.0 ? 2 : ms < 100.0,
             ms);
    clear_progress();
    fprintf(stderr, "%.*s", terminal_columns() - 1, line);
}

void run_show_progress(const pdyn_step_info *info, struct run_totals *t) {
    char text[64];
    if (isatty(STDERR_FILENO)) show_bar(info, t);
    else if (info->frame)
        fprintf(stderr,
                "%.4f s of %g s, %.1f s of wall time, %s, %d outer iterations, "
                "%d linear iterations\n",
                info->time, t->end, wall_seconds() - t->start_s,
                accuracy(info, t, "density error", text), info->outer_iterations,
                info->linear_iterations);
}

static void print_warning(const pdyn_warning *w, const char *prefix, FILE *to) {
    fprintf(to, "%swarning: %s%s%s", prefix, w->subject, *w->subject ? ": " : "", w->text);
    if (w->last > w->first) fprintf(to, ", from %.4g to %.4g s", w->first, w->last);
    else if (w->last > 0.0) fprintf(to, ", at %.4g s", w->last);
    fprintf(to, " [%s]\n", w->code);
}

void run_print_grown_warnings(const pdyn_sim *sim) {
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++)
        if (w.last > w.first) print_warning(&w, "projdyn: ", stderr);
}

void run_print_summary(const pdyn_sim *sim, const char *output, const struct run_totals *t) {
    double wall = wall_seconds() - t->start_s;
    printf("%ld step%s to %g s in %.1f s, %.1f ms per step, integrator %s, solver %s, %s step\n",
           t->steps, t->steps == 1 ? "" : "s", pdyn_time(sim), wall,
           t->steps ? 1e3 * wall / (double)t->steps : 0.0, pdyn_integrator(sim),
           pdyn_solver_type(sim), pdyn_step_type(sim));
    if (t->has_fluid)
        printf("density error %.4f%% (mean over all steps), %.4f%% (largest mean of a step)\n",
               t->steps ? 100.0 * t->density_error_sum / (double)t->steps : 0.0,
               100.0 * t->density_error_max);
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++) print_warning(&w, "", stdout);
    if (pdyn_get_warning(sim, 0).code)
        puts("docs/guide/troubleshooting.md explains warnings by their codes");
    printf("written to %s; next: projdyn replay %s\n", output, shell_word(output).text);
}
