/* The two kinds of bodies (pdyn_body of module.h): a body of particles, or one with a surface: a
 * sheet, a volume or a rigid body. */
#ifndef PDYN_BODY_H
#define PDYN_BODY_H

#include "projdyn/module.h"

static inline bool body_is_particles(const pdyn_body *body) { return body->radius > 0.0; }

#endif
