/* Neighbour lists for SPH sums: Verlet lists with a skin. */
#ifndef PDYN_NEIGHBOURS_H
#define PDYN_NEIGHBOURS_H

#include "base/context.h"
#include "base/snapshot_file.h"
#include "geometry/grid.h"
#include "occlusion.h"
#include "projdyn/module.h"
#include "surface_samples.h"

/* A list holds every pair closer than its support plus the skin. It stays complete until a particle
 * has moved by half the skin, or less if boundary points move, too. Pairs are a centre (a fluid
 * particle) with another centre, with a surface sample (both ways), and with a boundary point. Two
 * centres, or a centre and a boundary point, that had a surface between them when the lists were
 * built are no pair: nothing passes through a surface, so it stays between them. Nor are a centre
 * and a sample on two sides of a solid.
 *
 * A surface may be much larger than the fluid. Its samples outside the box of the centres, grown by
 * the support and two skins, are not near: they have no list, and neither their positions nor their
 * volumes are needed until the next build. */
struct neighbours;

struct kernel_model;

struct neighbours_def { /* all arrays but layer_x, face_x and wall_x are copied */
    int particles; /* particles of the system, then the surface samples, which are active but no
                      centres */
    const bool *centre; /* particles: is a fluid particle */
    int boundary;
    const double *boundary_x; /* boundary x 3, m */
    int moving;               /* number of boundary points that may move: the last ones */
    const double *layer_x;    /* see pdyn_neighbours; NULL, or not copied and must stay valid */
    const double *volume; /* m^3, particles, then boundary points; 0: the particle is not active */
    const bool *is_wall;  /* boundary: the point has a volume and the support of centres */
    double support, surface_support; /* m, see pdyn_neighbours */
    double skin;                     /* m */
    bool has_volumes;                /* see pdyn_neighbours */
    const struct kernel_model *kernel;
    struct occlusion *occlusion; /* surfaces that separate pairs, or NULL; not copied */
    const double *face_x; /* with occlusion: boundary x 3, m: the foot of a point of a vessel on its
                             face, of other points the point; not copied, must stay valid */
    struct occlusion *walls; /* solids that separate centres from samples, or NULL; not copied */
    const double *wall_x;    /* their vertices, which follow the particles of the system in `walls`,
                                x 3, m; not copied, must stay valid */
    int wall_vertices;
    const struct surface_samples *samples; /* the last particles, or NULL; must stay valid */
};

/* Creates neighbour lists. Memory: 129 bytes per particle, 108 per boundary point, 24 more if it
 * may move, and 5 per neighbour (about 55 per particle); with surfaces 40 more per particle, 1 more
 * per boundary point and 4 more per neighbour. */
pdyn_status neighbours_create(pdyn_context *context, const struct neighbours_def *def,
                              struct neighbours **out);
void neighbours_free(struct neighbours *neighbours);

/* Makes the centres with live[i] active and the others inactive; the lists must be built again. All
 * centres must have the same volume; the centres with a volume at creation are the most that can be
 * active at once. apart: particles, or NULL; must stay valid: where it is not 0, a particle has no
 * neighbours on surfaces and solids. */
void neighbours_set_live(struct neighbours *neighbours, const bool *live, const int *apart);
/* Numbers of the surface samples that are near since the last build, after the particles of the
 * system; *count of them. */
const int *neighbours_near(const struct neighbours *neighbours, int *count);
/* Copies the volumes of near samples. */
void neighbours_set_sample_volumes(struct neighbours *neighbours,
                                   const struct surface_samples *samples);
/* Moves the boundary points that may move to x (moving x 3, m). */
void neighbours_move_boundary(struct neighbours *neighbours, const double *x);

/* Whether the lists are complete at x (particles x 3, m; of samples, those that are near). */
bool neighbours_are_valid(struct neighbours *neighbours, const double *x);

/* Builds the lists at x (particles x 3, m) and increments their revision. PDYN_DIVERGED: a position
 * is not finite or more than GRID_RANGE cells from the origin (geometry/grid.h), or there are more
 * than 2^31 neighbours. */
pdyn_status neighbours_build(struct neighbours *neighbours, const double *x);

/* Saves the positions of the last build, or reads them and builds the lists there. Before reading,
 * neighbours_set_live must have been called; after it, neighbours_move_boundary must be called. */
void neighbours_persist(struct neighbours *neighbours, struct snapshot_file *snapshot);

/* Positions at the last build, particles x 3, m. */
const double *neighbours_built_at(const struct neighbours *neighbours);

/* Begins a step at x (system x 3, m), which must not change until the step ends. */
void neighbours_begin_step(struct neighbours *neighbours, const double *x);

/* Call after the first local step of a step: lists that are built later in the step hide the same
 * pairs. */
void neighbours_freeze_visibility(struct neighbours *neighbours);

/* Ends a step. */
void neighbours_end_step(struct neighbours *neighbours);

/* Calls `visit` with every centre closer than `radius` to `at`, m, at the x of the last local step,
 * and with some others. */
void neighbours_visit(const struct neighbours *neighbours, const double *at, double radius,
                      grid_visit_fn *visit, void *user);

const pdyn_neighbours *neighbours_view(const struct neighbours *neighbours);

#endif
