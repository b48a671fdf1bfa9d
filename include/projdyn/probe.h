/* projdyn: forces, energies and pressures at the end of the last step, beside the state of
 * projdyn.h, and the probes of a scene. Reading changes no bit of later steps. Before the first
 * step, and after pdyn_restore until the next one, all values are 0. */
#ifndef PROJDYN_PROBE_H
#define PROJDYN_PROBE_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Forces of a constraint on all particles, N, particles x 3: minus the gradient of its energy, with
 * that of its damping. PDYN_BAD_CALL: no such constraint. PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_constraint_forces(const pdyn_sim *sim, int constraint, double *force);
/* Their sum, N, and moment about the origin, N m: for pins, what holds the body. */
PDYN_API pdyn_status pdyn_constraint_load(const pdyn_sim *sim, int constraint, double force[3],
                                          double moment[3]);
/* Forces of contact, friction, and friction with the fluid, N, particles x 3. */
PDYN_API pdyn_status pdyn_contact_forces(const pdyn_sim *sim, double *force);
/* Values of each element of a constraint (pdyn_constraint_info.elements); NULL: not wanted.
 * energy, J. distance: |G x - p|, from the element to its manifold: the change of length of a
 * spring, m; the norm of the strain of a triangle or tetrahedron; 0 for a matrix-free constraint.
 */
PDYN_API pdyn_status pdyn_element_values(const pdyn_sim *sim, int constraint, double *energy,
                                         double *distance);

/* Pressure, Pa, and velocity, m/s, of the fluid at `count` points (x: count x 3, m), fitted
 * linearly to the particles within two particle spacings, so that walls and surfaces are exact for
 * a linear field. 0 where there is no fluid. pressure, velocity NULL: not wanted. */
PDYN_API pdyn_status pdyn_fluid_at(const pdyn_sim *sim, int count, const double *x,
                                   double *pressure, double *velocity);

/* A probe of the scene ("probes", docs/guide/scene.md). The writer writes all of them to probes.csv
 * every step. */
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
