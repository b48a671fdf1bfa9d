/* The data of contact (contact.h), part by part, and what its files call of each other. */
#ifndef PDYN_CONTACT_PARTS_H
#define PDYN_CONTACT_PARTS_H

#include "contact.h"

#include "base/sort_by_key.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "rows/row_memory.h"
#include "scene/scene.h"

#include <stdatomic.h>

struct pair {         /* two primitives that may come into contact */
    uint64_t key;     /* highest bit: two edges; the bits from 32: number of the vertex or of the
                         first edge; the lower ones: number of the face or of the second edge */
    int point[4];     /* of the first primitive, then of the second */
    double thickness; /* m: of the scene, or less where the two are closer in the rest shape */
    double distance;  /* m: at `seen`, or less */
};

struct hit { /* a pair that is closer than its thickness */
    int pair;
    double distance; /* m */
    double c[4];     /* the shortest vector is the sum of c_k x_k over the points of the pair */
};

struct stencil { /* of a contact: its shortest vector is the sum of c_k x_k */
    int point[4];
    double c[4];
};

struct contact_list {
    pdyn_contacts view; /* what constraints see; the first member (contact_list_vertices) */
    int room;
    pdyn_contact *contact;   /* room */
    struct stencil *stencil; /* room: of the same contacts */
    uint64_t *key;           /* room: scratch, their keys */
    double *force;           /* room: scratch, their normal forces, N */
};

struct blocked { /* a pair that may move by a part of its displacement only */
    int pair;
    double part;
};

struct contact_solid {
    const struct scene_solid *solid;
    int first, count; /* its points */
};

struct contact_rigid { /* a rigid body */
    int group;
    int first, count; /* its points */
    int carrier;      /* the first of the four particles of the system that carry it */
};

struct flat_sides { /* flat parts of solids and rigid bodies (flat_sides.c) */
    int *across;    /* faces x 3: the face beyond the side opposite a corner; -1: it is not flat */
    int *part;      /* faces: the first face of the flat part that it belongs to; or itself */
    bool *edge;     /* edges_room: is such a side */
    bool *point;    /* points: has such sides all around */
};

struct common_motion {    /* of bodies that fly together (common_motion.c) */
    bool *held;           /* bodies: something holds parts of them */
    double *displacement; /* bodies x 3, m: before the paths of this step */
    bool known;           /* `displacement` was looked for in this step */
    int *cluster;         /* bodies: another one of the cluster; itself: the first one */
    int *members;         /* bodies: points of the cluster, at the first one */
    bool *held_cluster;   /* bodies: the cluster has no common motion, at the first one */
};

/* Regions of points, boxes of faces and edges around them, and their trees (contact_regions.c). */
struct broad_phase {
    struct box *region; /* points: while all points are inside, the list of pairs is complete */
    double *built;      /* points x 3, m: positions when the regions were set */
    double *reach;      /* points, m: the largest distance from there within the region */
    struct box *point_box, *face_box, *edge_box; /* points, faces, edges_room; empty: no pairs */
    struct bvh vertex_tree, other_tree;          /* of vertices of surfaces; of other points */
    struct bvh face_tree[2], edge_tree[2];       /* of surfaces; of solids */
    bool *changed;                               /* points: whose pairs are searched anew */
    bool *face_changed, *edge_changed;           /* faces, edges_room: with such points */
    bool all_changed;
    int moved; /* points that got new regions since the trees were built */
    int *vertex_body, *face_body, *edge_body; /* vertices, free_faces, free_edges: the group, if it
                                                 does not touch itself; -1: it does */
};

struct pair_list {   /* what the broad phase found */
    int count, room; /* room: of `pair`, and of arrays of contact_paths and contact_hits */
    struct pair *pair;
    bool complete;         /* the last search did not fail; the first one has been done */
    double *seen;          /* points x 3, m: positions of the distances of pairs */
    double *moved;         /* points, m: distance from there */
    atomic_long *of_group; /* groups: new pairs of the last search, about */
};

/* Displacements without collision (contact_paths.c). */
struct contact_paths {
    double least;            /* of contact_shorten_paths */
    double *x;               /* points x 3, m: where a path begins */
    double *step;            /* points x 3, m: displacement */
    double *length;          /* points, m: its length */
    double *taken;           /* points: the part of the displacement that is free */
    double *cut;             /* points: factor by which the current round shortens it */
    int *candidate;          /* room: pairs that may be blocked */
    int *candidates;         /* room / CONTACT_GRAIN */
    struct blocked *blocked; /* room */
    int *blocked_count;      /* room / CONTACT_GRAIN */
};

/* Pairs that are closer than their thickness (contact_find.c). */
struct contact_hits {
    struct hit *hit;      /* room: each block of pairs has its hits at its own place */
    int *count;           /* room / CONTACT_GRAIN */
    struct keyed *sorted; /* room: all of them, by the keys of their pairs */
};

struct contact {
    pdyn_context *context;
    const struct scene_contact *settings;
    double ms; /* wall time in this step */

    /* Points: vertices of surfaces, then particles of fluids (both are free), then vertices of
     * solids. Groups: bodies, then solids. */
    int points, free, vertices;
    const bool *live;      /* particles of the system that exist; NULL: all */
    double *thickness;     /* groups, m */
    const char **name;     /* groups */
    int *group;            /* points; -1 for a point of a solid that no triangle has */
    int *column;           /* free: particle of the system */
    double *rest;          /* points x 3, m: rest shapes */
    double *at;            /* points x 3, m: positions at the last local step */
    double *start_at;      /* points x 3, m: positions at the beginning of the step */
    int faces, free_faces; /* those of surfaces are the first */
    int *face;             /* faces x 3: points */
    int edges, free_edges, edges_room;
    int *edge; /* edges_room x 2: points */
    int groups, bodies;
    struct contact_solid *solid; /* groups - bodies */
    int rigids;
    struct contact_rigid *rigid; /* rigids: no pair within one comes into contact */
    bool *permeable;             /* groups: particles of fluids pass their faces */
    pdyn_body body;              /* all free particles, for the batches */
    double *begin, *goal; /* (points - free) x 3, m: solids at the beginning and end of the step */
    bool moving;          /* some solid moves in this scene */
    bool lagging;         /* some solid has not reached its goal */

    struct flat_sides flat;
    struct common_motion common;
    struct broad_phase broad;
    struct pair_list pairs;
    struct contact_paths path;
    struct contact_hits hits;
    struct contact_list current; /* of the last local step */
    struct contact_list start;   /* of the beginning of the step */
    struct bearings *bearings;   /* of the latter; NULL: without rigid bodies or damping */
    struct row_memory pressed;   /* N: normal forces of the last step, by the keys of contacts */
};

enum { CONTACT_GRAIN = 1024 }; /* pairs of a parallel block */

/* Places solids as at time 0, then finds the contacts at x, and checks them. */
pdyn_status contact_place(struct contact *contact, const double *x);

/* Finds the flat sides of solids and rigid bodies. */
pdyn_status contact_find_flat_sides(struct contact *contact);
/* The key of a pair, which stays the same while a vertex moves over a flat part: so does what
 * friction remembers. */
uint64_t contact_key(const struct contact *contact, const struct pair *pair);
/* A direction that turns with the surfaces of a pair: a side of its face, or of the first face of
 * its flat part; of two edges the sum of their directions, which turns by the mean of their turns.
 */
void contact_side(const struct contact *contact, const struct pair *pair, double side[3]);
/* Whether another face, beyond a flat side of this one, is nearer to the vertex of a pair, or as
 * near and has a lower number. */
bool contact_is_beyond_flat_side(const struct contact *contact, const struct pair *pair,
                                 const struct hit *hit);

/* Parts of the thickness of a pair. No path to the start of a step and no motion of a solid brings
 * its points closer than CONTACT_GAP. No path of an iterate brings them closer than CONTACT_LEAST:
 * the force there stops fast and heavy bodies. */
#define CONTACT_GAP   0.0625
#define CONTACT_LEAST 1e-3

/* Gives points that are not in their regions, with their displacement from x by step (points x 3;
 * NULL: none), new ones, and all points if these are many or the list of pairs is not complete;
 * marks them as changed. Returns whether there are any. */
bool contact_update_regions(struct contact *contact, const double *x, const double *step);
/* Builds or refits the trees of points, faces and edges around the regions. */
void contact_update_trees(struct contact *contact);
/* Whether one of the points has changed. */
bool contact_has_changed(const struct contact *contact, const int *point, int points);
/* The box around the regions of the points, larger by half a thickness. */
void contact_wrap_regions(const struct contact *contact, const int *point, int points,
                          struct box *box);

/* Makes the list of pairs complete for all positions between x and x + step (points x 3; step NULL:
 * at x). */
pdyn_status contact_update_pairs(struct contact *contact, const double *x, const double *step);

/* Lists all pairs that can come closer than their thickness in the regions. */
pdyn_status contact_search_pairs(struct contact *contact);
/* pairs.moved = how far points are at x (points x 3) from where distances of pairs were measured.
 */
void contact_measure_moved(struct contact *contact, const double *x);
void contact_free_pairs(struct contact *contact);

/* Shortens contact->path.step from contact->path.x to free paths, which bring no pair closer than
 * this part of its thickness; sets contact->path.taken. */
pdyn_status contact_shorten_paths(struct contact *contact, double least);

/* Sets contact->common.displacement from the paths x and step of all points, which are not
 * shortened. */
pdyn_status common_motion_find(struct contact *contact);

/* Sets the contacts at contact->at, from the list of pairs. */
pdyn_status contact_find(struct contact *contact);

/* contact->start_at = contact->at; the shares of the current contacts follow. */
void contact_set_start_positions(struct contact *contact);

/* Copies the current contacts, but for those of fluid particles, to those of the beginning. */
pdyn_status contact_set_start(struct contact *contact);

/* Updates the offsets of the contacts of the beginning after solids moved. */
void contact_follow_solids(struct contact *contact);

void contact_list_free(pdyn_context *context, struct contact_list *list);

/* Whether the point is a particle of a fluid. */
static inline bool is_particle(const struct contact *contact, int point) {
    return point >= contact->vertices && point < contact->free;
}

static inline const struct pair_kind *pair_kind_of(uint64_t key) {
    return key >> 63 ? &pair_edge_edge : &pair_vertex_face;
}

/* The number of the second primitive of a pair. */
static inline int pair_second(const struct pair *p) { return (int)(p->key & 0xFFFFFFFFu); }

/* The sum of the largest numbers of the points of both primitives: an upper bound of how far they
 * approach each other where the numbers are how far the points move. */
static inline double pair_largest(const struct pair *p, const double *of) {
    const int *i = p->point;
    double a = of[i[0]], b = of[i[1]], c = of[i[2]], d = of[i[3]], other = c > d ? c : d;
    if (pair_kind_of(p->key)->first == 2) return (a > b ? a : b) + other;
    return a + (b > other ? b : other);
}

/* 3-vectors of the points of a pair. */
static inline void pair_load(const int point[4], const double *from, const double *out[4]) {
    for (int k = 0; k < 4; k++) out[k] = from + 3 * (size_t)point[k];
}

#endif
