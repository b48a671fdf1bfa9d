/* projdyn run: simulates a scene and writes frames, metrics.csv, report.json and saved states. */
#include "run_progress.h"
#include "run_record.h"
#include "scene_json.h"
#include "signals.h"

#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static const char usage[] =
    "Usage: projdyn run SCENE [OPTIONS]\n"
    "       projdyn run --resume DIR [OPTIONS]\n"
    "\n"
    "Simulates a scene and writes frames, metrics.csv and report.json.\n"
    "\n"
    "  -o, --output DIR      output directory (default out/NAME for NAME.json)\n"
    "      --threads N       worker threads (default: one per core)\n"
    "      --set PATH=VALUE  overrides a value of the scene, e.g. solver.type=cholesky;\n"
    "                        null removes a key or an element\n"
    "      --plugin FILE     loads the constraint types and solvers of a plug-in before the scene\n"
    "      --allow-plugins   loads the plug-ins that the scene or the resumed run names\n"
    "      --time S          simulates S seconds instead of the duration of the scene\n"
    "      --wall-time S     stops after the step at which the program has run for S seconds of\n"
    "                        wall time; --resume continues\n"
    "      --report FILE     writes the report to FILE instead of DIR/report.json\n"
    "      --ply             writes each frame as PLY in addition to VTK\n"
    "      --no-frames       writes no frames; only metrics.csv, report.json and states\n"
    "      --save N          saves the state every N frames (default 10; 0: only at the end)\n"
    "      --resume DIR      continues the run in DIR from its saved state, with bit-identical\n"
    "                        results; --time S changes the end of the run, --set step lengths,\n"
    "                        tolerances and iterations\n"
    "      --strict          exit code 1 at the end of the run if there are warnings\n"
    "      --quiet           prints no progress and no summary, but warnings\n"
    "  -h, --help            prints this text\n"
    "\n"
    "Ctrl-C stops the run after the current frame, a second Ctrl-C after the current step. "
    "SIGTERM,\n"
    "SIGUSR1 and SIGHUP (the terminal closes) stop it after the current step.\n";

struct run_options {
    struct scene_options scene;
    const char *output, *report, *resume;
    char *default_output; /* owned output path if --output is absent */
    void *record;         /* owns the texts of a resumed run, see run_record.h */
    double given_end;     /* s: --time; 0: not given */
    double wall_limit;    /* s: wall-clock time at which the run stops (--wall-time); 0: none */
    double recorded_end;  /* s: --time of the start of a resumed run; 0: not given */
    char duration[64];    /* the override "duration=S" of a run that is longer than its scene */
    int changes;          /* overrides and --no-frames of a resumed run that run.json lacks */
    int save_interval;    /* frames between two saved states; 0: only at the end */
    bool ply, no_frames, quiet, strict;
};

/* Number of signals SIGINT received during the run, and whether another one was. */
static volatile sig_atomic_t interrupts, terminated;

static void on_signal(int number) {
    if (number == SIGINT) interrupts++;
    else terminated = 1;
}

/* ---- arguments ------------------------------------------------------------------------------- */

static bool parse_wall_time(struct run_options *o, const char *text) {
    double start = wall_seconds();
    if (!parse_seconds("--wall-time", text, INFINITY, &o->wall_limit)) return false;
    o->wall_limit += start;
    return true;
}

static bool accept_option(void *self, int option) {
    struct run_options *o = self;
    switch (option) {
    case 'o':
        return o->output = optarg, true;
    case 'r':
        return o->report = optarg, true;
    case 'p':
        return o->ply = true;
    case 'n':
        return o->no_frames = true;
    case 'q':
        return o->quiet = true;
    case 'E':
        return o->strict = true;
    case 'R':
        return o->resume = optarg, true;
    case 'S':
        return parse_integer("--save", optarg, 0, INT_MAX, &o->save_interval);
    case 'T':
        return parse_seconds("--time", optarg, LONGEST_DURATION, &o->given_end);
    case 'W':
        return parse_wall_time(o, optarg);
    default:
        return scene_accept_option(&o->scene, option);
    }
}

/* Reads scene, overrides and plug-ins of the run to resume from its run.json; `scenes` is the
 * number of scene files on the command line. Returns -1 on success, otherwise the exit code. */
static int read_resume_options(struct run_options *o, int scenes) {
    if (scenes || o->output || o->ply || o->scene.plugins) {
        fprintf(stderr, "projdyn: --resume: expected no scene file, --output, --plugin or --ply: "
                        "all of them are taken from the resumed run\n");
        return EXIT_BAD_INPUT;
    }
    o->output = o->resume;
    struct scene_options given = o->scene; /* its overrides come after those of run.json */
    o->scene.set = NULL, o->scene.sets = 0;
    bool no_frames = o->no_frames;
    int code = run_record_read(o->resume, &o->scene, &o->recorded_end, &o->no_frames, &o->record);
    o->changes = given.sets + (no_frames && !o->no_frames);
    o->no_frames |= no_frames;
    for (int k = 0; k < given.sets && code == EXIT_GOOD; k++)
        if (!scene_set(&o->scene, given.set[k])) code = EXIT_FAILED;
    free(given.set);
    if (code != EXIT_GOOD) return code;
    if (o->scene.plugins && !scene_plugins_allowed()) {
        fprintf(stderr,
                "projdyn: %s/run.json: plugins: %s runs code and is loaded only with "
                "--allow-plugins, or PROJDYN_ALLOW_PLUGINS=1 in the environment\n",
                o->resume, o->scene.plugin[0]);
        return EXIT_BAD_INPUT;
    }
    return -1;
}

/* Parses the command line. Returns -1 if the run can start, otherwise the exit code. */
static int parse(struct run_options *o, int argc, char **argv) {
    static const struct option long_options[] = {{"output", required_argument, NULL, 'o'},
                                                 SCENE_OPTIONS,
                                                 {"time", required_argument, NULL, 'T'},
                                                 {"wall-time", required_argument, NULL, 'W'},
                                                 {"report", required_argument, NULL, 'r'},
                                                 {"ply", no_argument, NULL, 'p'},
                                                 {"no-frames", no_argument, NULL, 'n'},
                                                 {"quiet", no_argument, NULL, 'q'},
                                                 {"save", required_argument, NULL, 'S'},
                                                 {"resume", required_argument, NULL, 'R'},
                                                 {"strict", no_argument, NULL, 'E'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    int code = parse_options(argc, argv, "o:h", long_options, usage, accept_option, o);
    if (code >= 0) return code;
    if (o->resume) return read_resume_options(o, argc - optind);
    if (argc - optind != 1) return report_usage(argv, "one scene file", usage);
    if (o->output && !*o->output) {
        fprintf(stderr, "projdyn: --output: found an empty text, expected a directory\n");
        return EXIT_BAD_INPUT;
    }
    o->scene.scene = argv[optind];
    if (run_record_exists(o->scene.scene)) {
        fprintf(stderr,
                "projdyn: %s: expected a scene file, found the folder of a run; to continue it: "
                "projdyn run --resume %s; to look at it: projdyn replay %s\n",
                o->scene.scene, shell_word(o->scene.scene).text, shell_word(o->scene.scene).text);
        return EXIT_BAD_INPUT;
    }
    if (!o->output) o->output = o->default_output = default_output("", o->scene.scene);
    return o->output ? -1 : EXIT_FAILED;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Whether an interrupt or --wall-time ends the run before the next step. Other signals and
 * --wall-time do not wait for the end of the frame, because that may take minutes and a batch
 * system kills the run seconds later. The first Ctrl-C waits for it and prints a message once
 * (*printed), the second one does not wait. Every run takes a step, so that resumed runs end with
 * any --wall-time. `frame`: the last step ended a frame; steps: of this run. */
static bool must_stop(const struct run_options *o, bool frame, long steps, bool *printed) {
    if (terminated || interrupts > 1) return true;
    if (o->wall_limit > 0.0 && steps && wall_seconds() >= o->wall_limit) return true;
    if (interrupts && !frame && !*printed) {
        *printed = true;
        clear_progress();
        fprintf(stderr, "projdyn: interrupted: the run stops after the current frame; a second "
                        "Ctrl-C stops it after the current step\n");
    }
    return interrupts && frame;
}

/* Writes a frame, and the state every `save_interval` frames. The initial frame is one of these,
 * so that a run can be resumed from its start on. */
static pdyn_status end_frame(pdyn_writer *writer, const struct run_options *o,
                             struct run_totals *t) {
    pdyn_status status = o->no_frames ? PDYN_OK : pdyn_writer_frame(writer);
    bool due = o->save_interval && t->frames++ % o->save_interval == 0;
    return status == PDYN_OK && due ? pdyn_writer_save(writer) : status;
}

/* Time loop: steps and writes until the end of the run, a failure or an interrupt
 * (*interrupted). */
static pdyn_status simulate(pdyn_sim *sim, pdyn_writer *writer, const struct run_options *o,
                            struct run_totals *t, bool *interrupted) {
    bool frame = true, printed = false;
    pdyn_status status = o->resume ? PDYN_OK : end_frame(writer, o, t);
    while (status == PDYN_OK && !pdyn_has_reached(sim, t->end)) {
        if ((*interrupted = must_stop(o, frame, t->steps, &printed))) break;
        pdyn_step_info info;
        status = pdyn_step(sim, &info);
        if (status == PDYN_OK) status = pdyn_writer_step(writer, &info);
        if (status != PDYN_OK) break;
        run_totals_add(t, &info);
        frame = info.frame;
        if (frame) status = end_frame(writer, o, t);
        if (!o->quiet) run_show_progress(&info, t);
    }
    if (!o->quiet) clear_progress();
    return status;
}

/* Writes run.json of a new run, and of a resumed one with changes, without its --time. */
static int write_record(const struct run_options *o) {
    struct scene_options recorded = o->scene;
    if (o->resume && !o->changes) return EXIT_GOOD;
    if (*o->duration) recorded.sets--;
    return run_record_write(o->output, &recorded, o->resume ? o->recorded_end : o->given_end,
                            o->no_frames);
}

/* Opens the output directory for a new run or for the continuation of a run. Returns EXIT_GOOD,
 * or another exit code after a message; *writer is open only on EXIT_GOOD. */
static int open_output(pdyn_context *context, pdyn_sim *sim, const struct run_options *o,
                       pdyn_writer **writer) {
    bool unfinished = !o->resume && !o->report && run_record_is_unfinished(o->output);
    pdyn_status status = o->resume ? pdyn_writer_resume(sim, o->output, writer)
                                   : pdyn_writer_open(sim, o->output, o->ply, writer);
    if (status != PDYN_OK) {
        int failed = report_status(context, status);
        return o->resume && status == PDYN_IO_FAILED ? EXIT_BAD_INPUT : failed;
    }
    if (unfinished)
        fprintf(stderr,
                "projdyn: note: this run replaces one in %s that had not ended and could have been "
                "continued by: projdyn run --resume %s\n",
                o->output, shell_word(o->output).text);
    if (write_record(o) == EXIT_GOOD) return EXIT_GOOD;
    pdyn_writer_close(*writer);
    return EXIT_FAILED;
}

/* Writes the report and the final state. `status`: how simulate() ended; after a failure the
 * state is that of the last step that succeeded. Returns the exit code of the run. */
static int close_output(pdyn_context *context, pdyn_writer *writer, const struct run_options *o,
                        pdyn_status status, bool interrupted) {
    int code = status == PDYN_OK ? EXIT_GOOD : report_status(context, status);
    char failure[2048]; /* a copy, because pdyn_writer_report() may replace the text */
    snprintf(failure, sizeof failure, "%s", pdyn_last_error(context));
    const char *failed = status == PDYN_OK ? NULL : failure;
    pdyn_status written = pdyn_writer_report(writer, o->report, interrupted, failed);
    if (written != PDYN_OK) code = report_status(context, written);
    if (written != PDYN_OK && o->report &&
        pdyn_writer_report(writer, NULL, interrupted, failed) == PDYN_OK)
        fprintf(stderr, "projdyn: note: the report is in %s/report.json\n", o->output);
    written = pdyn_writer_save(writer);
    if (written != PDYN_OK) code = report_status(context, written);
    pdyn_writer_close(writer);
    return code;
}

/* Says how to continue. The --time of a resumed run is not in its run.json. */
static void print_interrupted(const pdyn_sim *sim, const struct run_options *o) {
    char time[32] = "";
    if (o->resume && o->given_end > 0.0) snprintf(time, sizeof time, " --time %.12g", o->given_end);
    fprintf(stderr,
            "projdyn: interrupted at %g s; results are in %s; to continue: projdyn run "
            "--resume %s%s%s\n",
            pdyn_time(sim), o->output, shell_word(o->output).text,
            o->scene.plugins || scene_plugins_allowed() ? " --allow-plugins" : "", time);
}

/* Says where a resumed run takes no step, and warns where the first frame is the only one. A scene
 * that is that short has a warning itself. */
static void check_end(const pdyn_sim *sim, const struct run_options *o, double end) {
    double interval = pdyn_frame_interval(sim);
    if (o->resume && pdyn_has_reached(sim, end))
        fprintf(stderr,
                "projdyn: note: no step to take: the run has reached %g s, and is to end at %g s; "
                "a later --time goes on\n",
                pdyn_time(sim), end);
    if (!o->resume && o->given_end > 0.0 && o->given_end < (1.0 - 1e-9) * interval && !*o->duration)
        fprintf(stderr, "projdyn: warning: --time %g ends before the second frame, at %g s\n",
                o->given_end, interval);
}

/* Simulates the loaded scene and writes its results. Returns the exit code of the command. */
static int run(pdyn_context *context, pdyn_sim *sim, const struct run_options *o) {
    double end = o->given_end > 0.0 ? o->given_end : o->recorded_end;
    struct run_totals totals = {.start_s = wall_seconds(),
                                .end = end > 0.0 ? end : pdyn_duration(sim)};
    pdyn_writer *writer = NULL;
    int code = open_output(context, sim, o, &writer);
    if (code != EXIT_GOOD) return code;
    check_end(sim, o, totals.end);
    bool interrupted = false;
    pdyn_status status = simulate(sim, writer, o, &totals, &interrupted);
    code = close_output(context, writer, o, status, interrupted);
    if (code != EXIT_GOOD) return code;
    if (interrupted) print_interrupted(sim, o);
    if (o->quiet) run_print_grown_warnings(sim);
    else run_print_summary(sim, o->output, &totals);
    return interrupted ? EXIT_INTERRUPTED : warnings_exit_code(sim, o->strict);
}

/* Makes the scene as long as the run, by an override, if it is shorter. A scene that is longer
 * stays as it is: its inlets keep room for all particles up to its end, so that the run can go on
 * until then. Returns EXIT_GOOD, or another exit code after a message. */
static int lengthen_scene(struct run_options *o) {
    double end = fmax(o->given_end, o->recorded_end);
    json_t *scene = NULL;
    int code = end > 0.0 ? scene_json(&o->scene, &scene) : EXIT_GOOD;
    bool longer = code == EXIT_GOOD && end > scene_number(scene, "duration", 0.0);
    json_decref(scene);
    if (!longer) return code;
    snprintf(o->duration, sizeof o->duration, "duration=%.17g", end);
    return scene_set(&o->scene, o->duration) ? EXIT_GOOD : EXIT_FAILED;
}

/* Installs the handler of signals.h, and of SIGUSR1, by which batch systems announce the end of a
 * job. Called after the scene is loaded: before that nothing has been written, and the default
 * action (terminate) is right. */
static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    signals_catch(on_signal, SA_RESTART);
    sigaction(SIGUSR1, &action, NULL);
}

/* Whether --report would replace the scene. */
static bool is_report_scene(const struct run_options *o) {
    struct stat report, scene;
    return o->report && !stat(o->report, &report) && !stat(o->scene.scene, &scene) &&
           report.st_ino == scene.st_ino && report.st_dev == scene.st_dev;
}

static int check_report(const struct run_options *o) {
    if (!is_report_scene(o)) return EXIT_GOOD;
    fprintf(stderr, "projdyn: --report: expected a new file, found the scene, %s\n", o->report);
    return EXIT_BAD_INPUT;
}

int run_main(int argc, char **argv) {
    struct run_options o = {.save_interval = 10};
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    int code = parse(&o, argc, argv);
    if (code < 0) {
        code = check_report(&o);
        if (code == EXIT_GOOD) code = lengthen_scene(&o);
        if (code == EXIT_GOOD) code = scene_load(&o.scene, &context, &sim);
        if (code == EXIT_GOOD) {
            catch_signals();
            code = run(context, sim, &o);
        }
    }
    pdyn_free(sim);
    pdyn_destroy(context);
    scene_options_free(&o.scene);
    free(o.default_output);
    run_record_free(o.record);
    return code;
}
