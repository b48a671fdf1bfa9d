/* projdyn list: prints the registered constraint types and solvers, from the parameter tables
 * that also parse a scene. */
#include "scene_options.h"

#include <stdio.h>

static const char usage[] =
    "Usage: projdyn list [TYPE] [--plugin FILE]...\n"
    "\n"
    "Prints all constraint types and solvers, or the parameters of one TYPE with units, defaults\n"
    "and bounds.\n";

static void print(void *user, const char *text) { fputs(text, user); }

static bool accept_option(void *options, int option) {
    return option == 'p' && scene_plugin(options, optarg);
}

int list_main(int argc, char **argv) {
    static const struct option long_options[] = {
        {"plugin", required_argument, NULL, 'p'}, {"help", no_argument, NULL, 'h'}, {0}};
    struct scene_options options = {0};
    pdyn_context *context = NULL;
    int code = parse_options(argc, argv, "h", long_options, usage, accept_option, &options);
    if (code < 0 && argc - optind > 1) code = report_usage(argv, "at most one type", usage);
    if (code < 0) {
        code = scene_context(&options, &context);
        pdyn_status status = code ? PDYN_OK : pdyn_describe(context, argv[optind], print, stdout);
        if (status != PDYN_OK) code = report_status(context, status);
    }
    pdyn_destroy(context);
    scene_options_free(&options);
    return code;
}
