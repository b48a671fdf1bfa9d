/* Springs between bodies (attachments) for the page. */
#ifndef REPLAY_STRINGS_H
#define REPLAY_STRINGS_H

#include "run_directory.h"

/* "strings" of report.json, where the vertices of a body with a skin are replaced by the closest
 * points of the skin in the first frame; an empty array without a report. NULL: a frame cannot be
 * read, after a message, or no memory. */
json_t *replay_strings(const struct run *run);

#endif
