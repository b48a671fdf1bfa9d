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

#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv) {
    const char *command = argc > 2 ? argv[1] : "";
    pdyn_context *context = make_context(1);
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
