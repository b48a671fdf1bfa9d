/* Starts the browser of the desktop on a private file that leads to the page. */
#include "open_browser.h"
#include "app.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_SIZE = TEMPORARY_FOLDER + 16 };

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

void open_browser(const char *url, char folder[TEMPORARY_FOLDER]) {
    char path[PATH_SIZE];
    if (temporary_folder_make("view", folder) != EXIT_GOOD) return;
    snprintf(path, sizeof path, "%s/open.html", folder);
    FILE *file = fopen(path, "wx");
    if (!file) return;
    fprintf(file, "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=%s\">\n", url);
    if (!fclose(file)) start_program(path);
}
