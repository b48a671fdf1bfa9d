/* What the sub-commands of projdyn share. They use nothing but the public API. */
#ifndef APP_H
#define APP_H

#include "projdyn/projdyn.h"

enum { EXIT_GOOD = 0, EXIT_FAILED = 1, EXIT_BAD_INPUT = 2, EXIT_INTERRUPTED = 130 };

/* Each gets its own name as argv[0] and returns the exit code. */
int run_main(int argc, char **argv);
int sweep_main(int argc, char **argv);
int compare_main(int argc, char **argv);
int trade_main(int argc, char **argv);
int check_main(int argc, char **argv);
int list_main(int argc, char **argv);

/* A scene and how to load it, from the options that run and check share. */
struct scene_options {
    const char *scene;
    int threads; /* 0: one per core */
    const char **set;
    int sets;
    const char **plugin; /* files */
    int plugins;
    bool silent; /* no warnings */
};

/* Takes the value of --threads; false with a message on bad ones. */
bool scene_threads(struct scene_options *options, const char *text);

/* Adds an override or a plug-in, a text that outlives the options; false with a message without
 * memory. */
bool scene_set(struct scene_options *options, const char *text);
bool scene_plugin(struct scene_options *options, const char *file);
void scene_options_free(struct scene_options *options);

/* A context whose warnings go to stderr, with the plug-ins; an exit code, not EXIT_GOOD on failure.
 */
int scene_context(const struct scene_options *options, pdyn_context **context);

/* Such a context, and the scene in it; an exit code, not EXIT_GOOD on
 * failure. */
int scene_load(const struct scene_options *options, pdyn_context **context, pdyn_sim **sim);

/* out/BEFORE + NAME for a scene .../NAME.json, to be freed; NULL with a message without memory. */
char *default_output(const char *before, const char *scene);

/* A whole number of an option, from `least` to `most`; false with a message. */
bool parse_whole(const char *option, const char *text, long least, long most, long *out);

/* Messages; both return EXIT_FAILED. The second says why by errno. */
int report_no_memory(void);
int report_unwritten(const char *path);

/* By the wall clock, and of the processor for all threads of the process. */
double wall_seconds(void);
double processor_seconds(void);

/* Removes the progress line of a terminal, before something else is said on stderr. */
void clear_progress(void);

/* What went wrong, for people. */
const char *status_message(const pdyn_context *context, pdyn_status status);

/* Prints the context's error and turns a status into an exit code. */
int report_status(const pdyn_context *context, pdyn_status status);

#endif
