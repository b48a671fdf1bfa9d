/* projdyn replay: packs the frames of a run into one HTML page. */
#include "replay_page.h"
#include "replay_run.h"
#include "run_to_file.h"

#include <string.h>

static const char usage[] =
    "Usage: projdyn replay DIR [-o FILE]\n"
    "\n"
    "Packs the frames of a run into one HTML page that plays in any browser with WebGL 2.\n"
    "\n"
    "  -o, --output FILE  output file (default DIR/replay.html)\n"
    "  -h, --help         prints this text\n";

/* A page of another name, as film.mp4, would open in no program; /dev/stdout is one. */
static int check_ending(const char *path) {
    const char *ending = strrchr(path, '.');
    if ((ending && !strcmp(ending, ".html")) || !strncmp(path, "/dev/", 5)) return EXIT_GOOD;
    return run_error("--output: found \"%s\", expected a file ending with .html; `projdyn render` "
                     "makes pictures and films",
                     path);
}

static int write_page(struct run *run, const char *output) {
    int code = check_ending(output);
    if (code == EXIT_GOOD) code = replay_load(run);
    return code == EXIT_GOOD ? replay_write_page(run, output) : code;
}

int replay_main(int argc, char **argv) {
    return run_to_file(argc, argv, usage, "replay.html", write_page);
}
