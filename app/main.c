/* projdyn: the command-line program. This file finds the sub-command and calls it. */
#include "app.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} commands[] = {
    {"run", run_main, "simulate a scene; write frames, metrics.csv and report.json"},
    {"sweep", sweep_main,
     "run a scene on a grid of parameter values, in parallel; write one table"},
    {"compare", compare_main, "time the same steps with several solvers"},
    {"trade", trade_main, "find the Pareto front of error over processor time among many settings"},
    {"check", check_main, "load a scene and print its contents; or test a plug-in"},
    {"list", list_main, "print constraint types and solvers with their parameters and units"},
    {"mesh", mesh_main, "make triangle meshes of the surfaces of fluids"},
    {"usd", usd_main, "write the frames of a run as USD, for Houdini, Maya and others"},
    {"replay", replay_main, "pack the frames of a run into one HTML page"},
    {"view", view_main, "run a scene and show it in a browser: drag, change, save"},
    {"render", render_main, "draw a run to a picture or a film, with Chromium and ffmpeg"},
};

enum { COMMANDS = sizeof commands / sizeof *commands };

static void print_usage(FILE *out) {
    fprintf(out, "Usage: projdyn COMMAND [OPTIONS]\n\n"
                 "Projective Dynamics for fluids, cloth and solids in one solve.\n\n");
    for (int k = 0; k < COMMANDS; k++)
        fprintf(out, "  %-8s %s\n", commands[k].name, commands[k].summary);
    fprintf(
        out,
        "\n'projdyn help COMMAND' prints the options of a command, 'projdyn list TYPE' the\n"
        "parameters of a constraint, 'projdyn --version' version and solvers. In the source,\n"
        "docs/guide/questions.md has short answers, docs/guide/scene.md all keys of a scene.\n");
}

/* Message for an unknown command, with the command that is at most two edits away. */
static int report_unknown(const char *name) {
    const char *near = NULL;
    for (int edits = 1; edits <= 2 && !near; edits++)
        for (int k = 0; k < COMMANDS && !near; k++)
            if (is_near(name, commands[k].name, edits)) near = commands[k].name;
    fprintf(stderr, "projdyn: unknown command \"%s\"", name);
    if (near) fprintf(stderr, ", did you mean \"%s\"?", near);
    fprintf(stderr, "\n\n");
    print_usage(stderr);
    return EXIT_BAD_INPUT;
}

static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        print_usage(stderr);
        return EXIT_BAD_INPUT;
    }
    if (!strcmp(argv[1], "version") || !strcmp(argv[1], "--version")) {
        printf("projdyn %s\nsolvers: %s\n", pdyn_version(), pdyn_solvers());
        return EXIT_GOOD;
    }
    if (argc > 2 && !strcmp(argv[1], "help")) { /* help COMMAND: COMMAND --help */
        static char option[] = "--help";
        char *help[] = {argv[0], argv[2], option, NULL};
        return dispatch(3, help);
    }
    if (!strcmp(argv[1], "help") || !strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        print_usage(stdout);
        return EXIT_GOOD;
    }
    for (int k = 0; k < COMMANDS; k++)
        if (!strcmp(argv[1], commands[k].name)) return commands[k].run(argc - 1, argv + 1);
    return report_unknown(argv[1]);
}

/* Opens /dev/null in place of closed standard streams (`2>&-`): otherwise the next file that is
 * opened gets the number of a closed stream, and messages are written into that file. The direction
 * is the wrong one on purpose, so that reading stdin and writing stdout fail as on closed streams.
 * Returns false if that is not possible. */
static bool open_closed_streams(void) {
    for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; descriptor++) {
        int direction = descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY;
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", direction) != descriptor)
            return false;
    }
    return true;
}

/* Without SIGXFSZ a file that reaches its limit of size (ulimit -f) is an error of writing, which
 * has a message. Output that cannot be flushed to stdout, for example on a full disk, turns success
 * into EXIT_FAILED. */
int main(int argc, char **argv) {
    signal(SIGXFSZ, SIG_IGN);
    if (!open_closed_streams()) return EXIT_FAILED;
    int code = dispatch(argc, argv);
    errno = 0;
    if (!fflush(stdout) && !ferror(stdout)) return code;
    fprintf(stderr, "projdyn: standard output: writing failed: %s\n",
            strerror(errno ? errno : EIO));
    return code == EXIT_GOOD ? EXIT_FAILED : code;
}
