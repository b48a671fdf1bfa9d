/* The motion of a solid or an inlet that a program gives while the simulation runs. */
#ifndef PDYN_GIVEN_MOTION_H
#define PDYN_GIVEN_MOTION_H

#include "base/snapshot_file.h"
#include "scene/scene.h"

struct pdyn_sim;

struct scene_key given_key(double time, const double translate[3], const double rotate[3]);

/* The pose at a time, s, as a key. The motion has keys. */
struct scene_key given_motion_at(const struct scene_motion *motion, double time);

/* Replaces the keys: from the pose now to `to`, where it rests. PDYN_BAD_INPUT: no keys before, a
 * time that is not after the current one, a number out of range; the error text begins with
 * `what`. */
pdyn_status given_motion(struct pdyn_sim *sim, struct scene_motion *motion, const char *what,
                         const struct scene_key *to);

/* Writes or reads the keys, if there are any in the scene. */
void given_motion_persist(struct pdyn_sim *sim, struct scene_motion *motion,
                          struct snapshot_file *snapshot);

#endif
