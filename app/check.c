/* projdyn check: loads a scene and says what is in it. */
#include "app.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

static void describe(const pdyn_sim *sim) {
    pdyn_state state = pdyn_get_state(sim);
    for (int b = 0; b < state.bodies; b++) {
        pdyn_body_info body = pdyn_get_body(sim, b);
        if (body.triangles)
            printf("body %s: %d vertices, %d triangles\n", body.name, body.count, body.triangles);
        else if (body.live == body.count)
            printf("body %s: %d particles of radius %g m\n", body.name, body.count, body.radius);
        else
            printf("body %s: %d particles of radius %g m, and room for %d more\n", body.name,
                   body.live, body.radius, body.count - body.live);
    }
    for (int k = 0; k < state.constraints; k++) {
        pdyn_constraint_info constraint = pdyn_get_constraint(sim, k);
        printf("constraint %s on %s: %d elements\n", constraint.type, constraint.body,
               constraint.elements);
    }
    printf("boundary: %d points", state.boundary);
    printf(state.moving ? ", %d of them on solids that move\n" : "\n", state.moving);
    printf("solver %s, %s step: %s\n", pdyn_solver_type(sim), pdyn_step_type(sim),
           pdyn_solver_reason(sim));
    printf("duration %g s, a frame every %g s\n", pdyn_duration(sim), pdyn_frame_interval(sim));
}

int check_main(int argc, char **argv) {
    static const struct option long_options[] = {{"set", required_argument, NULL, 's'},
                                                 {"threads", required_argument, NULL, 't'},
                                                 {"plugin", required_argument, NULL, 'p'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    static const char usage[] = "Usage: projdyn check SCENE [--set PATH=VALUE]... [--threads N] "
                                "[--plugin FILE]...\n\nReads a scene and says what is in it.\n";
    struct scene_options options = {0};
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    int option, code = EXIT_GOOD;
    while (code == EXIT_GOOD && (option = getopt_long(argc, argv, "h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            scene_options_free(&options);
            return EXIT_GOOD;
        }
        bool good = option == 's'   ? scene_set(&options, optarg)
                    : option == 'p' ? scene_plugin(&options, optarg)
                                    : option == 't' && scene_threads(&options, optarg);
        if (!good) code = EXIT_BAD_INPUT;
    }
    if (code == EXIT_GOOD && argc - optind != 1) {
        fprintf(stderr, "projdyn: check: expected one scene file\n\n%s", usage);
        code = EXIT_BAD_INPUT;
    }
    options.scene = argv[optind];
    if (code == EXIT_GOOD) code = scene_load(&options, &context, &sim);
    if (code == EXIT_GOOD) describe(sim);
    pdyn_free(sim);
    pdyn_destroy(context);
    scene_options_free(&options);
    return code;
}
