/* Coupled fluid and cloth against exact results. Each command writes CSV files into
 * DIRECTORY and prints a table as markdown:
 *
 *     coupling momentum DIRECTORY STEPS SECONDS      free water and cloth: conservation
 *     coupling basin DIRECTORY SECONDS MM...         at rest in a sheet; MM: particle spacing
 *     coupling lintearia DIRECTORY SECONDS MM...     the shape of a sheet that holds water
 *     coupling gate DIRECTORY MMxMPAxMS[:INTEGRATOR]...  a rubber gate: spacing, modulus, step
 *     coupling leaks DIRECTORY NAME:N:M:MS:S:OxL:V...  impact or bag, N particles across, mesh M,
 *                                                    at V m/s */
#include "coupling.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

pdyn_sim *load(pdyn_context *context, const char *format, ...) {
    char text[131072];
    pdyn_sim *sim;
    va_list args;
    va_start(args, format);
    int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (length < 0 || (size_t)length >= sizeof text) die("too long a scene");
    for (char *c = text; *c; c++)
        if (*c == '\'') *c = '"';
    if (pdyn_load_text(context, text, "coupling", NULL, 0, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    return sim;
}

int main(int argc, char **argv) {
    const char *command = argc > 2 ? argv[1] : "";
    pdyn_options options = pdyn_default_options();
    pdyn_context *context;
    options.threads = 1;
    if (pdyn_create(&options, &context) != PDYN_OK) die("no context");
    if (!strcmp(command, "momentum") && argc == 5)
        momentum(context, argv[2], atoi(argv[3]), atof(argv[4]));
    else if (!strcmp(command, "basin") && argc > 4)
        basin(context, argv[2], atof(argv[3]), argc - 4, argv + 4);
    else if (!strcmp(command, "lintearia") && argc > 4)
        lintearia(context, argv[2], atof(argv[3]), argc - 4, argv + 4);
    else if (!strcmp(command, "gate")) elastic_gate(context, argv[2], argc - 3, argv + 3);
    else if (!strcmp(command, "leaks")) leaks(context, argv[2], argc - 3, argv + 3);
    else
        die("usage: coupling momentum DIRECTORY STEPS SECONDS | basin DIRECTORY SECONDS MM... | "
            "lintearia DIRECTORY SECONDS MM... | gate DIRECTORY MMxMPAxMS... | leaks DIRECTORY "
            "NAME:N:M:MS:S:OxL:V...");
    pdyn_destroy(context);
    return 0;
}
