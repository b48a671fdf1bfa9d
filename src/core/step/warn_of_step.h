/* Warnings about a step (base/warnings.h). */
#ifndef PDYN_WARN_OF_STEP_H
#define PDYN_WARN_OF_STEP_H

#include "sim/sim.h"

/* Raises warnings about the step that was just accepted. why_repeated: the fault of the last
 * attempt at it that was taken back; "" without one. */
void warn_of_step(struct pdyn_sim *sim, const pdyn_step_info *info, const char *why_repeated);
/* Warns of particles in gaps without room for them, a part of it. density_error_max: of the step.
 */
void warn_of_gaps(struct pdyn_sim *sim, double density_error_max);
/* Warns of pins that contact keeps from their targets, a part of it. */
void warn_of_pins(struct pdyn_sim *sim);

/* Warns of a constraint of rows whose forces do not sum to zero although its type does not say
 * PDYN_ANCHORED. After a successful attempt at a step, before it is accepted: its local step is
 * done once more. */
pdyn_status warn_of_momentum(struct pdyn_sim *sim);

/* A particle of a contact that pins hold on both sides: no force of contact moves it; -1: they do
 * not. */
int warn_pinned_particle(const struct pdyn_sim *sim, const pdyn_contact *contact);

#endif
