#include "run_to_file.h"

#include <stdio.h>

static bool accept_output(void *output, int option) {
    if (option == 'o') *(const char **)output = optarg;
    return option == 'o';
}

int run_to_file(int argc, char **argv, const char *usage, const char *file,
                int (*write)(struct run *run, const char *output)) {
    static const struct option long_options[] = {
        {"output", required_argument, NULL, 'o'}, {"help", no_argument, NULL, 'h'}, {0}};
    const char *output = NULL;
    char path[RUN_PATH];
    int code = parse_options(argc, argv, "o:h", long_options, usage, accept_output, &output);
    if (code >= 0) return code;
    if (argc - optind != 1) return report_usage(argv, "one directory", usage);
    struct run run = {.directory = argv[optind]};
    run_path(path, &run, "%s", file);
    if (!output) output = path;
    code = write(&run, output);
    if (code == EXIT_GOOD)
        printf("%d frame%s written to %s\n", run.frames, run.frames == 1 ? "" : "s", output);
    run_close(&run);
    return code;
}
