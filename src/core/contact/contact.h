/* Contact of surfaces with themselves, each other, solids, and the particles of fluids.
 *
 * A pair is a vertex or a particle and a face, or two edges, that share no vertex. Where its
 * distance d is below its thickness T it has the energy
 *
 *     b(d) = k (T - d)^3 / (2 d),    -b' = k/2 (T - d)^2 (T + 2 d) / d^2,    b'' = k (T^3/d^3 - 1)
 *
 * a barrier that begins smoothly, with two derivatives, at T. It is a constraint of the rows tier,
 * one row u = sum c_k x_k, the shortest vector between the two, whose weights c are those of the
 * closest points at each local step; what is constant in it, the points of solids, is an offset.
 * Friction (friction.c) has a row per pair that was in contact at the start of the step.
 *
 * No pair ever passes through another: iterates move along straight paths that were checked
 * (contact_filter.c), from a state without intersections. Solids are pairs' partners like surfaces;
 * one that moves waits where it would pass through a surface. */
#ifndef PDYN_CONTACT_H
#define PDYN_CONTACT_H

#include "base/snapshot_file.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "rows/batch.h"
#include "scene/scene.h"

struct pdyn_sim;

struct pair {     /* that may come into contact */
    uint64_t key; /* vertex and face, or two edges, which set the highest bit */
    int point[4];
    double thickness; /* m; less than that of the scene where its rest shape is closer */
    double distance;  /* m, when the pairs were listed */
};

/* Both primitives of a pair in an element's data, with weights at the points. */
struct touching {
    uint64_t key;
    int point[4];
    double c[4];
    double offset[3]; /* m, what points of solids add to u */
    double thickness; /* m */
};

struct sticking {
    struct touching pair; /* as it was at the start of the step */
    double normal[3];
    double anchor[3]; /* m: u + offset where nothing is stretched along the surfaces */
    double limit;     /* N: friction coefficient times normal force */
};

struct remembered { /* what a friction element stretches */
    uint64_t key;
    double stretch[3]; /* m */
};

struct blocked { /* a pair that may go this part of its way */
    int pair;
    double part;
};

struct contact_solid {
    const struct scene_solid *solid;
    int first, count; /* its points */
};

struct contact {
    pdyn_context *context;
    const struct scene_contact *set;
    double ms; /* in this step */

    /* points: the vertices of surfaces and the particles of fluids, that are free, then those of
     * solids */
    int points, free, vertices;
    const bool *live;      /* particles of the system; NULL: all are */
    double *near;          /* groups, m: thickness of what belongs to them */
    const char **owner;    /* groups: names of the bodies, then of the solids */
    int *group;            /* points: body, or bodies + solid */
    int *column;           /* free: particle of the system */
    double *rest;          /* points x 3, m; of solids as placed, from the pivot where they move */
    double *at;            /* points x 3, m: at the last local step; solids where they are */
    double *x;             /* points x 3, m: where a path begins */
    int faces, free_faces; /* of surfaces first */
    int *face;             /* faces x 3 */
    int edges, free_edges, edges_room;
    int *edge; /* edges_room x 2 */
    int groups, bodies;
    struct contact_solid *solid; /* groups - bodies */
    pdyn_body body;              /* all free particles, for the batches */
    double *begin, *goal; /* (points - free) x 3, m: solids at the start and end of the step */
    bool moving, behind;  /* some solid moves; some is not at its goal */

    /* pairs */
    struct box *region;    /* points: in these, the pairs are known */
    double *built;         /* points x 3, m: where these were when the pairs were listed */
    double *moved, *reach; /* points, m: how far they are from there, and may be */
    struct box *face_box, *edge_box;       /* faces, edges_room */
    struct bvh face_tree[2], edge_tree[2]; /* of surfaces; of solids */
    int pairs, room;                       /* room: of `pair` and the arrays that go with it */
    struct pair *pair;
    int block_room, blocks; /* of the search */
    struct pair *found;     /* blocks x block_room */
    int *found_count;       /* blocks */

    /* filter */
    double *step;            /* points x 3, m: displacement */
    double *length;          /* points, m: of it */
    double *taken;           /* points: the part of the displacement that is taken */
    double *cut;             /* points: what a round takes of that; below 1 where it does */
    struct blocked *blocked; /* room */
    int *blocked_count;      /* room / grain */

    /* forces */
    struct batch *touching, *sticking; /* sticking: NULL without friction */
    struct touching *hit;              /* room: found by the local step, in blocks */
    double *hit_distance;              /* room, m */
    int *hit_count, *hit_start;        /* room / grain */
    int remembered, memory;
    struct remembered *memory_of;
};

/* Points, batches, and the check that nothing intersects; sim->objective.contact stays NULL in a
 * scene without contact. */
pdyn_status contact_create(struct pdyn_sim *sim);
void contact_free(struct contact *contact);

/* A step begins where the last local step was: solids have a new goal, where they are at a time,
 * friction starts from the contacts there. */
pdyn_status contact_begin(struct contact *contact, double time);

/* It is taken back: the next one begins again at x. */
pdyn_status contact_take_back(struct contact *contact, const double *x);

/* It ends at x, where the last local step was. */
pdyn_status contact_end(struct contact *contact);

/* What the next step depends on, besides x; reading, at x. */
void contact_persist(struct contact *contact, const double *x, struct snapshot_file *snapshot);

/* Brings target (particles x 3) back to where the paths from x lead that are free; solids come
 * along from where they were. */
pdyn_status contact_start(struct contact *contact, const double *x, double *target);

/* The least part that the last paths left of a displacement. */
double contact_least(const struct contact *contact);

/* Shortens the parts of a direction from x to free paths. */
pdyn_status contact_filter(struct contact *contact, const double *x, double *direction);

/* Solids that wait go on as far as they can, the surfaces at x. */
pdyn_status contact_advance(struct contact *contact, const double *x);

/* The elements at x: part of a local step. */
pdyn_status contact_local(struct contact *contact, const double *x);

/* ---- within contact -------------------------------------------------------------------------- */

enum { CONTACT_GRAIN = 1024 }; /* pairs */

/* No path brings a pair closer than this part of its thickness. */
#define CONTACT_LEAST 0.0625

extern const pdyn_constraint_type contact_touching, contact_sticking;

/* Knows all pairs that can come close while every point is on the way between x and x + step
 * (points x 3 each; step NULL: at x). */
pdyn_status contact_cover(struct contact *contact, const double *x, const double *step);

void contact_free_pairs(struct contact *contact);

/* Shortens contact->step to free paths from contact->x; contact->taken says by how much. */
pdyn_status contact_free_paths(struct contact *contact);

/* The list of pairs for the regions as they are. */
pdyn_status contact_list(struct contact *contact);

/* Friction at the start of a step, at its end, and after solids moved. */
pdyn_status contact_stick(struct contact *contact);
pdyn_status contact_remember(struct contact *contact);
void contact_move_friction(struct contact *contact);

/* Room for what so many elements of friction are stretched by. */
pdyn_status contact_make_memory(struct contact *contact, int count);

/* Fails where two triangles intersect. */
pdyn_status contact_check(struct contact *contact);

static inline const struct pair_kind *pair_kind_of(uint64_t key) {
    return key >> 63 ? &pair_edge_edge : &pair_vertex_face;
}

/* 3-vectors of the points of a pair. */
static inline void pair_load(const int point[4], const double *from, const double *out[4]) {
    for (int k = 0; k < 4; k++) out[k] = from + 3 * (size_t)point[k];
}

/* Force of a pair at a distance below its thickness, N, and its derivative, N/m. */
static inline double contact_force(double stiffness, double thickness, double d) {
    double depth = thickness - d;
    return 0.5 * stiffness * depth * depth * (thickness + 2.0 * d) / (d * d);
}

static inline double contact_weight(double stiffness, double thickness, double d) {
    double ratio = thickness / d;
    return stiffness * (ratio * ratio * ratio - 1.0);
}

#endif
