/* Walls: the solids of a scene, which hide fluid and the samples of surfaces on their two sides
 * from each other. A body that stands outside of a tank feels none of the water inside. */
#ifndef PDYN_WALLS_H
#define PDYN_WALLS_H

#include "sph/occlusion.h"

struct pdyn_sim;

struct walls { /* empty in a scene without solids or without samples */
    int vertices;
    double *x;               /* vertices x 3, m: those of all solids, one after the other */
    struct border border;    /* of the solids: no strip */
    struct occlusion *hides; /* their triangles; vertices follow the particles of the system */
};

/* Creates the walls, for pairs up to `reach`, m, apart. After a failure they are to be freed, too.
 */
pdyn_status walls_create(struct pdyn_sim *sim, double reach);
void walls_free(struct pdyn_sim *sim);

/* Moves the walls to where the solids are at `time`, s. */
void walls_move(struct pdyn_sim *sim, double time);

#endif
