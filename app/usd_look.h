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

/* The looks of all parts but boundary points, out[run->parts]: their colours, or those that
 * pictures give to them. Reads first frames. Returns an exit code. */
int usd_find_looks(const struct run *run, struct usd_look *out);

#endif
