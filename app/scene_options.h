/* Options that every command with a scene shares: the scene file and its overrides (--set),
 * plug-ins (--plugin), permission for plug-ins of the scene (--allow-plugins) and worker threads
 * (--threads). */
#ifndef SCENE_OPTIONS_H
#define SCENE_OPTIONS_H

#include "app.h"

#include "projdyn/scene.h"

struct scene_options {
    const char *scene; /* path of the scene file */
    int threads;       /* worker threads; 0: one per core */
    const char **set;  /* sets: overrides PATH=VALUE of scene values */
    int sets;
    const char **plugin; /* plugins: paths of plug-in files, loaded before the scene */
    int plugins;
    bool silent; /* suppresses warnings; may change while a context is there */
};

/* The four options for the table of parse_options, and the function that takes one of them: false,
 * with a message if it is one of them. */
#define SCENE_OPTIONS                                                                              \
    {"set", required_argument, NULL, 's'}, {"threads", required_argument, NULL, 't'},              \
        {"plugin", required_argument, NULL, 'P'}, {                                                \
        "allow-plugins", no_argument, NULL, 'A'                                                    \
    }
bool scene_accept_option(struct scene_options *options, int option);

/* Append an override or a plug-in file. The text is not copied and must outlive the options.
 * false with a message if memory ran out. */
bool scene_set(struct scene_options *options, const char *text);
bool scene_plugin(struct scene_options *options, const char *file);

/* Permission to load plug-ins that a scene or a run.json names: --allow-plugins sets
 * PROJDYN_ALLOW_PLUGINS=1 in the environment, so that the runs that this process starts have the
 * permission, too. */
bool scene_plugins_allowed(void);

void scene_options_free(struct scene_options *options);

/* Creates a context that prints warnings to stderr, and loads the plug-ins into it. Returns
 * EXIT_GOOD, or another exit code after a message. The caller destroys *context in both cases,
 * before the options end. */
int scene_context(const struct scene_options *options, pdyn_context **context);

/* Creates a context as scene_context() does, opens the scene file and applies the overrides.
 * Returns EXIT_GOOD, or another exit code after a message. The caller frees *scene and *context in
 * both cases. */
int scene_open(const struct scene_options *options, pdyn_context **context, pdyn_scene **scene);

/* Creates a context as scene_context() does and loads the scene into *sim. Returns EXIT_GOOD, or
 * another exit code after a message. The caller frees *sim and *context in both cases. */
int scene_load(const struct scene_options *options, pdyn_context **context, pdyn_sim **sim);

/* EXIT_FAILED, after a message, if the simulation has warnings and `strict` is set; otherwise
 * EXIT_GOOD. */
int warnings_exit_code(const pdyn_sim *sim, bool strict);

#endif
