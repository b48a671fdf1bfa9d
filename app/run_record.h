/* DIR/run.json: the scene, overrides, plug-ins, end and --no-frames that a run was started with.
 * `projdyn run --resume` reads them back. */
#ifndef RUN_RECORD_H
#define RUN_RECORD_H

#include "scene_options.h"

/* Whether DIRECTORY is the folder of a run: it has a run.json. */
bool run_record_exists(const char *directory);
/* Whether that run was interrupted, or killed, and can be resumed. */
bool run_record_is_unfinished(const char *directory);

/* Writes DIRECTORY/run.json atomically (to a temporary file, then rename). `end`: s; 0: that of the
 * scene; no_frames: the run writes none. Returns EXIT_GOOD, or another exit code after a message.
 */
int run_record_write(const char *directory, const struct scene_options *options, double end,
                     bool no_frames);

/* Adds scene, overrides and plug-ins of DIRECTORY/run.json to the options, and gives end and
 * no_frames as above. The texts belong to *record, an opaque value that the caller passes to
 * run_record_free(). Returns EXIT_GOOD, or another exit code after a message. */
int run_record_read(const char *directory, struct scene_options *options, double *end,
                    bool *no_frames, void **record);
void run_record_free(void *record);

#endif
