/* Starts the browser of the desktop on a private file that leads to the page. */
#include "open_browser.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_SIZE = 128 };

/* Runs xdg-open as a child of no process that waits for it. */
static void start_program(const char *path) {
    pid_t child = fork();
    if (child > 0) waitpid(child, NULL, 0);
    if (child) return;
    if (fork()) _exit(0);
    int nothing = open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3; stream++) dup2(nothing, stream);
    setsid();
    execlp("xdg-open", "xdg-open", path, (char *)NULL);
    _exit(0);
}

void open_browser(const char *url, char *folder, size_t size) {
    char path[PATH_SIZE];
    snprintf(folder, size, "/tmp/projdyn-view-XXXXXX");
    if (!mkdtemp(folder)) {
        *folder = '\0';
        return;
    }
    snprintf(path, sizeof path, "%s/open.html", folder);
    FILE *file = fopen(path, "wx");
    if (!file) return;
    fprintf(file, "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=%s\">\n", url);
    if (!fclose(file)) start_program(path);
}

void close_browser(const char *folder) {
    char path[PATH_SIZE];
    if (!*folder) return;
    snprintf(path, sizeof path, "%s/open.html", folder);
    unlink(path);
    rmdir(folder);
}
