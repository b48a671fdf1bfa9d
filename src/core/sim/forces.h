/* Forces of constraints and of contact at the end of a step. They are computed on demand; a step
 * only marks the last ones as outdated. */
#ifndef PDYN_FORCES_H
#define PDYN_FORCES_H

#include "rows/batch.h"
#include "solid_load.h"

/* At the end of a step: pins that hold a body against impacts pass their mean forces on. */
void forces_pass_on(struct pdyn_sim *sim);
/* At the end of a step: stores the mean normal forces of contacts, which limit the friction of the
 * next one. */
void forces_store_normal(struct pdyn_sim *sim);
/* Forces are unknown until the next step has ended. */
void forces_forget(struct pdyn_sim *sim);

/* The gradient g = w (u - p), N, of the energy of row r of element e of a batch, less the part of
 * an impact that the integrator left out: on the points that the row selects acts -coefficient x g.
 */
void forces_row_gradient(const struct pdyn_sim *sim, const struct batch *batch, int e, int r,
                         double g[3]);

/* Adds to a load the force of constraint k of the scene on a body, NULL: on all particles, at the
 * positions of the end of the step. Nothing while forces are unknown. May overwrite sim->trial. */
void forces_add_load(const struct pdyn_sim *sim, int k, const pdyn_body *on, struct load *load);

/* Computes the force by a source on every particle, N; 0 while forces are unknown. */
void forces_sum(const struct pdyn_sim *sim, pdyn_load_source source, double *force);
/* The sum of these forces over a body, and their moment. */
struct load forces_load_on(const struct pdyn_sim *sim, int body, const double *force);

/* The sum of force . position over the particles of constraint k, N m, of rows whose forces sum to
 * zero. */
double forces_virial(const struct pdyn_sim *sim, int k);

#endif
