/* projdyn: changes to a simulation while it runs, between two steps. What is set stays until it is
 * set again, and saved states contain it. Every function checks its numbers before it changes
 * anything: PDYN_BAD_CALL: no such particle, constraint, solid or inlet, or the simulation has
 * failed; PDYN_BAD_INPUT: a number that is not finite or out of range. PDYN_NO_MEMORY.
 *
 * Cost of the next step, beside that of the call: "nothing", or "solvers": the linear solvers are
 * made anew, which costs an analysis and a factorisation (cholesky, hybrid) or little (cg, dual).
 * Several such changes before a step cost as much as one. */
#ifndef PROJDYN_CONTROL_H
#define PROJDYN_CONTROL_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- forces: nothing ------------------------------------------------------------------------- */

/* Force on the particles from `first`, N, count x 3. force NULL: none. Forces of a particle that is
 * not live have no effect. */
PDYN_API pdyn_status pdyn_set_forces(pdyn_sim *sim, int first, int count, const double *force);
PDYN_API pdyn_status pdyn_add_forces(pdyn_sim *sim, int first, int count, const double *force);
/* Gravity, m/s^2, for all bodies; in the place of keys of the scene. */
PDYN_API pdyn_status pdyn_set_gravity(pdyn_sim *sim, const double gravity[3]);
PDYN_API void pdyn_get_gravity(const pdyn_sim *sim, double gravity[3]);

/* ---- state: nothing, but the next step starts without history -------------------------------- */

/* Positions, m, or velocities, m/s, of the particles from `first`, count x 3. A body that is placed
 * anew does not pass what lies between. Of a rigid body all vertices or none: it takes the closest
 * rigid pose or motion. PDYN_BAD_INPUT: some of its vertices; one place for a whole body; in a
 * scene with contact, positions in which surfaces intersect or nearly touch. After a failure
 * nothing has moved. */
PDYN_API pdyn_status pdyn_set_positions(pdyn_sim *sim, int first, int count, const double *x);
PDYN_API pdyn_status pdyn_set_velocities(pdyn_sim *sim, int first, int count, const double *v);

/* ---- constraints ----------------------------------------------------------------------------- */

/* Sets a parameter of a constraint, in the place of keys of the scene: 1 number; 3 for a vector; 4
 * for each key of a path (time and three numbers); of a table all rows, or one row for all parts of
 * the body. PDYN_BAD_INPUT: unknown, out of bounds, not changeable
 * (pdyn_parameter_info.changeable), or against a rule of the type, as a gas below vacuum; the old
 * value stays. Solvers; a path, or a parameter that changes neither rows nor weights: nothing. */
PDYN_API pdyn_status pdyn_set_parameter(pdyn_sim *sim, int constraint, const char *name,
                                        const double *value, int count);
/* Switches a constraint off and on. PDYN_BAD_INPUT: a constraint that is matrix-free, as "fluid".
 * Solvers. */
PDYN_API pdyn_status pdyn_enable(pdyn_sim *sim, int constraint, bool enabled);
/* Whether it acts; false: no such constraint. */
PDYN_API bool pdyn_is_enabled(const pdyn_sim *sim, int constraint);

/* Holds a particle: a spring of the stiffness, N/m, pulls it to the target, m, with the force
 * stiffness (target - x). pdyn_step_info.pin_reaction and pdyn_body_load_by (probe.h) contain it.
 * Given again for the same particle: moves the target (nothing), or changes the stiffness
 * (solvers). A new hold and a release: solvers. */
PDYN_API pdyn_status pdyn_hold(pdyn_sim *sim, int particle, double stiffness,
                               const double target[3]);
PDYN_API pdyn_status pdyn_release(pdyn_sim *sim, int particle); /* not held: does nothing */

/* ---- solids: nothing ------------------------------------------------------------------------- */

/* Moves a solid so that at `time`, after the current one, it has this pose: translation, m, and
 * turns, degrees about x, then y, then z through its pivot, both from its place in the scene. It
 * moves evenly from its pose now, replaces what the scene says of later times, and rests there
 * afterwards. PDYN_BAD_INPUT: a solid that has no "motion" in the scene (one key is enough). */
PDYN_API pdyn_status pdyn_move_solid(pdyn_sim *sim, int solid, double time,
                                     const double translate[3], const double rotate[3]);
/* The pose that the motion of a solid gives it at the current time, in the same numbers; 0 without
 * "motion". With contact, a surface may hold the solid up before it (pdyn_solid_vertices). */
PDYN_API pdyn_status pdyn_solid_pose(const pdyn_sim *sim, int solid, double translate[3],
                                     double rotate[3]);

/* ---- inlets: nothing ------------------------------------------------------------------------- */

/* Number of inlets of a body; 0: none, or no such body. */
PDYN_API int pdyn_inlets(const pdyn_sim *sim, int body);
/* Moves an inlet of a body, from 0, as pdyn_move_solid moves a solid. PDYN_BAD_INPUT: an inlet that
 * has no "motion" in the scene. */
PDYN_API pdyn_status pdyn_move_inlet(pdyn_sim *sim, int body, int inlet, double time,
                                     const double translate[3], const double rotate[3]);
/* Changes the speed of its flow evenly, so that it is `speed`, m/s, at `time`; at once, if that is
 * not after the current time. 0 shuts the inlet. The "budget" of the scene stays as it is.
 * PDYN_BAD_INPUT: an inlet whose "duration" has ended. */
PDYN_API pdyn_status pdyn_set_inlet_speed(pdyn_sim *sim, int body, int inlet, double time,
                                          double speed);

/* ---- steps ----------------------------------------------------------------------------------- */

/* A step of length h, s, chosen by the caller: it need not end at frames, and info->frame tells
 * that it reached one or passed it. "cfl" and the pressure do not limit it. Shorter (info->h) after
 * attempts that diverged, or that were not solved and moved fluid by more than twice the distance
 * of "cfl". Otherwise as pdyn_step. PDYN_BAD_INPUT: h is not from 1e-9 to 1000 s. */
PDYN_API pdyn_status pdyn_step_by_sized(pdyn_sim *sim, double h, pdyn_step_info *info, size_t size);
static inline pdyn_status pdyn_step_by(pdyn_sim *sim, double h, pdyn_step_info *info) {
    return pdyn_step_by_sized(sim, h, info, sizeof *info);
}

#ifdef __cplusplus
}
#endif
#endif
