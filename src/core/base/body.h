/* What a body is and has (pdyn_body of module.h). */
#ifndef PDYN_BODY_H
#define PDYN_BODY_H

#include "projdyn/module.h"

/* Whether it is a body of particles. The others have a surface: sheets, volumes, rigid bodies. */
static inline bool body_is_particles(const pdyn_body *body) { return body->radius > 0.0; }

/* Whether it is a sheet, which has a mass per area. Volumes and rigid bodies have an inside; their
 * triangles face outwards. */
static inline bool body_is_sheet(const pdyn_body *body) { return body->area_density > 0.0; }

/* Whether fluids rest farther from its surface where there is contact: sheets and rigid bodies do,
 * volumes do not (docs/theory/interface.md#thickness). */
static inline bool body_is_thick(const pdyn_body *body) { return body->triangles && !body->tets; }

/* Whether particle i of the system belongs to the body. */
static inline bool body_has(const pdyn_body *body, int i) {
    return i >= body->first && i < body->first + body->count;
}

#endif
