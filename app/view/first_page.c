/* Writes the first frame to a temporary directory and packs it as `projdyn replay` does. */
#include "first_page.h"
#include "replay_page.h"

#include <errno.h>
#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What the page needs beside the frame: the first particle of each body. */
static json_t *live_to_json(const pdyn_sim *sim) {
    json_t *first = json_array();
    for (int b = 0; b < pdyn_get_state(sim).bodies; b++)
        json_array_append_new(first, json_integer(pdyn_get_body(sim, b).first));
    return json_pack("{s:o}", "first", first);
}

static pdyn_status write_run(pdyn_sim *sim, const char *folder) {
    pdyn_writer *writer;
    pdyn_status status = pdyn_writer_open(sim, folder, false, &writer);
    if (status != PDYN_OK) return status;
    status = pdyn_writer_frame(writer);
    if (status == PDYN_OK) status = pdyn_writer_report(writer, NULL, false, NULL);
    pdyn_writer_close(writer);
    return status;
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

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *at) {
    (void)info, (void)kind, (void)at;
    remove(path);
    return 0;
}

int first_page_make(struct live *live, char **page) {
    char folder[REPLAY_PATH];
    const char *place = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%.3000s/projdyn-view-XXXXXX", place ? place : "/tmp");
    if (!mkdtemp(folder)) return report_write_error(folder);
    pdyn_status status = write_run(live->sim, folder);
    int code = status == PDYN_OK ? EXIT_GOOD : report_status(live->context, status);
    if (code == EXIT_GOOD) code = read_run(live, folder);
    if (code == EXIT_GOOD) code = print_page(&live->run, page);
    live->run.directory = NULL;
    nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    return code;
}
