/* Private state of the neighbour lists: neighbour_points.c says which points have one, neighbours.c
 * builds the lists, visibility.c removes from them the pairs that a surface separates. */
#ifndef PDYN_NEIGHBOUR_LISTS_H
#define PDYN_NEIGHBOUR_LISTS_H

#include "geometry/grid.h"
#include "neighbours.h"

#include <stdatomic.h>

enum { NEIGHBOURS_GRAIN = 128, BOUNDARY_GRAIN = 4096 }; /* points per block of a parallel loop */

struct lists {
    /* particles, as in pdyn_neighbours */
    int *start, *surface_start, *boundary_start, *patch_start, *end;
    int *index;      /* `room` + 1 entries for each block of particles */
    size_t capacity; /* length of index */
};

/* Visibility of pairs; empty in a scene without surfaces. */
struct visibility {
    struct occlusion *occlusion; /* NULL: no surfaces */
    struct occlusion *walls;     /* NULL: no solids or no samples */
    const struct surface_samples *samples;
    const double *face_x, *wall_x; /* of neighbours_def */
    int wall_vertices;
    double *frozen_x;     /* system and vertices of walls x 3, m: positions at which visibility was
                             decided; NULL: nothing hides */
    const double *step_x; /* system x 3, m: positions at the start of the step; NULL after its first
                             local step */
    struct lists previous;  /* the lists built before; of these start, surface_start and index */
    bool previous_complete; /* the previous lists contain every pair they should */
    bool complete;          /* the current lists do */
    bool frozen;            /* frozen_x is set */
    double *granted;        /* particles, see pdyn_neighbours */
    atomic_bool *doubtful;  /* boundary points: scratch */
};

/* Boundary points with volumes and with areas; those that rest are sorted once. */
enum { WALLS, MOVING_WALLS, PATCHES, MOVING_PATCHES, BOUNDARY_PARTS };

struct neighbours {
    pdyn_context *context;
    pdyn_neighbours view;
    double reach, surface_reach; /* m: support plus skin */
    double skin;                 /* m */
    bool *centre;                /* particles: is a fluid particle */
    const int *apart;            /* of neighbours_set_live */
    double centre_volume;        /* m^3 */
    int system;                  /* particles of the system, surface samples not included */
    const double *far_volume;    /* m^3: samples that are not near, their rest volumes; or NULL */
    int max_centres;             /* largest number of active fluid particles */
    int surface_points;          /* number of samples */
    int surface_room;            /* those for which `index` has room */
    int centres;                 /* number of active fluid particles */
    int active;                  /* the same, and the near samples */
    int *id;                     /* active: their indices, centres first; by the last build */
    double *volume, *boundary_x; /* points; boundary points x 3, m */
    double *built_x;             /* particles x 3, m: positions at the last build */
    struct grid fluid, surface;  /* centres; surface samples */
    struct grid boundary[BOUNDARY_PARTS]; /* boundary points */
    int part[BOUNDARY_PARTS + 1]; /* first entry of each part in boundary_id; their number */
    int *boundary_id;             /* boundary points, by parts */
    int moving;                   /* number of boundary points that may move: the last ones */
    double *built_moving_x;       /* moving x 3, m: their positions at the last build */
    double boundary_shift; /* m, largest displacement of a moving boundary point since the last
                              build */
    struct lists lists;
    int room;        /* capacity of a block, in neighbours */
    int *used;       /* blocks: neighbours used */
    bool *displaced; /* parallel blocks of particles: one has left its skin */
    bool built;
    struct visibility visibility;
};

/* Counts the particles that may have a list, and sorts boundary points into parts. */
void neighbour_points_count(struct neighbours *neighbours, const struct neighbours_def *def);
/* Lists the active centres, then the samples that are near these at x (particles x 3, m). */
void neighbour_points_list(struct neighbours *neighbours, const double *x);
/* The list of particle i is empty. */
void neighbour_points_clear(struct neighbours *neighbours, int i);

/* Allocates the state; without occlusion none. */
pdyn_status visibility_create(struct neighbours *neighbours, const struct neighbours_def *def);
void visibility_free(struct neighbours *neighbours);

/* Before a build at x: the current lists become the previous ones. */
void visibility_store_lists(struct neighbours *neighbours, const double *x);

/* Removes the pairs that surfaces separate from the new lists. */
void visibility_filter_lists(struct neighbours *neighbours);

void visibility_persist(struct neighbours *neighbours, struct snapshot_file *snapshot);

#endif
