/* Where a probe is. It stands still in the world, or a solid or a rigid body carries it ("on"):
 *
 *     x = at + R (x_0 - rest),     x_0: place at time 0,  rest: centre of rotation at time 0,
 *                                  at, R: centre of rotation now, rotation since time 0 */
#ifndef PDYN_PROBE_PLACE_H
#define PDYN_PROBE_PLACE_H

#include <stdbool.h>

struct pdyn_sim;
struct scene_probe;

struct probe_place {
    const struct scene_probe *probe;
    bool moves;      /* false: at = rest, R = I */
    double rest[3];  /* m */
    double start[9]; /* rotation of the carrier at time 0, row by row */
    double at[3];    /* m */
    double R[9];     /* row by row */
    double *x;       /* points of the probe x 3, m: now */
};

/* At time 0; x gets the points of the probe. */
void probe_place_start(const struct pdyn_sim *sim, const struct scene_probe *probe, double *x,
                       struct probe_place *place);
/* Moves the place to the pose of its carrier at the current time. */
void probe_place_move(const struct pdyn_sim *sim, struct probe_place *place);
/* x_0 of the point x, m. */
void probe_place_return(const struct probe_place *place, const double x[3], double x_0[3]);

#endif
