/* Options that describe a scene, and loading the scene with them. */
#include "scene_options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool append_text(const char ***list, int *count, const char *text) {
    const char **longer = realloc(*list, (size_t)(*count + 1) * sizeof *longer);
    if (!longer) return report_no_memory(), false;
    *list = longer;
    longer[(*count)++] = text;
    return true;
}

bool scene_set(struct scene_options *options, const char *text) {
    return append_text(&options->set, &options->sets, text);
}

bool scene_plugin(struct scene_options *options, const char *file) {
    return append_text(&options->plugin, &options->plugins, file);
}

static const char allow_plugins[] = "PROJDYN_ALLOW_PLUGINS";

static bool permit_plugins(void) {
    if (!setenv(allow_plugins, "1", 1)) return true;
    return report_no_memory(), false;
}

bool scene_plugins_allowed(void) {
    const char *value = getenv(allow_plugins);
    return value && !strcmp(value, "1");
}

bool scene_accept_option(struct scene_options *options, int option) {
    if (option == 's') return scene_set(options, optarg);
    if (option == 't') return parse_integer("--threads", optarg, 1, 1024, &options->threads);
    if (option == 'P') return scene_plugin(options, optarg);
    return option == 'A' && permit_plugins();
}

void scene_options_free(struct scene_options *options) {
    free(options->set);
    free(options->plugin);
}

static void print_warning(void *user, pdyn_log_level level, const char *message) {
    if (((const struct scene_options *)user)->silent) return;
    clear_progress();
    fprintf(stderr, "projdyn: %s%s\n", level == PDYN_LOG_WARNING ? "warning: " : "", message);
}

int scene_context(const struct scene_options *options, pdyn_context **context) {
    pdyn_options settings = pdyn_default_options();
    settings.threads = options->threads;
    settings.log = print_warning, settings.log_user = (void *)options;
    settings.refuse_scene_plugins = !scene_plugins_allowed();
    pdyn_status status = pdyn_create(&settings, context);
    for (int k = 0; k < options->plugins && status == PDYN_OK; k++)
        status = pdyn_load_plugin(*context, options->plugin[k]);
    return status == PDYN_OK ? EXIT_GOOD : report_status(*context, status);
}

/* The exit code after loading. PDYN_IO_FAILED means here that the scene, or a file that it names,
 * cannot be read, and is bad input. */
static int loading_exit_code(const pdyn_context *context, pdyn_status status) {
    if (status == PDYN_OK) return EXIT_GOOD;
    int code = report_status(context, status);
    return status == PDYN_IO_FAILED ? EXIT_BAD_INPUT : code;
}

int scene_open(const struct scene_options *options, pdyn_context **context, pdyn_scene **scene) {
    int failed = scene_context(options, context);
    *scene = NULL;
    if (failed) return failed;
    pdyn_status status = pdyn_scene_open(*context, options->scene, scene);
    if (status == PDYN_OK) status = pdyn_scene_override(*scene, options->set, options->sets);
    return loading_exit_code(*context, status);
}

int scene_load(const struct scene_options *options, pdyn_context **context, pdyn_sim **sim) {
    int failed = scene_context(options, context);
    *sim = NULL;
    if (failed) return failed;
    pdyn_status status = pdyn_load(*context, options->scene, options->set, options->sets, sim);
    return loading_exit_code(*context, status);
}

int warnings_exit_code(const pdyn_sim *sim, bool strict) {
    if (!strict || !pdyn_get_warning(sim, 0).code) return EXIT_GOOD;
    fprintf(stderr, "projdyn: --strict: there are warnings\n");
    return EXIT_FAILED;
}
