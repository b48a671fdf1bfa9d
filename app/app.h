/* Exit codes, messages and small helpers that all sub-commands of projdyn share. The commands
 * use the public API of libprojdyn alone. */
#ifndef APP_H
#define APP_H

#include "projdyn/projdyn.h"

#include <getopt.h>

enum { EXIT_GOOD = 0, EXIT_FAILED = 1, EXIT_BAD_INPUT = 2, EXIT_INTERRUPTED = 130 };

/* Entry points of the commands. argv[0] is the name of the command; the result is the exit code. */
int run_main(int argc, char **argv);
int sweep_main(int argc, char **argv);
int compare_main(int argc, char **argv);
int trade_main(int argc, char **argv);
int check_main(int argc, char **argv);
int list_main(int argc, char **argv);
int mesh_main(int argc, char **argv);
int usd_main(int argc, char **argv);
int replay_main(int argc, char **argv);
int view_main(int argc, char **argv);
int render_main(int argc, char **argv);

/* Default output directory: out/PREFIX + NAME for a scene file .../NAME.json. The caller frees
 * the text; NULL with a message if memory ran out. */
char *default_output(const char *prefix, const char *scene);

/* Reads the options of a command with getopt_long, letters and `options` as there; 'h' prints
 * `usage`. accept: takes one option and optarg; false if it is refused, with a message. Returns -1
 * if the command can go on, EXIT_GOOD after the usage, EXIT_BAD_INPUT, or EXIT_FAILED if memory ran
 * out. */
int parse_options(int argc, char **argv, const char *letters, const struct option *options,
                  const char *usage, bool (*accept)(void *self, int option), void *self);

/* Whether the edit distance (insertions, deletions, substitutions) of two words is at most
 * `edits`. */
bool is_near(const char *a, const char *b, int edits);

/* Parses the integer argument of an option, min <= *out <= max; false with a message otherwise. */
bool parse_integer(const char *option, const char *text, int min, int max, int *out);

/* Longest duration of a scene, s (schema/scene.schema.json). */
#define LONGEST_DURATION 1e6
/* Parses the argument of an option, a time above 0 and at most `longest` (or INFINITY) in s; false
 * with a message otherwise. */
bool parse_seconds(const char *option, const char *text, double longest, double *time);
/* Parses the argument A:B of --frames; false with a message otherwise. */
bool parse_frames(const char *text, long *first, long *last);
/* Writes the shortest text that gives the same number. */
void print_shortest(char text[32], double value);
/* A duration for people: 4.2 s, 35 min, 18 h. */
struct rounded_time {
    char text[32];
};
struct rounded_time rounded_time(double seconds);

/* Print a message to stderr and return EXIT_FAILED. report_no_memory() sets errno to ENOMEM;
 * report_write_error() appends the text of errno. */
int report_no_memory(void);
int report_write_error(const char *path);
/* Prints what a command expected as its arguments, those behind its options, and the first
 * paragraph of its usage; returns EXIT_BAD_INPUT. */
int report_usage(char **argv, const char *expected, const char *usage);

/* A path or an override as a word of a command line that a message suggests: in quotes where the
 * shell needs them, shortened beyond the size. */
struct shell_word {
    char text[4104];
};
struct shell_word shell_word(const char *path);

/* Wall-clock time, s, from an arbitrary origin. */
double wall_seconds(void);
/* Processor time of the process, s, summed over its threads. */
double processor_seconds(void);

/* Cores that this process may use: `taskset` and batch systems grant a part of them. */
int usable_cores(void);

/* Erases the progress line of `projdyn run` if stderr is a terminal; call it before other output
 * to stderr. */
void clear_progress(void);

/* Prints pdyn_last_error() to stderr. Returns EXIT_BAD_INPUT for PDYN_BAD_INPUT and
 * PDYN_BAD_CALL, EXIT_FAILED for every other status. */
int report_status(const pdyn_context *context, pdyn_status status);

/* The end of body b in arrays of all particles. Behind the vertices of a rigid body are the points
 * that have its mass. */
int body_end(const pdyn_sim *sim, int b);

#endif
