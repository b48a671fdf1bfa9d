/* projdyn list: the registered types, from the tables that parse them. */
#include "app.h"

#include <getopt.h>
#include <stdio.h>

static void print(void *user, const char *text) { fputs(text, user); }

int list_main(int argc, char **argv) {
    static const struct option long_options[] = {{"help", no_argument, NULL, 'h'}, {0}};
    int option = getopt_long(argc, argv, "h", long_options, NULL);
    if (option == 'h' || (option == -1 && argc - optind > 1)) {
        fprintf(option == 'h' ? stdout : stderr,
                "Usage: projdyn list [TYPE]\n\nLists constraint types and solvers, or the "
                "parameters of one with\n"
                "units, defaults and bounds.\n");
        return option == 'h' ? EXIT_GOOD : EXIT_BAD_INPUT;
    }
    if (option != -1) return EXIT_BAD_INPUT;
    pdyn_context *context = NULL;
    pdyn_status status = pdyn_create(NULL, &context);
    if (status == PDYN_OK) status = pdyn_describe(context, argv[optind], print, stdout);
    int code = status == PDYN_OK ? EXIT_GOOD : report_status(context, status);
    pdyn_destroy(context);
    return code;
}
