/* projdyn replay: packs the frames of a run into one HTML page. */
#include "replay_page.h"
#include "replay_run.h"

#include <stdio.h>

static const char usage[] =
    "Usage: projdyn replay DIR [-o FILE]\n"
    "\n"
    "Packs the frames of a run into one HTML page that plays in any browser with WebGL 2.\n"
    "\n"
    "  -o, --output FILE  output file (default DIR/replay.html)\n"
    "  -h, --help         prints this text\n";

static int replay(struct run *run, const char *output) {
    char path[RUN_PATH];
    int code = replay_load(run);
    if (code == EXIT_GOOD && !output && !run_path(path, run, "replay", ".html"))
        code = run_error("%s: the path is too long", run->directory);
    if (code == EXIT_GOOD) code = replay_write_page(run, output ? output : path);
    if (code == EXIT_GOOD) printf("%d frames written to %s\n", run->frames, output ? output : path);
    return code;
}

static bool accept_option(void *output, int option) {
    if (option == 'o') *(const char **)output = optarg;
    return option == 'o';
}

int replay_main(int argc, char **argv) {
    static const struct option long_options[] = {
        {"output", required_argument, NULL, 'o'}, {"help", no_argument, NULL, 'h'}, {0}};
    const char *output = NULL;
    int code = parse_options(argc, argv, "o:h", long_options, usage, accept_option, &output);
    if (code >= 0) return code;
    if (argc - optind != 1) return report_usage("replay", "one directory", usage);
    struct run run = {.directory = argv[optind]};
    code = replay(&run, output);
    run_close(&run);
    return code;
}
