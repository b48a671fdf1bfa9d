/* projdyn check: loads a scene and prints its contents, or runs the conformance tests of a
 * plug-in. */
#include "scene_options.h"
#include "scene_summary.h"
#include "time_estimate.h"

#include "projdyn/conformance.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- plug-ins -------------------------------------------------------------------------------- */

static void print_fault(void *user, const char *text) {
    (void)user;
    printf("fault: %s\n", text);
    fflush(stdout);
}

/* Prints every fault that the conformance tests find; EXIT_FAILED if there is one. */
static int check_plugins(const struct scene_options *options) {
    pdyn_context *context = NULL;
    int faults = 0, code = scene_context(options, &context);
    if (code == EXIT_GOOD) {
        pdyn_status status = pdyn_conformance(context, NULL, print_fault, NULL, &faults);
        if (status != PDYN_OK) code = report_status(context, status);
        else if (faults) printf("%d fault%s\n", faults, faults == 1 ? "" : "s");
        else puts("no faults");
    }
    pdyn_destroy(context);
    return code == EXIT_GOOD && faults ? EXIT_FAILED : code;
}

/* Runs check_plugins() in a child process, so that a crash of the plug-in is reported as a
 * fault. */
static int check_plugins_in_child(const struct scene_options *options) {
    int status;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        int code = check_plugins(options);
        fflush(stdout);
        _exit(code);
    }
    if (child < 0 || waitpid(child, &status, 0) != child) {
        fprintf(stderr, "projdyn: check: %s\n", strerror(errno));
        return EXIT_FAILED;
    }
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    printf(
        "fault: the plug-in crashed (%s); a type that reads triangles, edges or tetrahedra of its "
        "body says PDYN_ON_SURFACE or PDYN_ON_VOLUME, one that reads neighbour lists "
        "PDYN_NEIGHBOURS; `update` writes at most `room` elements\n",
        strsignal(WTERMSIG(status)));
    return EXIT_FAILED;
}

/* ---- arguments ------------------------------------------------------------------------------- */

static const char usage[] =
    "Usage: projdyn check SCENE [--set PATH=VALUE]... [--threads N] [--plugin FILE]...\n"
    "                     [--allow-plugins] [--strict]\n"
    "       projdyn check --conformance PLUGIN\n"
    "\n"
    "Loads a scene and prints its bodies, constraints, solver, and use of memory and disk; makes\n"
    "its first steps and prints how long a run takes. Warnings name values that are legal but\n"
    "rarely meant.\n"
    "With --strict: exit code 1 if there is a warning.\n"
    "With --allow-plugins: loads the plug-ins that the scene names.\n"
    "With --conformance: tests whether the constraint types and solvers of a plug-in obey the\n"
    "interface of projdyn/module.h and prints each fault; exit code 1 if there is one.\n";

struct check_options {
    struct scene_options scene;
    bool conformance, strict;
};

static bool accept_option(void *self, int option) {
    struct check_options *check = self;
    if (option == 'S') return check->strict = true;
    if (option != 'c') return scene_accept_option(&check->scene, option);
    check->conformance = true;
    return scene_plugin(&check->scene, optarg);
}

static int check_scene(const struct check_options *check) {
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    int code = scene_load(&check->scene, &context, &sim);
    if (code == EXIT_GOOD) {
        code = print_scene_summary(context, sim);
        if (code == EXIT_GOOD) code = print_time_estimate(context, sim);
    }
    if (code == EXIT_GOOD) code = warnings_exit_code(sim, check->strict);
    pdyn_free(sim);
    pdyn_destroy(context);
    return code;
}

/* The check of plug-ins writes scenes of its own. */
static int refuse_scene(const struct check_options *check, const char *scene) {
    if (!scene && !check->scene.sets && !check->strict) return -1;
    fprintf(stderr, "projdyn: --conformance: expected no scene file, --set or --strict: it checks "
                    "the types of a plug-in with the defaults of their parameters\n");
    return EXIT_BAD_INPUT;
}

int check_main(int argc, char **argv) {
    static const struct option long_options[] = {SCENE_OPTIONS,
                                                 {"conformance", required_argument, NULL, 'c'},
                                                 {"strict", no_argument, NULL, 'S'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    struct check_options check = {0};
    int code = parse_options(argc, argv, "h", long_options, usage, accept_option, &check);
    if (code < 0 && check.conformance) code = refuse_scene(&check, argv[optind]);
    else if (code < 0 && argc - optind != 1) code = report_usage(argv, "one scene file", usage);
    check.scene.scene = argv[optind];
    if (code < 0)
        code = check.conformance ? check_plugins_in_child(&check.scene) : check_scene(&check);
    scene_options_free(&check.scene);
    return code;
}
