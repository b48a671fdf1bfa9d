/* The energy that a scene can have. A start in which particles overlap, or a step that failed,
 * releases energy that nothing in the scene has given; the budget finds it.
 *
 *     kinetic <= 2 (kinetic + stored at the start + M g (highest - lowest height) + drive)
 *
 * stored: the largest energy so far of the constraints on cloth and solids (those with rows) and of
 * contact, and that of fluids at the start, as far as it belongs to a density error of 2 %. drive:
 * what inlets and moving solids can give. The factor 2 covers that velocities are measured from
 * displacements. A scene with another source of energy (wind, moving pins, elements that come and
 * go) has no such bound before the last of them has ended ("until"); "start" is then that time. */
#ifndef PDYN_ENERGY_BUDGET_H
#define PDYN_ENERGY_BUDGET_H

#include "base/snapshot_file.h"

#include "projdyn/projdyn.h"

struct pdyn_sim;

struct energy_budget {
    bool bounded;         /* the sources of energy are known in this step */
    bool closed;          /* no inlet and no moving solid: if bounded, the total energy can only
                             fall */
    bool opened;          /* the first bounded step has begun: the numbers below are known */
    double mass;          /* kg, of everything */
    double start;         /* J: kinetic energy and energy of the fluid at the start, and drive */
    double stored;        /* J: energy of constraints with rows and of contact, largest so far */
    double potential;     /* J, at the start */
    double constraints;   /* J: energy of all constraints at the start of the run; read it with
                             energy_budget_constraints */
    double density_error; /* mean, at the start */
    double highest;       /* m, largest height so far, against gravity */
    double total;         /* J: what the total energy is compared with: that of the first step of
                             the run, or the smallest maximum of a window of steps so far, if that
                             is less */
    double window;        /* J: largest total energy of the present window */
    double window_steps;  /* of the present window so far */
    double scale;         /* J: largest kinetic or stored energy, or change of potential energy */
    double top, lowest;   /* m, heights at the end of the current attempt */
    double elastic;       /* J: energy of constraints with rows and of contact at that end */
    struct energy_block *block; /* partial results of the current attempt */
};

/* After a failure it is to be freed, too. */
pdyn_status energy_budget_create(struct pdyn_sim *sim);
void energy_budget_free(struct pdyn_sim *sim);

/* Measures the energy stored at the start of the first bounded step, before it is minimised. */
pdyn_status energy_budget_open(struct pdyn_sim *sim);

/* J: energy of all constraints at the start of the run; NAN: it was not bounded there, or has made
 * no step. */
double energy_budget_constraints(const struct pdyn_sim *sim);

/* Checks the displacement of a step of length h, s, before it is accepted. PDYN_DIVERGED: the
 * kinetic energy exceeds the budget. */
pdyn_status energy_budget_check(struct pdyn_sim *sim, double h);

/* Follows the energies of an accepted step; raises a warning if the total energy of a closed scene
 * rises by more than 5 % above the largest one of some earlier window of 20 steps. */
void energy_budget_step(struct pdyn_sim *sim, const pdyn_step_info *info);

void energy_budget_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
