/* Writes the state of a live view as a run of one frame. */
#include "save.h"
#include "run_record.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { NAMES = 10000 }; /* numbers that are tried */

/* Makes the directory SCENE_live_N with the smallest free N; false with errno. */
static bool make_directory(const char *scene, char **path) {
    const char *slash = strrchr(scene, '/'), *name = slash ? slash + 1 : scene;
    const char *dot = strrchr(name, '.');
    int length = dot ? (int)(dot - name) : (int)strlen(name);
    for (int n = 1; n < NAMES; n++) {
        if (asprintf(path, "%.*s_live_%d", length, name, n) < 0) return *path = NULL, false;
        if (!mkdir(*path, 0777)) return true;
        free(*path);
        *path = NULL;
        if (errno != EEXIST) return false;
    }
    return false;
}

pdyn_status save_frame(pdyn_sim *sim, const char *folder, bool state) {
    pdyn_writer *writer;
    pdyn_status status = pdyn_writer_open(sim, folder, false, &writer);
    if (status != PDYN_OK) return status;
    status = pdyn_writer_frame(writer);
    if (status == PDYN_OK) status = pdyn_writer_report(writer, NULL, false, NULL);
    if (status == PDYN_OK && state) status = pdyn_writer_save(writer);
    pdyn_writer_close(writer);
    return status;
}

void save_run(struct live *live) {
    char *path = NULL;
    if (!make_directory(live->scene->scene, &path)) {
        live_note(live, true, "cannot make a directory: %s", strerror(errno));
        return;
    }
    bool plugins = live->scene->plugins || scene_plugins_allowed();
    pdyn_status status = save_frame(live->sim, path, true);
    bool recorded =
        status == PDYN_OK && run_record_write(path, live->scene, 0.0, false) == EXIT_GOOD;
    if (recorded)
        live_note(live, false, "saved to %s; to continue: projdyn run --resume %s%s --time %.4g",
                  path, shell_word(path).text, plugins ? " --allow-plugins" : "",
                  pdyn_time(live->sim) + 1.0);
    else
        live_note(live, true, "%s: %s", path,
                  status == PDYN_OK ? "run.json cannot be written"
                                    : pdyn_last_error(live->context));
    free(path);
}
