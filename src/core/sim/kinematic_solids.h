/* Solids with prescribed motion: their boundary points are stored at rest and moved to the pose at
 * a given time. */
#ifndef PDYN_KINEMATIC_SOLIDS_H
#define PDYN_KINEMATIC_SOLIDS_H

#include "base/snapshot_file.h"
#include "geometry/point_list.h"
#include "scene/scene.h"

struct pdyn_sim;

struct moving_solid { /* one solid with prescribed motion */
    const struct scene_solid *solid;
    int first, count; /* its boundary points */
    struct box box;   /* m, of the points at rest */
};

struct kinematic_solids { /* empty if no solid moves */
    int solids, capacity;
    struct moving_solid *solid; /* capacity */
    int points;             /* number of points of all moving solids: the last boundary points */
    struct point_list rest; /* m: these points at rest */
    struct point_list rest_layer; /* m: the same of layer_x (pdyn_neighbours); empty if unused */
    struct point_list layer;      /* m: layer_x, or empty */
};

/* Registers the boundary points from index `first` on as those of a moving solid. */
pdyn_status kinematic_add(struct pdyn_sim *sim, const struct scene_solid *solid, int first);
void kinematic_free(pdyn_context *context, struct kinematic_solids *moving);

/* The first boundary point on a moving solid; all later ones are on moving solids, too. */
int kinematic_first_point(const struct pdyn_sim *sim);

/* Moves the boundary points to their positions at `time`, s, and informs the neighbour lists. */
void kinematic_move(struct pdyn_sim *sim, double time);

/* Writes or reads the keys of all moving solids. */
void kinematic_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

/* Upper bound of the speed of a point between two times, s: m/s. It is the speed of the corners of
 * the bounding boxes, which is slightly too large. */
double kinematic_speed(const struct kinematic_solids *moving, double from, double to);

/* The same of all solids of the scene from its start to its end, by their meshes. Solids have no
 * boundary points in a scene without fluid. */
double kinematic_top_speed(const struct pdyn_sim *sim);

#endif
