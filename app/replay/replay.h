/* projdyn replay: packs the frames of a run into one HTML page. */
#ifndef REPLAY_H
#define REPLAY_H

#include <stddef.h>

struct run;

/* Writes the page of a surveyed run into a file; returns the exit code, after a message if it is
 * not good. */
int replay_write(const struct run *run, const char *path);

/* The page with its placeholders @META@ and @DATA@, replay.html as it was when this was built. */
extern const char replay_page[];
size_t replay_page_size(void);

#endif
