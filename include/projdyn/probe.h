/* projdyn: forces, energies and pressures at the end of the last step, beside the state of
 * projdyn.h, and the probes of a scene. Reading changes no bit of later steps. Before the first
 * step, after a failed step, and after pdyn_restore until the next step, all values are 0, but for
 * those of probes, which saved states contain. Computed on the caller's thread, with the same bits
 * for any number of threads of the context. */
#ifndef PROJDYN_PROBE_H
#define PROJDYN_PROBE_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Forces of a constraint on all particles, N, particles x 3: minus the gradient of its energy, with
 * that of its damping.
 *
 * Balance. With "euler", a particle of mass m has in every step of length h
 *
 *     m (v - v_before) / h = m g + sum of the forces of all constraints and of contact + residual
 *
 * before viscosity, which moves momentum between particles. Over all particles only forces from
 * outside remain: gravity, the loads of pins and wind, and minus the loads on solids
 * (pdyn_solid_load). "bdf2" has the same balance with the velocities of its base
 * (docs/theory/time-integration.md). Particles that an outlet removes at the end of the step have
 * their forces still.
 *
 * PDYN_BAD_CALL: no such constraint. */
PDYN_API pdyn_status pdyn_constraint_forces(const pdyn_sim *sim, int constraint, double *force);
/* Their sum, N, and moment about the origin, N m: for pins, what holds the body. */
PDYN_API pdyn_status pdyn_constraint_load(const pdyn_sim *sim, int constraint, double force[3],
                                          double moment[3]);
/* Forces of contact, friction, and friction with the fluid, N, particles x 3. */
PDYN_API pdyn_status pdyn_contact_forces(const pdyn_sim *sim, double *force);
/* The load on a solid or a body at the end of the last step by one source: force, N, and moment,
 * N m, about the origin of the world.
 *
 *     ALL      solid: the sum of the other two (pdyn_solid_load); body: all constraints, its own
 *              among them, and contact: everything but gravity and applied forces
 *     FLUID    constraints on neighbour lists, such as pressure, shear by no_slip and surface
 *              tension; on a surface also fluid_friction and seepage
 *     CONTACT  contact, friction and damping with surfaces, bodies and solids; also particles of a
 *              fluid that contact keeps off a surface
 *
 * On a body they are the sums of its particles' forces. PDYN_BAD_CALL: an argument is NULL, or
 * there is no such solid, body or source. */
typedef enum pdyn_load_source {
    PDYN_LOAD_ALL,
    PDYN_LOAD_FLUID,
    PDYN_LOAD_CONTACT,
} pdyn_load_source;
PDYN_API pdyn_status pdyn_solid_load_by(const pdyn_sim *sim, int solid, pdyn_load_source source,
                                        double force[3], double moment[3]);
PDYN_API pdyn_status pdyn_body_load_by(const pdyn_sim *sim, int body, pdyn_load_source source,
                                       double force[3], double moment[3]);
/* Values of each element of a constraint, without its damping; pdyn_constraint_info.elements now,
 * as some types have another number after each step. NULL: not wanted. energy, J. distance: |G x -
 * p|, from the element to its manifold, in the unit of its rows: the change of length of a spring,
 * m; the norm of the strain of a triangle times sqrt(area), m, of a tetrahedron times sqrt(volume),
 * m^1.5; the change of curvature of bending times the area, m; 0 for a matrix-free constraint.
 * PDYN_BAD_CALL: no such constraint. */
PDYN_API pdyn_status pdyn_element_values(const pdyn_sim *sim, int constraint, double *energy,
                                         double *distance);

/* Pressure, Pa, and velocity, m/s, of the fluid at `count` points (x: count x 3, m): a linear
 * least-squares fit to the particles within two particle spacings. A linear field is met to 2 % of
 * its change over a spacing, at walls, edges and surfaces, too. The pressure is never negative; 0
 * where there is no particle. pressure, velocity NULL: not wanted. Beside side walls the particles
 * have up to 15 % more pressure than the water further in: the pressure on a wall is measured by a
 * probe "wall". PDYN_BAD_INPUT: a coordinate is not finite. */
PDYN_API pdyn_status pdyn_fluid_at(const pdyn_sim *sim, int count, const double *x,
                                   double *pressure, double *velocity);

/* A probe of the scene ("probes", docs/guide/scene.md). Every step measures all of them, and the
 * writer adds a row to probes.csv. */
typedef struct pdyn_probe_info {
    const char *name;
    int values;                /* columns of probes.csv */
    const char *const *column; /* values: NAME.QUANTITY_UNIT */
    const double *value;       /* values: at the end of the last step */
} pdyn_probe_info;
/* All members 0: no such probe. */
PDYN_API void pdyn_get_probe_sized(const pdyn_sim *sim, int probe, pdyn_probe_info *out,
                                   size_t size);
static inline pdyn_probe_info pdyn_get_probe(const pdyn_sim *sim, int probe) {
    pdyn_probe_info out;
    pdyn_get_probe_sized(sim, probe, &out, sizeof out);
    return out;
}

#ifdef __cplusplus
}
#endif
#endif
