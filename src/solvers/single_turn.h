/* One iteration where all of H is static: blocks, factor and blocks in turn, each on what those
 * before leave,
 *
 *     z = omega D^-1 r
 *     t = A^-1 (r - H z)
 *     u = omega D^-1 (r - H (z + t))
 *
 * and a step to the minimum over these three and the last step p, which takes no more products than
 * conjugate gradients preconditioned by their sum, for H times each is kept. The factor of the
 * projective step's matrix A knows how a push travels through a sheet, but resists every motion
 * alike. D, the block diagonal of H, knows how soft each particle is along every direction, but
 * nothing of its neighbours. How much of each is right changes from solve to solve. */
#ifndef PDYN_SINGLE_TURN_H
#define PDYN_SINGLE_TURN_H

#include "single_cg.h"

enum { SPAN = 4, LAST = 3 }; /* directions: t, z, u and the last step, p */

struct turn_sums {                  /* of a block of particles */
    double product[SPAN][SPAN + 1]; /* of directions with H times directions, from the diagonal on,
                                       and with r */
    double rr;
};

/* From r, z = omega D^-1 r, p and q = H p (both 0 where there is none) to the next ones; adds the
 * step, size p, to y. `minimum`: p was such a step, of the same H. Returns r.p, by half of which
 * the model falls, and r.r after it; 0 where floats are at their end: r is not at right angles to p
 * any more, or what they should hold is not finite. */
double single_turn(struct single_cg *s, double size, double *y, bool minimum, double *rr);

#endif
