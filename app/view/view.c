/* projdyn view: runs a scene and shows it in a browser. */
#include "live.h"
#include "server.h"

#include <stdlib.h>
#include <sys/resource.h>

static const char usage[] =
    "Usage: projdyn view SCENE [OPTIONS]\n"
    "\n"
    "Runs a scene and shows it in a browser: drag cloth and soft bodies with the mouse, change\n"
    "parameters and gravity, save the state. Prints the address of the page.\n"
    "\n"
    "      --port N          port on 127.0.0.1 (default: a free one)\n"
    "      --no-browser      opens no browser\n"
    "      --threads N       worker threads (default: one per core)\n"
    "      --set PATH=VALUE  overrides a value of the scene, e.g. solver.type=cholesky\n"
    "      --plugin FILE     loads the constraint types and solvers of a plug-in before the scene\n"
    "      --allow-plugins   loads the plug-ins that the scene names\n"
    "  -h, --help            prints this text\n"
    "\n"
    "Ctrl-C ends the view after the current step, a second Ctrl-C at once.\n";

enum { YIELDING = 5 }; /* niceness: a browser that draws on the same cores comes first */

struct view_options {
    struct scene_options scene;
    struct server_options server;
};

static bool accept_option(void *self, int option) {
    struct view_options *o = self;
    if (option == 'n') return o->server.open_browser = false, true;
    if (option == 'p') return parse_integer("--port", optarg, 1, 65535, &o->server.port);
    return scene_accept_option(&o->scene, option);
}

static int view(const struct view_options *o) {
    struct live live;
    char *page = NULL;
    /* the threads of the simulation inherit it */
    setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + YIELDING);
    int code = live_open(&live, &o->scene, &page);
    if (code == EXIT_GOOD) code = server_run(&live, page, &o->server);
    live_close(&live);
    free(page);
    return code;
}

int view_main(int argc, char **argv) {
    static const struct option long_options[] = {{"port", required_argument, NULL, 'p'},
                                                 {"no-browser", no_argument, NULL, 'n'},
                                                 SCENE_OPTIONS,
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    struct view_options o = {.server = {.open_browser = true}};
    int code = parse_options(argc, argv, "h", long_options, usage, accept_option, &o);
    if (code < 0 && argc - optind != 1) code = report_usage(argv, "one scene file", usage);
    if (code < 0) {
        o.scene.scene = argv[optind];
        code = view(&o);
    }
    scene_options_free(&o.scene);
    return code;
}
