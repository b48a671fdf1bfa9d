/* What of a scene many settings can be tried on: all of it, a coarser twin, or the beginning. */
#ifndef EXTENT_H
#define EXTENT_H

#include "setting.h"
#include "window.h"

struct extent {
    const struct scene_options *user; /* the scene with the user's overrides */
    double coarser;                   /* how many times, for the twin; 1: none; 0: to be found */
    struct setting twin;              /* the twin's own overrides, if there is one */
    struct scene_options runs;        /* the scene with the overrides of both */
    struct window window;
};

/* length: of the window, s, or 0: as much as one run may be of so many seconds of processor time.
 * An exit code. */
int extent_find(struct extent *extent, const struct farm *farm, double length, double share);
void extent_tell(const struct extent *extent);
void extent_free(struct extent *extent);

#endif
