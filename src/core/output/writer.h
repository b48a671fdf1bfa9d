/* The output directory of a run, private: writer.c opens, saves and resumes it, frames.c writes
 * frames, series.c the series of a part of them, metrics.c writes metrics.csv and probes.csv,
 * run_lock.c keeps other runs out, own_sources.c protects what the scene has read, previous_run.c
 * removes the files of the previous run. */
#ifndef PDYN_WRITER_H
#define PDYN_WRITER_H

#include "csv_file.h"
#include "output.h"

struct pdyn_writer {
    pdyn_sim *sim;
    pdyn_context *context; /* context of the simulation */
    char *path; /* path_size bytes: the directory, followed by the file of the last writer_path */
    size_t path_size, directory;
    bool ply;
    int lock; /* descriptor of the locked file DIR/lock; -1: none */
    struct csv_file metrics, probes;
    char *row; /* row_size: the current row of one of them */
    size_t row_size;
    int frames;
    size_t capacity;
    double *time; /* capacity: times of the frames, s */
    struct report report;
};

/* DIR/FILE; valid until the next call. */
const char *writer_path(pdyn_writer *writer, const char *format, ...) PDYN_PRINTF(2, 3);

/* Locks the directory for this writer, and removes the temporary files of killed runs.
 * PDYN_BAD_INPUT: another writer has the lock; the message has its process id. */
pdyn_status run_lock(pdyn_writer *writer);
void run_unlock(pdyn_writer *writer);

/* Writes the file NAME.vtk.series of each body, of the moving boundary points and of each moving
 * solid: a list of the first `frames` frames. */
pdyn_status frames_write_series(pdyn_writer *writer, int frames);
/* Makes room for the times of so many frames. */
pdyn_status frames_reserve_times(pdyn_writer *writer, int frames);

/* PDYN_BAD_INPUT: the scene has read a file of the directory that a run replaces or removes. */
pdyn_status own_sources_check(pdyn_writer *writer);
/* Whether the scene has read the file at `path`. */
bool own_source(const pdyn_sim *sim, const char *path);

/* Removes the files of the previous run in the directory that its list names. */
pdyn_status previous_run_remove(pdyn_writer *writer);
/* Removes its frames in `folder` that the series LIST/NAME.vtk.series lists; "": in the directory.
 * A series that cannot be read lists nothing. */
pdyn_status previous_run_remove_frames(pdyn_writer *writer, const char *list, const char *name,
                                       const char *folder);
/* Removes one of its files, if it exists. */
pdyn_status previous_run_remove_file(const char *path);
/* Lists the files of this run, for the next one. */
pdyn_status previous_run_list(pdyn_writer *writer);

/* Bytes of the longest row of metrics.csv and probes.csv, headers among them. */
size_t metrics_row_size(const pdyn_sim *sim);
/* Creates metrics.csv with its header, and so probes.csv in a scene with probes; otherwise removes
 * that of a previous run. */
pdyn_status metrics_open(pdyn_writer *writer);
/* Opens them and removes the rows after the saved state: these steps will be repeated. */
pdyn_status metrics_reopen(pdyn_writer *writer);

#endif
