/* Contact of surfaces with themselves, each other, solids, and the particles of fluids: which pairs
 * are close, their geometry, and paths without collision. The energies of contact and friction are
 * constraints like others (src/constraints/contact.c and friction.c); pdyn_contacts hands over to
 * them what is found here.
 *
 * A pair is a vertex or a particle and a face, or two edges, that share no vertex. No pair ever
 * passes through another: iterates move along straight paths that were checked (contact_filter.c),
 * from a state without intersections. Solids are partners in pairs like surfaces; a solid that
 * moves waits where it would pass through a surface. */
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

struct stencil { /* of a contact: the shortest vector is the sum of c_k x_k */
    int point[4];
    double c[4];
};

struct contact_list {
    int room;
    pdyn_contact *contact;   /* room */
    struct stencil *stencil; /* room: of the same */
    pdyn_contacts view;      /* what constraints see */
    struct batch *batch;     /* has an element for each contact; NULL: none */
};

struct hit { /* a pair that is closer than its thickness */
    int pair;
    double distance, c[4];
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

    /* contacts */
    struct hit *hit;             /* room: found by the last search, in blocks */
    int *hit_count, *hit_start;  /* room / grain */
    struct contact_list current; /* at the last local step, for the barrier */
    struct contact_list start; /* those of surfaces and solids when the step began, for friction */
};

/* Points, batches, and the check that nothing intersects; sim->objective.contact stays NULL in a
 * scene without contact. */
pdyn_status contact_create(struct pdyn_sim *sim);
void contact_free(struct contact *contact);

/* A step begins where the last local step was: solids have a new goal, where they are at a time,
 * and friction gets the contacts there. */
pdyn_status contact_begin(struct contact *contact, double time);

/* It is taken back: the next one begins again at x. */
pdyn_status contact_take_back(struct contact *contact, const double *x);

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

/* The contacts at x: before the local step of any constraint. */
pdyn_status contact_local(struct contact *contact, const double *x);

/* ---- within contact -------------------------------------------------------------------------- */

enum { CONTACT_GRAIN = 1024 }; /* pairs */

/* No path brings a pair closer than this part of its thickness. */
#define CONTACT_LEAST 0.0625

/* Knows all pairs that can come close while every point is on the way between x and x + step
 * (points x 3 each; step NULL: at x). */
pdyn_status contact_cover(struct contact *contact, const double *x, const double *step);

void contact_free_pairs(struct contact *contact);

/* Shortens contact->step to free paths from contact->x; contact->taken says by how much. */
pdyn_status contact_free_paths(struct contact *contact);

/* The list of pairs for the regions as they are. */
pdyn_status contact_list(struct contact *contact);

/* Room for so many contacts; those in the list are lost where it grows. */
pdyn_status contact_list_reserve(pdyn_context *context, struct contact_list *list, int count);
void contact_list_free(pdyn_context *context, struct contact_list *list);

/* Fails where two triangles intersect. */
pdyn_status contact_check(struct contact *contact);

static inline const struct pair_kind *pair_kind_of(uint64_t key) {
    return key >> 63 ? &pair_edge_edge : &pair_vertex_face;
}

/* 3-vectors of the points of a pair. */
static inline void pair_load(const int point[4], const double *from, const double *out[4]) {
    for (int k = 0; k < 4; k++) out[k] = from + 3 * (size_t)point[k];
}

#endif
