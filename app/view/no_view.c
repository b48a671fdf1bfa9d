/* projdyn view in a build without libwebsockets. */
#include "app.h"

#include <stdio.h>

int view_main(int argc, char **argv) {
    (void)argc, (void)argv;
    fputs("projdyn: view: this build has no live view: it was made without libwebsockets (Debian: "
          "apt-get install libwebsockets-dev)\n",
          stderr);
    return EXIT_BAD_INPUT;
}
