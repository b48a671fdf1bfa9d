#include "temporary_folder.h"
#include "app.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int temporary_folder_make(const char *name, char path[TEMPORARY_FOLDER]) {
    const char *given = getenv("TMPDIR"), *place = given && *given ? given : "/tmp";
    char *whole = realpath(place, NULL);
    snprintf(path, TEMPORARY_FOLDER, "%.3000s/projdyn-%s-XXXXXX", whole ? whole : place, name);
    free(whole);
    if (whole && mkdtemp(path)) return EXIT_GOOD;
    int code = report_write_error(path);
    *path = '\0';
    return code;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *at) {
    (void)info, (void)kind, (void)at;
    remove(path);
    return 0;
}

enum { TRIES = 20 }; /* a tenth of a second each */

void temporary_folder_remove(const char *path) {
    /* processes that a browser has started write for a moment after it has ended */
    for (int n = 0; *path && !access(path, F_OK) && n < TRIES; n++) {
        if (n) usleep(100000);
        nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    }
}
