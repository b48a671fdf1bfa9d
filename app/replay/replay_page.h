/* Parts of the HTML page that `projdyn replay` writes. */
#ifndef REPLAY_PAGE_H
#define REPLAY_PAGE_H

#include "replay_run.h"

/* Write the page of a run whose ranges are known, to an open file or to a new one. Return an exit
 * code, after a message unless it is EXIT_GOOD; of a failed write to the open file there is none,
 * see ferror(). */
int replay_print_page(const struct run *run, FILE *file);
int replay_write_page(const struct run *run, const char *path);

/* Metadata for the placeholder @META@: times, parts, facts about the run, columns for the plots.
 * The caller releases the object; NULL if memory ran out. */
json_t *replay_metadata(const struct run *run);

/* The page as joined at build time from the files of page/ (embed_page.py), NUL-terminated, with
 * the placeholders @META@ and @DATA@. */
extern const char replay_template[];

#endif
