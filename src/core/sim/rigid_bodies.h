/* Motion of rigid bodies (rows/rigid_map.h) over a step. The centre follows the formulas of the
 * integrator. The rotation follows from the angular momentum L about the centre,
 *
 *     euler   L^ = L_n                        R^ = R_n
 *     bdf2    L^ = L_n + c (L_n - L_(n-1))    R^ = exp(c (e - h_b I^-1 (L_n - L_(n-1))))
 *                                                  F(h - h_e; R_n, L_n)
 *     s       R = F(h_e; R^, L^)
 *     end     L_(n+1) = L^ + h_e T,           T: moment of the forces of constraints
 *
 * with c and h_e of step/integrator.h, the length h_b of the step before, the free rotation F(t; R,
 * L) of a body with constant L over the time t, and e, the rotation from F(h_b; R_(n-1), L_(n-1))
 * to R_n; exp is the identity where its angle exceeds 0.1 rad. Without a moment L is constant and
 * the rotation is F, whatever the step length. */
#ifndef PDYN_RIGID_BODIES_H
#define PDYN_RIGID_BODIES_H

#include "sim.h"

/* The scene's rigid bodies at rest positions that are placed; masses, pose and velocities at the
 * start. sim->objective.rigid stays NULL in a scene without them. */
pdyn_status rigid_bodies_create(struct pdyn_sim *sim);

/* Call in a step once x_base, v_base and s are known: replaces x_base and s. */
void rigid_bodies_predict(struct pdyn_sim *sim);

/* Replaces the velocities of bodies by those of the angular momentum at the end of the step. */
void rigid_bodies_set_velocities(struct pdyn_sim *sim);

/* Makes velocities v at positions x rigid, with the same momentum and angular momentum. */
void rigid_bodies_project(const struct pdyn_sim *sim, const double *x, double *v);

#endif
