/* projdyn replay: packs the frames of a run into one HTML page. */
#include "replay_page.h"
#include "replay_run.h"

#include <getopt.h>
#include <stdio.h>

static const char usage[] =
    "Usage: projdyn replay DIR [-o FILE]\n"
    "\n"
    "Packs the frames of a run into one HTML page that plays in any browser with WebGL 2.\n"
    "\n"
    "  -o, --output FILE  output file (default DIR/replay.html)\n"
    "  -h, --help         prints this text\n";

static int replay(struct run *run, const char *output) {
    char path[REPLAY_PATH];
    int code = replay_open(run);
    if (code == EXIT_GOOD && !run->report)
        fputs("projdyn: warning: no report.json: particle radii are estimated, density errors are "
              "not shown\n",
              stderr);
    if (code == EXIT_GOOD) code = replay_read_metrics(run);
    if (code == EXIT_GOOD) code = replay_find_ranges(run);
    if (code == EXIT_GOOD && !output && !replay_path(path, run, "replay", ".html"))
        code = replay_error("%s: the path is too long", run->directory);
    if (code == EXIT_GOOD) code = replay_write_page(run, output ? output : path);
    if (code == EXIT_GOOD) printf("%d frames written to %s\n", run->frames, output ? output : path);
    return code;
}

int replay_main(int argc, char **argv) {
    static const struct option long_options[] = {
        {"output", required_argument, NULL, 'o'}, {"help", no_argument, NULL, 'h'}, {0}};
    const char *output = NULL;
    int option;
    while ((option = getopt_long(argc, argv, "o:h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (option != 'o') return EXIT_BAD_INPUT;
        output = optarg;
    }
    if (argc - optind != 1) {
        fprintf(stderr, "projdyn: replay: expected one directory\n\n%s", usage);
        return EXIT_BAD_INPUT;
    }
    struct run run = {.directory = argv[optind]};
    int code = replay(&run, output);
    replay_close(&run);
    return code;
}
