/* For authors of constraints and solvers: checks a type against the contract of module.h. */
#ifndef PROJDYN_CONFORMANCE_H
#define PROJDYN_CONFORMANCE_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks a registered constraint type or solver (name NULL: all types and solvers of plug-ins) on
 * small scenes that are written from the type's table: which array entries each callback writes;
 * projection, tangent and energy by finite differences; H; the solution with every solver; the same
 * bits with several numbers of threads. `tell` (may be NULL) gets one text per fault; *faults is
 * the number of faults. A callback that writes far outside of its arrays may crash the program.
 * Returns PDYN_BAD_INPUT if no type has this name. */
PDYN_API pdyn_status pdyn_conformance(pdyn_context *context, const char *name,
                                      void (*tell)(void *user, const char *text), void *user,
                                      int *faults);

#ifdef __cplusplus
}
#endif
#endif
