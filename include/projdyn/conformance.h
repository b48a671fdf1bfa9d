/* For authors of constraints and solvers: does a type keep the contract of module.h? */
#ifndef PROJDYN_CONFORMANCE_H
#define PROJDYN_CONFORMANCE_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks a registered constraint type or solver (name NULL: all that plug-ins have brought) on
 * small scenes that are written from its table: what its callbacks write and where, projection,
 * tangent and energy by finite differences, H, every solver, several numbers of threads. `tell`
 * (NULL: not wanted) gets each fault in words; *faults says how many there are. A type that writes
 * far outside of its arrays may end the program. PDYN_BAD_INPUT: no such type. */
PDYN_API pdyn_status pdyn_conformance(pdyn_context *context, const char *name,
                                      void (*tell)(void *user, const char *text), void *user,
                                      int *faults);

#ifdef __cplusplus
}
#endif
#endif
