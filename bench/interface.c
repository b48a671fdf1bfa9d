/* How exactly the surface between water and what it touches is met. Each command writes CSV files
 * into DIRECTORY and prints a table as markdown:
 *
 *     interface displaced DIRECTORY SECONDS WIDTH CONTACT_MM SHAPE:MM:EDGE...
 *         water that a pinned sheet displaces; SHAPE: level, tilted, curved; MM: particle spacing
 *         d; WIDTH of the sheet and EDGE of its mesh in d
 *     interface floating DIRECTORY SECONDS MM N SHAPE:DENSITY...
 *         draught and heave of bodies N spacings wide, the gap below what sinks; SHAPE: cube,
 *         slab (half as high as wide), ball
 *     interface tank DIRECTORY SECONDS WIDTHxDEPTH...
 *         pressure of water at rest; sizes in particles
 *     interface free DIRECTORY SECONDS WIDTH CONTACT_MM PLACE:MM:KG...
 *         drift and cost of a free sheet of KG per m^2 under water; PLACE at the start: between two
 *         layers of particles, cavity of one layer
 *     interface stream DIRECTORY MM CONTACT_MM SPEED...
 *         force on a sheet that is towed through water at rest, edge-on and broadside; m/s
 *     interface added_mass DIRECTORY CONTACT_MM SHAPE:MM...
 *         water that a sheet takes along when it is moved normal to itself; SHAPE: strip, disc
 *     interface bag DIRECTORY SECONDS MM FILL RADIUS...
 *         water in a taut bag of a RADIUS in d; FILL: volume of the water over that of the bag at
 *         rest
 *     interface dropped DIRECTORY SECONDS MM WIDTH CONTACT_MM KG PERMEABILITY...
 *         a cloth of KG per m^2 falls flat on water: height over the surface, in time
 *     interface plate DIRECTORY SECONDS MM...
 *         deflection of a clamped plate under two metres of water
 *
 * Options, anywhere: --set PATH=VALUE changes every scene, as for projdyn run; --threads N (1). */
#include "interface.h"

#include <stdlib.h>
#include <string.h>

struct command {
    const char *name, *arguments;
    void (*run)(const struct job *job);
    int count; /* minimum number of arguments */
};

static const struct command commands[] = {
    {"displaced", "SECONDS WIDTH CONTACT_MM SHAPE:MM:EDGE...", displaced, 4},
    {"floating", "SECONDS MM N SHAPE:DENSITY...", floating, 4},
    {"tank", "SECONDS WIDTHxDEPTH...", tank, 2},
    {"free", "SECONDS WIDTH CONTACT_MM PLACE:MM:KG...", free_sheets, 4},
    {"stream", "MM CONTACT_MM SPEED...", stream, 3},
    {"added_mass", "CONTACT_MM SHAPE:MM...", added_mass, 2},
    {"bag", "SECONDS MM FILL RADIUS...", bag, 4},
    {"dropped", "SECONDS MM WIDTH CONTACT_MM KG PERMEABILITY...", dropped, 6},
    {"plate", "SECONDS MM...", plate, 2},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

double job_number(const struct job *job, int argument, double otherwise) {
    char *end;
    if (argument >= job->count) return otherwise;
    double value = strtod(job->argument[argument], &end);
    if (*end || end == job->argument[argument])
        die("expected a number, found %s", job->argument[argument]);
    return value;
}

static void usage(void) {
    fprintf(stderr, "usage: interface COMMAND DIRECTORY ... [--set PATH=VALUE] [--threads N]\n");
    for (int k = 0; k < COMMANDS; k++)
        fprintf(stderr, "    %s DIRECTORY %s\n", commands[k].name, commands[k].arguments);
    exit(2);
}

static void add_set(struct job *job, const char *text) {
    static const char tolerance[] = "solver.tolerance=";
    if (job->sets == SETS) die("too many --set");
    job->set[job->sets++] = text;
    if (!strncmp(text, tolerance, sizeof tolerance - 1))
        job->tolerance = atof(text + sizeof tolerance - 1);
}

/* Removes the options from the arguments; returns the number of the others. */
static int take_options(struct job *job, int argc, char **argv, int *threads) {
    int left = 0;
    for (int k = 0; k < argc; k++) {
        bool set = !strcmp(argv[k], "--set"), many = !strcmp(argv[k], "--threads");
        if ((set || many) && k + 1 == argc) usage();
        if (set) add_set(job, argv[++k]);
        else if (many) *threads = atoi(argv[++k]);
        else argv[left++] = argv[k];
    }
    return left;
}

static void report(void *user, pdyn_log_level level, const char *message) {
    (void)user;
    if (level == PDYN_LOG_WARNING) fprintf(stderr, "interface: %s\n", message);
}

int main(int argc, char **argv) {
    struct job job = {.tolerance = 0.1};
    pdyn_options options = pdyn_default_options();
    const struct command *command = NULL;
    options.threads = 1, options.log = report;
    argc = take_options(&job, argc, argv, &options.threads);
    for (int k = 0; argc > 2 && k < COMMANDS; k++)
        if (!strcmp(argv[1], commands[k].name)) command = &commands[k];
    if (!command || argc - 3 < command->count) usage();
    job.directory = argv[2], job.count = argc - 3, job.argument = argv + 3;
    if (pdyn_create(&options, &job.context) != PDYN_OK) die("no context");
    command->run(&job);
    pdyn_destroy(job.context);
    return 0;
}
