/* Writes the first frame to a temporary directory and packs it as `projdyn replay` does. */
#include "first_page.h"
#include "replay_page.h"
#include "save.h"
#include "temporary_folder.h"

#include <stdio.h>

/* What the page needs beside the frame: the first particle of each body. */
static json_t *live_to_json(const pdyn_sim *sim) {
    json_t *first = json_array();
    for (int b = 0; b < pdyn_get_state(sim).bodies; b++)
        json_array_append_new(first, json_integer(pdyn_get_body(sim, b).first));
    return json_pack("{s:o}", "first", first);
}

/* Facts of a run that has ended are left out. */
static int read_run(struct live *live, const char *folder) {
    live->run = (struct run){.directory = folder, .live = live_to_json(live->sim)};
    if (!live->run.live) return report_no_memory();
    int code = replay_load(&live->run);
    json_object_del(live->run.report, "wall_s");
    json_object_del(live->run.report, "simulated_s");
    return code;
}

static int print_page(const struct run *run, char **page) {
    size_t size;
    FILE *file = open_memstream(page, &size);
    if (!file) return report_no_memory();
    int code = replay_print_page(run, file);
    return fclose(file) && code == EXIT_GOOD ? report_no_memory() : code;
}

int first_page_make(struct live *live, char **page) {
    char folder[TEMPORARY_FOLDER];
    int code = temporary_folder_make("view", folder);
    if (code != EXIT_GOOD) return code;
    pdyn_status status = save_frame(live->sim, folder, false);
    if (status != PDYN_OK) code = report_status(live->context, status);
    if (code == EXIT_GOOD) code = read_run(live, folder);
    if (code == EXIT_GOOD) code = print_page(&live->run, page);
    live->run.directory = NULL;
    temporary_folder_remove(folder);
    return code;
}
