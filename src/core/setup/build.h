/* The parts of a simulation that build.c makes from a scene; its function `build` gives the order
 * of these and of the parts of other headers. A part may refer to those before it. After a failure
 * all are to be freed, too. */
#ifndef PDYN_BUILD_H
#define PDYN_BUILD_H

#include "projdyn/projdyn.h"

struct json_file;
struct pdyn_sim;

/* build_bodies.c: bodies, their particles and topology, and the state at the start. */
pdyn_status bodies_create(struct pdyn_sim *sim);
void bodies_free(struct pdyn_sim *sim);

/* Frees the particles of the scene, which the state has a copy of. */
void bodies_forget_start(struct pdyn_sim *sim);

/* build_lists.c: boundary points, samples on surfaces and neighbour lists. Does nothing in a scene
 * where no constraint needs them. */
pdyn_status lists_create(struct pdyn_sim *sim);
void lists_free(struct pdyn_sim *sim);

/* build_batches.c: batches of the constraints of the scene, of their damping, and of friction and
 * seepage between surfaces and fluids; room for those of contact, which batches_free frees, too.
 * Errors have the place of the constraint in the file. */
pdyn_status batches_create(struct pdyn_sim *sim, const struct json_file *json);
/* The batches of contact, its damping and friction, where the objective has contact. */
pdyn_status batches_add_contact(struct pdyn_sim *sim);
void batches_free(struct pdyn_sim *sim);

#endif
