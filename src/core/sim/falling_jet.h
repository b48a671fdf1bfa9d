/* A jet that falls becomes thinner: gravity stretches it by dw/dz = g / w, w: its speed, so its
 * volume stays only if it narrows with the radial velocity
 *
 *     v_r = -r/2 dw/dz        (continuity of an axisymmetric flow)
 *
 * In a liquid suction does that. A fluid whose constraint is one-sided has none: its jet would keep
 * its width and come apart into the layers of the inlet. So these begin with that velocity, which
 * the density stops where the jet is as dense as at rest. */
#ifndef PDYN_FALLING_JET_H
#define PDYN_FALLING_JET_H

struct pdyn_sim;
struct live_inlet;

/* Gives the radial velocity to the particles of `pusher`, a layer that the inlet lets go. Not in a
 * pool, whose pressure carries the water, and where the flow does not fall. */
void falling_jet_narrow(struct pdyn_sim *sim, const struct live_inlet *inlet, int pusher);

#endif
