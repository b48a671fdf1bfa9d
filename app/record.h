/* What a run was started with, kept in its directory so that it can go on: DIR/run.json. */
#ifndef RECORD_H
#define RECORD_H

#include "app.h"

/* Writes it, whole or not at all; EXIT_GOOD, or an exit code with a message. */
int record_write(const char *directory, const struct scene_options *options);

/* Adds scene, overrides and plug-ins to the options. The texts belong to *record, an opaque value
 * to give to record_free. */
int record_read(const char *directory, struct scene_options *options, void **record);
void record_free(void *record);

#endif
