/* projdyn run: simulates a scene, frame by frame, and writes what comes of it. */
#include "app.h"
#include "record.h"

#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn run SCENE [OPTIONS]\n"
    "       projdyn run --resume DIR [OPTIONS]\n"
    "\n"
    "Simulates a scene and writes frames, metrics.csv and report.json.\n"
    "\n"
    "  -o, --output DIR      where to write (default out/NAME of the scene)\n"
    "      --threads N       worker threads (default: one per core)\n"
    "      --set PATH=VALUE  overrides a value of the scene, e.g. solver.type=cholesky\n"
    "      --plugin FILE     loads a plug-in's constraints and solvers before the scene\n"
    "      --time S          simulates S seconds instead of the scene's duration\n"
    "      --report FILE     writes the report there instead of DIR/report.json\n"
    "      --ply             writes each frame as PLY, too\n"
    "      --no-frames       writes no frames: metrics, report and the last state\n"
    "      --save N          saves the state every N frames (default 10; 0: at the end only)\n"
    "      --resume DIR      goes on with the run in DIR from its saved state, to the same bits;\n"
    "                        with --time S to another end\n"
    "      --quiet           no progress, no summary\n"
    "  -h, --help            this text\n"
    "\n"
    "Ctrl-C ends with the current frame, a second one with the current step.\n";

struct run_options {
    struct scene_options scene;
    const char *output, *report, *resume;
    char *default_output; /* if none was given */
    void *record;         /* of a run that is resumed */
    char duration[64];    /* override made from --time */
    int save;             /* frames */
    bool ply, frameless, quiet;
};

struct totals {
    double begun, shown; /* s, of the clock: the run, the last progress line */
    long steps, frames;
    double density_mean, density_worst; /* sum of the steps' means; the largest of them */
};

static volatile sig_atomic_t interrupts;

static void on_signal(int number) {
    (void)number;
    interrupts++;
}

/* ---- arguments ----------------------------------------------------------------------------------
 */

static bool parse_time(struct run_options *o, const char *text) {
    char *end;
    double seconds = strtod(text, &end);
    if (*end || end == text || !isfinite(seconds) || seconds <= 0.0) {
        fprintf(stderr, "projdyn: --time: found \"%s\", expected seconds above 0\n", text);
        return false;
    }
    snprintf(o->duration, sizeof o->duration, "duration=%.17g", seconds);
    return scene_set(&o->scene, o->duration);
}

static bool parse_save(struct run_options *o, const char *text) {
    char *end;
    long frames = strtol(text, &end, 10);
    if (*end || end == text || frames < 0 || frames > INT_MAX) {
        fprintf(stderr, "projdyn: --save: found \"%s\", expected a number of frames\n", text);
        return false;
    }
    o->save = (int)frames;
    return true;
}

static bool accept_option(struct run_options *o, int option) {
    switch (option) {
    case 'o':
        o->output = optarg;
        return true;
    case 'r':
        o->report = optarg;
        return true;
    case 'p':
        o->ply = true;
        return true;
    case 'n':
        o->frameless = true;
        return true;
    case 'q':
        o->quiet = true;
        return true;
    case 'R':
        o->resume = optarg;
        return true;
    case 'S':
        return parse_save(o, optarg);
    case 't':
        return scene_threads(&o->scene, optarg);
    case 's':
        return scene_set(&o->scene, optarg);
    case 'P':
        return scene_plugin(&o->scene, optarg);
    case 'T':
        return parse_time(o, optarg);
    default:
        return false;
    }
}

/* Scene, overrides and output are those of the run; its end may be another. -1: go on. */
static int choose_resumed(struct run_options *o, int scenes) {
    if (scenes || o->output || o->ply || o->scene.plugins ||
        o->scene.sets > (*o->duration != '\0')) {
        fprintf(
            stderr,
            "projdyn: --resume: scene, --output, --set, --plugin and --ply are those of the run\n");
        return EXIT_BAD_INPUT;
    }
    o->output = o->resume;
    o->scene.sets = 0;
    int code = record_read(o->resume, &o->scene, &o->record);
    if (code != EXIT_GOOD) return code;
    return !*o->duration || scene_set(&o->scene, o->duration) ? -1 : EXIT_FAILED;
}

/* -1: go on; otherwise the exit code. */
static int parse(struct run_options *o, int argc, char **argv) {
    static const struct option long_options[] = {{"output", required_argument, NULL, 'o'},
                                                 {"threads", required_argument, NULL, 't'},
                                                 {"set", required_argument, NULL, 's'},
                                                 {"plugin", required_argument, NULL, 'P'},
                                                 {"time", required_argument, NULL, 'T'},
                                                 {"report", required_argument, NULL, 'r'},
                                                 {"ply", no_argument, NULL, 'p'},
                                                 {"no-frames", no_argument, NULL, 'n'},
                                                 {"quiet", no_argument, NULL, 'q'},
                                                 {"save", required_argument, NULL, 'S'},
                                                 {"resume", required_argument, NULL, 'R'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    int option;
    while ((option = getopt_long(argc, argv, "o:h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (!accept_option(o, option)) return EXIT_BAD_INPUT;
    }
    if (o->resume) return choose_resumed(o, argc - optind);
    if (argc - optind != 1) {
        fprintf(stderr, "projdyn: run: expected one scene file\n\n%s", usage);
        return EXIT_BAD_INPUT;
    }
    if (o->output && !*o->output) {
        fprintf(stderr, "projdyn: --output: found an empty text, expected a directory\n");
        return EXIT_BAD_INPUT;
    }
    o->scene.scene = argv[optind];
    if (!o->output) o->output = o->default_output = default_output("", o->scene.scene);
    return o->output ? -1 : EXIT_FAILED;
}

/* ---- progress -----------------------------------------------------------------------------------
 */

static int terminal_columns(void) {
    struct winsize size;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/* At most ten times a second, and cut to the terminal: a line that wraps cannot be redrawn. */
static void show_bar(const pdyn_sim *sim, const pdyn_step_info *info, struct totals *t) {
    double time = wall_seconds(), part = fmin(1.0, info->time / pdyn_duration(sim));
    if (time - t->shown < 0.1) return;
    t->shown = time;
    int filled = (int)(10.0 * part);
    char line[256];
    snprintf(line, sizeof line,
             "[%.*s%.*s] %.0f%% %.3f/%g s, ETA %.0f s, density %.2f%%, %d outer, %.3g ms/step",
             filled, "##########", 10 - filled, "..........", 100.0 * part, info->time,
             pdyn_duration(sim), (time - t->begun) * (1.0 / part - 1.0),
             100.0 * info->density_error_mean, info->outer_iterations,
             1e3 * (time - t->begun) / (double)t->steps);
    clear_progress();
    fprintf(stderr, "%.*s", terminal_columns() - 1, line);
}

static void show_progress(const pdyn_sim *sim, const pdyn_step_info *info, struct totals *t) {
    if (isatty(STDERR_FILENO)) show_bar(sim, info, t);
    else if (info->frame)
        fprintf(stderr,
                "%.4f s of %g s, %.1f s of wall time, density error %.4f%%, %d outer, %d linear\n",
                info->time, pdyn_duration(sim), wall_seconds() - t->begun,
                100.0 * info->density_error_mean, info->outer_iterations, info->linear_iterations);
}

static void summarise(const pdyn_sim *sim, const char *output, const struct totals *t) {
    double wall = wall_seconds() - t->begun;
    printf("%ld steps to %g s in %.1f s, %.1f ms per step, integrator %s, solver %s, %s step\n",
           t->steps, pdyn_time(sim), wall, t->steps ? 1e3 * wall / (double)t->steps : 0.0,
           pdyn_integrator(sim), pdyn_solver_type(sim), pdyn_step_type(sim));
    printf("density error %.4f%% (mean), %.4f%% (worst step)\n",
           t->steps ? 100.0 * t->density_mean / (double)t->steps : 0.0, 100.0 * t->density_worst);
    printf("written to %s; next: projdyn replay %s\n", output, output);
}

/* ---- the run ------------------------------------------------------------------------------------
 */

/* Frames are worth finishing; whoever asks twice wants the end now. */
static bool stops(bool frame, bool *told) {
    if (interrupts && !frame && !*told) {
        *told = true;
        clear_progress();
        fprintf(stderr, "projdyn: finishing the frame; Ctrl-C again ends with this step\n");
    }
    return interrupts > 1 || (interrupts && frame);
}

/* The first frame is saved, too: from then on a run can be resumed. */
static pdyn_status end_frame(pdyn_writer *writer, const struct run_options *o, struct totals *t) {
    pdyn_status status = o->frameless ? PDYN_OK : pdyn_writer_frame(writer);
    bool due = o->save && t->frames++ % o->save == 0;
    return status == PDYN_OK && due ? pdyn_writer_save(writer) : status;
}

/* Steps and writes until the end, a failure or an interrupt. */
static pdyn_status simulate(pdyn_sim *sim, pdyn_writer *writer, const struct run_options *o,
                            struct totals *t) {
    bool frame = true, told = false;
    pdyn_status status = o->resume ? PDYN_OK : end_frame(writer, o, t);
    while (status == PDYN_OK && pdyn_time(sim) < pdyn_duration(sim) * (1.0 - 1e-9)) {
        if (stops(frame, &told)) break;
        pdyn_step_info info;
        status = pdyn_step(sim, &info);
        if (status == PDYN_OK) status = pdyn_writer_step(writer, &info);
        if (status != PDYN_OK) break;
        t->steps++;
        t->density_mean += info.density_error_mean;
        t->density_worst = fmax(t->density_worst, info.density_error_mean);
        frame = info.frame;
        if (frame) status = end_frame(writer, o, t);
        if (!o->quiet) show_progress(sim, &info, t);
    }
    if (!o->quiet) clear_progress();
    return status;
}

static int run(pdyn_context *context, pdyn_sim *sim, const struct run_options *o) {
    struct totals totals = {.begun = wall_seconds()};
    pdyn_writer *writer = NULL;
    pdyn_status status = o->resume ? pdyn_writer_resume(sim, o->output, &writer)
                                   : pdyn_writer_open(sim, o->output, o->ply, &writer);
    if (status != PDYN_OK) {
        int failed = report_status(context, status);
        return o->resume && status == PDYN_IO_FAILED ? EXIT_BAD_INPUT : failed;
    }
    if (!o->resume && record_write(o->output, &o->scene) != EXIT_GOOD) {
        pdyn_writer_close(writer);
        return EXIT_FAILED;
    }
    status = simulate(sim, writer, o, &totals);
    int code = status == PDYN_OK ? EXIT_GOOD : report_status(context, status);
    char failure[2048]; /* a copy: the report may fail, too */
    snprintf(failure, sizeof failure, "%s", status_message(context, status));
    bool interrupted = interrupts > 0;
    pdyn_status written =
        pdyn_writer_report(writer, o->report, interrupted, status == PDYN_OK ? NULL : failure);
    if (written != PDYN_OK) code = report_status(context, written);
    written = pdyn_writer_save(writer); /* after a failure too: the last good step */
    if (written != PDYN_OK) code = report_status(context, written);
    pdyn_writer_close(writer);
    if (code != EXIT_GOOD) return code;
    if (interrupted)
        fprintf(stderr,
                "projdyn: interrupted at %g s; what was simulated is in %s; to go on: projdyn run "
                "--resume %s\n",
                pdyn_time(sim), o->output, o->output);
    if (!o->quiet) summarise(sim, o->output, &totals);
    return interrupted ? EXIT_INTERRUPTED : EXIT_GOOD;
}

/* Not before the scene is there: until then nothing is written, and Ctrl-C just ends it. */
static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

int run_main(int argc, char **argv) {
    struct run_options o = {.save = 10};
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    int code = parse(&o, argc, argv);
    if (code < 0) {
        code = scene_load(&o.scene, &context, &sim);
        if (code == EXIT_GOOD) {
            catch_signals();
            code = run(context, sim, &o);
        }
    }
    pdyn_free(sim);
    pdyn_destroy(context);
    scene_options_free(&o.scene);
    free(o.default_output);
    record_free(o.record);
    return code;
}
