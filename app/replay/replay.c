/* projdyn replay: packs the frames of a run into one HTML page. */
#include "replay_page.h"
#include "replay_run.h"

static const char usage[] =
    "Usage: projdyn replay DIR [-o FILE]\n"
    "\n"
    "Packs the frames of a run into one HTML page that plays in any browser with WebGL 2.\n"
    "\n"
    "  -o, --output FILE  output file (default DIR/replay.html)\n"
    "  -h, --help         prints this text\n";

static int write_page(struct run *run, const char *output) {
    int code = replay_load(run);
    return code == EXIT_GOOD ? replay_write_page(run, output) : code;
}

int replay_main(int argc, char **argv) {
    return run_to_file(argc, argv, usage, "replay.html", write_page);
}
