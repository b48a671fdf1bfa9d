/* How `projdyn usd` shows a part: colour and the other values of a UsdPreviewSurface. */
#ifndef USD_LOOK_H
#define USD_LOOK_H

#include "run_directory.h"

struct usd_look {
    double color[3]; /* linear light */
    double opacity;  /* 0...1 */
    double roughness, ior;
    bool two_sided; /* an open surface, whose back is seen */
};

/* The look of a part: its colour, or the one that pictures give to it. Reads first frames. Returns
 * an exit code. */
int usd_find_look(const struct run *run, const struct part *part, struct usd_look *out);

#endif
