/* Contact of surfaces with themselves, each other, solids, and the particles of fluids: which pairs
 * are close, their geometry, and paths without collision. The energies of contact and friction are
 * constraints like others (src/constraints/contact.c and friction.c); pdyn_contacts hands over to
 * them what is found here.
 *
 * A pair is a vertex or a particle and a face, or two edges, that share no vertex. No pair ever
 * passes through another: iterates move along straight paths that were checked (contact_paths.c),
 * from a state without intersections. Solids are partners in pairs like surfaces; a solid that
 * moves waits where it would pass through a surface.
 *
 * This is what the rest of core calls; contact_parts.h has the data. */
#ifndef PDYN_CONTACT_H
#define PDYN_CONTACT_H

#include "base/snapshot_file.h"

#include "projdyn/module.h"

struct contact;
struct rigid_map;
struct scene;

struct contact_def { /* what contact is made of; all but x must outlive it */
    const struct scene *scene;
    const pdyn_body *body;         /* bodies of the scene, as modules see them */
    int particles;                 /* of the system */
    const bool *live;              /* particles that exist; NULL: all */
    const struct rigid_map *rigid; /* NULL in a scene without rigid bodies */
    const double *x;               /* particles x 3, m: positions at the start */
};

/* ---- construction ---------------------------------------------------------------------------- */

/* Makes the contact of a scene, and finds the contacts at the start. *out stays NULL in a scene
 * without contact. Fails where surfaces intersect, and leaves *out to be freed. */
pdyn_status contact_create(pdyn_context *context, const struct contact_def *def,
                           struct contact **out);
/* Frees the contact with all that it has found. NULL: does nothing. */
void contact_free(struct contact *contact);

/* Says whether something holds parts of a body, which then has no common motion (common_motion.c).
 */
void contact_hold(struct contact *contact, int body, bool held);

/* Fails where two triangles intersect, or a pair with one of `count` particles from `first` on is
 * closer than CONTACT_GAP permits. After contact_local. */
pdyn_status contact_check(struct contact *contact, int first, int count);

struct contact_gap { /* two surfaces, or a surface and a solid, that are in contact */
    const char *name[2];
    double distance, thickness, x[3]; /* m: of the pair that is closest for its thickness; where */
};
/* Finds that pair in the contacts of the last local step that count. distance and thickness are 1
 * if there is none. */
struct contact_gap contact_smallest_gap(const struct contact *contact,
                                        bool (*counts)(const void *user, const pdyn_contact *),
                                        const void *user);

/* Writes or reads what the next step depends on. */
void contact_persist(struct contact *contact, struct snapshot_file *snapshot);

/* ---- one step, in the order of the calls ----------------------------------------------------- */

/* Begins a step to `time` at the positions x of the last local step: the contacts there become
 * those of the beginning of the step, and solids get their poses at `time` as goals. */
pdyn_status contact_begin(struct contact *contact, const double *x, double time);

/* Shortens the paths from x, bodies moved by their common displacement, to target (particles x 3)
 * so that nothing passes anything, and changes target accordingly; solids move at the same time
 * from where the step began to their goals. */
pdyn_status contact_filter_start(struct contact *contact, const double *x, double *target);
/* The displacement, m, of a body before the paths of this step begin; 0 where all are free. */
const double *contact_common(const struct contact *contact, int body);

/* Finds the contacts at x, for the local steps of constraints. */
pdyn_status contact_local(struct contact *contact, const double *x);

/* Shortens the parts of a direction (particles x 3) that are not free from x. */
pdyn_status contact_filter(struct contact *contact, const double *x, double *direction);
/* The smallest part that contact_filter_start or contact_filter last left of a point's
 * displacement. */
double contact_least(const struct contact *contact);

/* Moves solids that have not reached their goals on as far as they can, with surfaces at x. */
pdyn_status contact_advance(struct contact *contact, const double *x);

/* At the end of a step: stores the forces in contact_normal_forces, with those that dashpots add,
 * for the friction of the next step. */
void contact_store_forces(struct contact *contact);

/* Undoes a step that failed: solids go back to where it began, surfaces are at x. */
pdyn_status contact_take_back(struct contact *contact, const double *x);

/* ---- what it has found ----------------------------------------------------------------------- */

/* The contacts of the last local step, and of the beginning of the step; the latter are without
 * those of fluid particles. The pointers stay valid. */
const pdyn_contacts *contact_current(const struct contact *contact);
const pdyn_contacts *contact_at_start(const struct contact *contact);

/* All free particles: the body of the constraints that act on contacts. */
const pdyn_body *contact_body(const struct contact *contact);

/* Normal forces of contact_current, N, for the caller to set before contact_store_forces. */
double *contact_normal_forces(struct contact *contact);

struct contact_vertex { /* a vertex of a solid in a contact */
    int solid;
    double coefficient; /* in the shortest vector, the sum of coefficient x position */
    const double *x;    /* m */
};

/* Lists the vertices of solids in contact e of contact_current or contact_at_start. Returns their
 * number. */
int contact_list_vertices(const struct contact *contact, const pdyn_contacts *contacts, int e,
                          struct contact_vertex vertex[4]);

/* Joins the particles of pairs that may come close in this step (base/groups.h), in a scene without
 * solids. */
void contact_join(const struct contact *contact, int *group);

/* Wall time in contact since contact_clear_ms. */
double contact_ms(const struct contact *contact);
void contact_clear_ms(struct contact *contact);

/* ---- solids ---------------------------------------------------------------------------------- */

/* The positions of the vertices of a solid, 3 per vertex, m: where it has come to. */
const double *contact_solid_at(const struct contact *contact, int solid);

/* Whether a solid has not reached its goal, and the largest distance, m, between a vertex of a
 * solid and its goal. */
bool contact_is_lagging(const struct contact *contact);
double contact_lag(const struct contact *contact, int solid);

/* ---- bearings of rigid bodies (bearings.h) --------------------------------------------------- */

/* Whether contacts have dashpots (pdyn_dashpot). */
bool contact_has_dashpots(const struct contact *contact);
/* The solid on which a dashpot acts, at its u; -1: none. */
int contact_dashpot_solid(const struct contact *contact, int dashpot);
/* Adds a force, N, of a dashpot along its normal, before contact_store_forces. */
void contact_add_dashpot_force(struct contact *contact, int dashpot, double force);

#endif
