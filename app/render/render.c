/* projdyn render: pictures and films of a run, drawn by the replay page in a headless Chromium. */
#include "app.h"
#include "browser.h"
#include "camera_keys.h"
#include "film.h"
#include "replay_page.h"
#include "run_directory.h"
#include "signals.h"
#include "temporary_folder.h"
#include "water_surface.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn render DIR -o FILE [OPTIONS]\n"
    "\n"
    "Draws the frames of a run as the replay page does: one frame to FILE.png, or all frames to\n"
    "FILE.mp4, FILE.webm, FILE.gif, or numbered pictures: FILE_%04d.png. Needs Chromium, and\n"
    "ffmpeg for films. Pictures that a quantity colours (--view fluid=speed) have a legend.\n"
    "\n"
    "  -o, --output FILE  picture, pictures or film\n"
    "      --size WxH     size in pixels, both even (default 1280x720)\n"
    "      --frame N      frame of a picture (default: that of --view, or the last one)\n"
    "      --time S       frame of a picture: the one nearest to this time, s\n"
    "      --frames A:B   of a film or numbered pictures: only the frames A to B, counted from 0\n"
    "      --fps N        pictures a second of a film (default: as fast as simulated)\n"
    "      --view TEXT    view: what the page's button \"Link\" puts behind '#'\n"
    "      --camera KEYS  camera over time: a JSON file or an array. Keys have a time (s), yaw,\n"
    "                     pitch (degrees), scale (factor on the distance), target (m):\n"
    "                     '[{\"time\": 0, \"yaw\": 0}, {\"time\": 2, \"yaw\": 90, \"scale\": "
    "0.7}]'\n"
    "      --turntable S  a film of S seconds in which the camera goes once around the frame\n"
    "                     of --frame or --time, at 25 pictures a second or --fps\n"
    "  -h, --help         prints this text\n";

enum { SAMPLES = 2 /* a side of a pixel of the picture is drawn as so many */ };

struct options {
    const char *output, *view;
    long width, height;
    int frame;          /* -1: that of the view, or the last one */
    long first, last;   /* frames of a film; last -1: the last one */
    double time, fps;   /* NAN: not given */
    double turntable;   /* s; 0: none */
    const char *camera; /* argument of --camera; NULL: none */
    char *keys;         /* its keys, see camera_keys.h */
};

enum {
    OPTION_SIZE = 256,
    OPTION_FRAME,
    OPTION_TIME,
    OPTION_FPS,
    OPTION_VIEW,
    OPTION_FRAMES,
    OPTION_CAMERA,
    OPTION_TURNTABLE,
};

/* ---- options --------------------------------------------------------------------------------- */

static bool parse_size(const char *text, struct options *options) {
    int end = 0;
    bool good =
        sscanf(text, "%5ldx%5ld%n", &options->width, &options->height, &end) == 2 && !text[end];
    if (good && options->width >= 16 && options->height >= 16 && options->width <= 8192 &&
        options->height <= 8192 && options->width % 2 == 0 && options->height % 2 == 0)
        return true;
    run_error("render: --size %s: expected WIDTHxHEIGHT, even numbers from 16 to 8192", text);
    return false;
}

static bool parse_number(const char *option, const char *text, double least, double *out) {
    char *end;
    *out = strtod(text, &end);
    if (end != text && !*end && *out >= least && *out <= 1e6) return true;
    run_error("render: %s %s: expected a number from %g to 1e6", option, text, least);
    return false;
}

static bool accept_option(void *self, int option) {
    struct options *options = self;
    if (option == 'o') options->output = optarg;
    if (option == OPTION_VIEW) options->view = optarg;
    if (option == OPTION_CAMERA) options->camera = optarg;
    if (option == OPTION_SIZE) return parse_size(optarg, options);
    if (option == OPTION_FRAMES) return parse_frames(optarg, &options->first, &options->last);
    if (option == OPTION_FRAME)
        return parse_integer("--frame", optarg, 0, 1 << 30, &options->frame);
    if (option == OPTION_TIME) return parse_number("--time", optarg, 0.0, &options->time);
    if (option == OPTION_FPS) return parse_number("--fps", optarg, 0.01, &options->fps);
    if (option == OPTION_TURNTABLE)
        return parse_number("--turntable", optarg, 0.04, &options->turntable);
    return option != '?';
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* Frames a second of simulated time, on average; 25 for a single frame. */
static double simulated_rate(const struct run *run) {
    double span = part_time(&run->part[0], run->frames - 1) - part_time(&run->part[0], 0);
    return span > 0.0 ? (run->frames - 1) / span : 25.0;
}

/* The frame that a view names, at most the last one; the last one if it names none. */
static int view_frame(const char *view, int last) {
    static const char name[] = "frame=";
    for (const char *at = view; at; at = strchr(at, '&')) {
        at += *at == '&';
        if (strncmp(at, name, strlen(name))) continue;
        long frame = strtol(at + strlen(name), NULL, 10);
        return frame < last ? (int)frame : last;
    }
    return last;
}

/* Sets the frame of a picture and the rate of a film; EXIT_BAD_INPUT if the run lacks a frame. */
static int choose_frame(const struct run *run, struct options *options) {
    if (options->frame >= run->frames)
        return run_error("render: --frame %d: expected at most %d, the last frame of the run",
                         options->frame, run->frames - 1);
    if (options->last >= run->frames)
        return run_error(
            "render: --frames: expected at most %d, the last frame of the run, found %ld",
            run->frames - 1, options->last);
    if (options->last < 0) options->last = run->frames - 1;
    if (options->frame < 0) options->frame = view_frame(options->view, run->frames - 1);
    if (isnan(options->fps)) options->fps = options->turntable > 0.0 ? 25.0 : simulated_rate(run);
    double nearest = INFINITY;
    for (int f = 0; f < run->frames && !isnan(options->time); f++) {
        double away = fabs(part_time(&run->part[0], f) - options->time);
        if (away < nearest) options->frame = f;
        nearest = fmin(nearest, away);
    }
    double end = part_time(&run->part[0], run->frames - 1), rate = simulated_rate(run);
    if (options->time > end + 1.0 / rate)
        fprintf(stderr, "projdyn: render: --time %g: the run ends at %g s, whose frame is drawn\n",
                options->time, end);
    return EXIT_GOOD;
}

/* The pictures of a command. */
struct plan {
    bool turns;        /* a turntable: all pictures are of the frame `first` */
    long first, count; /* otherwise of the `count` frames from `first` on */
};

/* Whether the output is a picture, or numbered pictures. */
static bool is_png(const char *output) {
    enum film_format format;
    return film_find_format(output, &format) && format == FILM_PNG;
}

/* Whether the output is a single picture. */
static bool is_still(const char *output) { return is_png(output) && !film_is_numbered(output); }

static struct plan make_plan(const struct options *options) {
    bool still = is_still(options->output);
    struct plan plan = {.turns = options->turntable > 0.0};
    plan.first = still || plan.turns ? options->frame : options->first;
    plan.count = still        ? 1
                 : plan.turns ? lround(fmax(1.0, options->turntable * options->fps))
                              : options->last - options->first + 1;
    return plan;
}

/* Draws picture k. */
static int draw_picture(const struct run *run, struct browser *browser, struct film *film,
                        const struct options *options, const struct plan *plan, long k) {
    char expression[128];
    json_t *picture;
    long frame = plan->turns ? plan->first : plan->first + k;
    double turn = plan->turns ? 360.0 * (double)k / (double)plan->count : 0.0;
    int code = plan->turns && k ? EXIT_GOOD : water_surface_send(browser, run, (int)frame);
    if (code != EXIT_GOOD) return code;
    snprintf(expression, sizeof expression, "pictureOfFrame(%ld, %ld, %ld, %d, %.9g)", frame,
             options->width, options->height, SAMPLES, turn);
    code = browser_evaluate(browser, expression, &picture);
    if (code != EXIT_GOOD) return code;
    code = film_add(film, plan->turns ? k : frame, json_string_value(picture));
    json_decref(picture);
    return code;
}

/* EXIT_BAD_INPUT if the page does not know a name or a value of the view. */
static int check_view(struct browser *browser, const char *view) {
    json_t *fault;
    int code = browser_evaluate(browser, "viewFault(location.hash.slice(1))", &fault);
    if (code != EXIT_GOOD) return code;
    const char *text = json_string_value(fault);
    if (*text) code = run_error("render: --view %s: %s", view, text);
    json_decref(fault);
    return code;
}

/* ---- progress and signals -------------------------------------------------------------------- */

/* Redraws the progress line of a terminal. */
static void show_progress(long done, long frames, double start) {
    if (frames == 1 || !isatty(STDERR_FILENO)) return;
    clear_progress();
    fprintf(stderr, "frame %ld of %ld, %.2g s each", done, frames,
            (wall_seconds() - start) / (double)done);
}

static volatile sig_atomic_t stopped;

static void on_signal(int number) { stopped = number; }

/* A signal ends the command after the current frame, so that it removes its temporary files. */
static void catch_signals(void) {
    signals_catch(on_signal, SA_RESTART);
    signal(SIGPIPE, SIG_IGN); /* a program that ends early shows as an error of write() */
}

/* The address of the page in `folder`, with a view; the caller frees it. NULL: no memory. */
static char *page_address(const char *folder, const char *view) {
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
    char encoded[3 * TEMPORARY_FOLDER], *to = encoded, *address;
    for (; *folder; folder++)
        to += strchr(plain, *folder) ? sprintf(to, "%c", *folder)
                                     : sprintf(to, "%%%02X", (unsigned char)*folder);
    *to = '\0';
    return asprintf(&address, "file://%s/page.html?pictures#%s", encoded, view) < 0 ? NULL
                                                                                    : address;
}

/* Draws the pictures of the page in `folder`. */
static int draw_pictures(const struct run *run, const struct options *options, const char *folder) {
    struct browser browser = {.to = -1, .from = -1};
    struct film film;
    struct plan plan = make_plan(options);
    char *url = page_address(folder, options->view);
    if (!url) return report_no_memory();
    int code = film_open(&film, options->output, options->fps);
    if (code == EXIT_GOOD) code = browser_open(&browser, folder, url);
    if (code == EXIT_GOOD) code = check_view(&browser, options->view);
    if (code == EXIT_GOOD && options->keys)
        code = camera_keys_send(&browser, options->camera, options->keys);
    double start = wall_seconds();
    for (long k = 0; k < plan.count && code == EXIT_GOOD; k++) {
        code = stopped ? EXIT_INTERRUPTED : draw_picture(run, &browser, &film, options, &plan, k);
        show_progress(k + 1, plan.count, start);
    }
    clear_progress();
    browser_close(&browser);
    free(url);
    int closed = film_close(&film, code == EXIT_GOOD);
    return code == EXIT_GOOD ? closed : code;
}

static int render(struct run *run, struct options *options) {
    char page[RUN_PATH], folder[TEMPORARY_FOLDER];
    int code = replay_load(run);
    if (code == EXIT_GOOD) code = choose_frame(run, options);
    if (code == EXIT_GOOD) code = temporary_folder_make("render", folder);
    if (code != EXIT_GOOD) return code;
    snprintf(page, sizeof page, "%.4000s/page.html", folder);
    code = replay_write_page(run, page);
    if (code == EXIT_GOOD) code = draw_pictures(run, options, folder);
    temporary_folder_remove(folder);
    if (code == EXIT_GOOD) printf("written to %s\n", options->output);
    return code;
}

/* EXIT_BAD_INPUT for options that the output would ignore. */
static int check_options(const struct options *o) {
    bool still = is_still(o->output), turns = o->turntable > 0.0;
    bool one_frame = o->frame >= 0 || !isnan(o->time);
    if (turns && (still || o->last >= 0))
        return run_error("render: --turntable: expected a film or numbered pictures, of one frame");
    if (still && o->last >= 0)
        return run_error("render: --frames: expected a film or numbered pictures");
    if (is_png(o->output) && !turns && !isnan(o->fps))
        return run_error("render: --fps: expected a film or --turntable");
    if (o->frame >= 0 && !isnan(o->time))
        return run_error("render: --frame, --time: expected one of them");
    if (one_frame && !still && !turns)
        return run_error("render: %s: expected a picture or --turntable; of a film: --frames A:B",
                         o->frame >= 0 ? "--frame" : "--time");
    return EXIT_GOOD;
}

int render_main(int argc, char **argv) {
    static const struct option long_options[] = {
        {"output", required_argument, NULL, 'o'},
        {"size", required_argument, NULL, OPTION_SIZE},
        {"frame", required_argument, NULL, OPTION_FRAME},
        {"time", required_argument, NULL, OPTION_TIME},
        {"fps", required_argument, NULL, OPTION_FPS},
        {"frames", required_argument, NULL, OPTION_FRAMES},
        {"view", required_argument, NULL, OPTION_VIEW},
        {"camera", required_argument, NULL, OPTION_CAMERA},
        {"turntable", required_argument, NULL, OPTION_TURNTABLE},
        {"help", no_argument, NULL, 'h'},
        {0}};
    struct options options = {
        .view = "", .width = 1280, .height = 720, .frame = -1, .last = -1, .time = NAN, .fps = NAN};
    enum film_format format;
    int code = parse_options(argc, argv, "o:h", long_options, usage, accept_option, &options);
    if (code >= 0) return code;
    if (argc - optind != 1 || !options.output)
        return report_usage(argv, "one directory and -o FILE", usage);
    if (!film_find_format(options.output, &format))
        return run_error("render: %s: expected a name that ends with .png, .mp4, .webm or .gif",
                         options.output);
    if (format == FILM_PNG && !film_check_number(options.output))
        return run_error("render: %s: expected at most one '%%', as in NAME_%%04d.png",
                         options.output);
    code = check_options(&options);
    if (code == EXIT_GOOD && options.camera) code = camera_keys_read(options.camera, &options.keys);
    if (code != EXIT_GOOD) return code;
    catch_signals();
    struct run run = {.directory = argv[optind]};
    code = render(&run, &options);
    free(options.keys);
    if (stopped) code = EXIT_INTERRUPTED;
    run_close(&run);
    return code;
}
