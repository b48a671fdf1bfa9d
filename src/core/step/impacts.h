/* Impacts with bdf2. A two-step formula would continue the jump of v in an impact as an
 * acceleration, and a body that falls on a floor would bounce. Therefore the impulse h_e a of an
 * impact acts as a displacement h_e^2 a over h, as with Euler, and is added to v_before, too. Both
 * are sums of constraint forces. A limit may take a part of them; that part goes to other particles
 * or to the pins of the body, so momentum is conserved. */
#ifndef PDYN_IMPACTS_H
#define PDYN_IMPACTS_H

#include "sim/sim.h"

/* Call after a step of length h, s, with its velocities known. Corrects velocities and those of the
 * step before, reduces the impacts on solids to the part that velocities received, and sets
 * sim->impacts, whose numbers are 0 before. With Euler there are none. */
void impacts_correct(struct pdyn_sim *sim, double h);

#endif
