/* The neighbour lists' own state: neighbours.c builds the lists, visibility.c takes out of them
 * what a surface hides. */
#ifndef PDYN_NEIGHBOUR_LISTS_H
#define PDYN_NEIGHBOUR_LISTS_H

#include "geometry/grid.h"
#include "neighbours.h"

enum { NEIGHBOURS_GRAIN = 128 }; /* particles of a parallel block */

struct lists {
    /* particles, as pdyn_neighbours has them */
    int *start, *surface_start, *boundary_start, *patch_start, *end;
    int *index;      /* for each block of slots `room` and one */
    size_t capacity; /* of index */
};

/* Who sees whom: empty in a scene without surfaces. */
struct visibility {
    struct occlusion *sides; /* NULL where there is no surface */
    double *decided_at;      /* system x 3, m: where the particles were when it was decided */
    const double *state;     /* system x 3, m: where the step begins, until its first local step */
    struct lists before;     /* the lists before; of these, start and surface_start and index */
    bool known, complete;    /* those before, and these, hold every pair that they should */
    bool decided;            /* decided_at is set */
    double *granted;         /* particles, see pdyn_neighbours */
};

struct neighbours {
    pdyn_context *context;
    pdyn_neighbours view;
    double reach, surface_reach;                /* m: support and skin */
    double skin;                                /* m */
    bool *centre;                               /* particles */
    double centre_volume;                       /* m^3 */
    int system;                                 /* particles of the system, without the samples */
    int most;                                   /* particles that may take part */
    int centres, active;                        /* centres that take part; all particles that do: */
    int *id;                                    /* active: these, centres first */
    double *volume, *boundary_x;                /* points; boundary points x 3 */
    double *built_x;                            /* particles x 3: where the lists were built */
    struct grid fluid, surface, walls, patches; /* centres, samples, boundary points by kind */
    int wall_points;                            /* boundary points with volumes, */
    int *boundary_id;                           /* boundary points: these, then those with areas */
    int carried;                                /* the last boundary points, which may move */
    double *built_carried;                      /* carried x 3, where the lists were built */
    double carried_by;                          /* m, the farthest of them since then */
    struct lists lists;
    int room;    /* neighbours of a block */
    int *used;   /* a count for each block */
    bool *moved; /* a flag for each parallel block of `active` */
    bool built;
    struct visibility sight;
};

/* Memory; points->sides NULL: none. */
pdyn_status visibility_create(struct neighbours *neighbours, struct occlusion *sides);
void visibility_free(struct neighbours *neighbours);

/* Before the lists are built at x: they become those before. */
void visibility_keep(struct neighbours *neighbours, const double *x);

/* Takes what surfaces hide out of the new lists. */
void visibility_hide(struct neighbours *neighbours);

void visibility_persist(struct neighbours *neighbours, pdyn_snapshot *snapshot);

#endif
