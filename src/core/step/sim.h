/* The simulation: a scene turned into particles, batches of constraints and a solver. */
#ifndef PDYN_SIM_H
#define PDYN_SIM_H

#include "accelerate.h"
#include "base/context.h"
#include "geometry/mesh.h"
#include "geometry/sampling.h"
#include "integrator.h"
#include "kinematic_solids.h"
#include "objective/objective.h"
#include "objective/solver_view.h"
#include "rows/batch.h"
#include "scene/scene.h"
#include "solid_load.h"
#include "sph/neighbours.h"

struct pdyn_sim {
    pdyn_context *context;
    struct scene scene;
    bool failed; /* diverged: no further step */
    bool warned; /* of too long a step */

    int bodies;
    pdyn_body *body;                 /* what modules see */
    struct topology *topology;       /* bodies; empty for particles */
    double *rest;                    /* particles x 3: the bodies' rest positions, m */
    struct boundary_points boundary; /* points on the solids */
    struct kinematic_solids motion;  /* of the last of these */
    struct solid_loads *loads;       /* forces on the solids; NULL in a scene without */
    pdyn_services services;          /* what operators may call */

    int constraints; /* batches that are constraints of the scene; their dampers follow */
    struct objective objective; /* particles' masses, prediction, batches: what is minimised */
    double *x, *v;              /* particles x 3: the state, m, m/s */
    double *density;            /* particles, kg/m^3 */
    double *pressure;           /* particles, Pa, */
    double *pressure_before;    /* and a step before */
    double *x_next;             /* particles x 3: the iterate */
    double *way;      /* particles, samples, m: how far each may go at once; NULL: no limit */
    double *gradient; /* particles x 3: of E at the iterate, N */
    double *trial, *trial_gradient, *direction, *negative; /* particles x 3 */
    double *x_before, *v_before; /* particles x 3: the state a step earlier, m, m/s; NULL where the
                                    integrator needs none */
    double *x_base, *v_base; /* particles x 3: from where the inertia of this step moves, m, m/s */
    double *constraint_acceleration; /* particles x 3: by the constraints in the last step, m/s^2 */
    bool unfinished;                 /* the last step was cut short: that is not one to repeat */
    double last_h;                   /* s, length of the last step; 0 before the first */
    int impacts;                     /* constraints in the last step */
    double history; /* s, between x_before and x; 0: nothing is to be built upon that */
    double damping; /* eps, kept from step to step */
    bool anchored;  /* some constraint can take momentum from the system */

    struct live_particles *live; /* particles that come and go; NULL where none does */

    struct neighbours *neighbours;   /* NULL where no constraint needs them */
    struct surface_samples *samples; /* on surfaces, where these meet a fluid; otherwise NULL */
    struct occlusion *occlusion;     /* the same surfaces, between fluid and fluid */

    struct solver_view model; /* what the solver sees */
    const pdyn_global_solver *solver;
    void *solver_state;
    const char *solver_reason;
    struct acceleration acceleration;

    double time; /* s */
    long frame;  /* the last frame reached */
    long steps;

    void (*observer)(void *user, const pdyn_iteration *iteration);
    void *observer_user;
};

/* What core offers to operators. */
pdyn_services sim_services(pdyn_context *context);

#endif
