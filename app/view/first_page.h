/* The page of a live view as the server sends it: the replay page of a run with one frame, the
 * state at the start. */
#ifndef FIRST_PAGE_H
#define FIRST_PAGE_H

#include "live.h"

/* Makes the page of a loaded scene, with its NUL, and live->run. Returns an exit code, after a
 * message unless it is EXIT_GOOD. The caller frees *page. */
int first_page_make(struct live *live, char **page);

#endif
