/* The simulation (pdyn_sim): particles, batches of constraints, state and solver built from a
 * scene. */
#ifndef PDYN_SIM_H
#define PDYN_SIM_H

#include "base/body.h"
#include "base/context.h"
#include "base/warnings.h"
#include "control.h"
#include "energy_budget.h"
#include "geometry/mesh.h"
#include "geometry/sampling.h"
#include "kinematic_solids.h"
#include "objective/objective.h"
#include "objective/solver_view.h"
#include "rows/batch.h"
#include "scene/scene.h"
#include "solid_load.h"
#include "solver_choice.h"
#include "sph/boundary.h"
#include "walls.h"

struct carried;
struct probes;

struct pdyn_sim {
    pdyn_context *context;
    struct scene scene;
    bool failed;  /* diverged: pdyn_step fails until a state is restored */
    bool in_step; /* a step is being computed */

    /* The state, and what the last steps leave for the next one. */
    double *x, *v; /* particles x 3, m and m/s */
    double time;   /* s */
    long frame;    /* index of the last frame reached */
    long steps;
    double *density;             /* particles, kg/m^3 */
    double *pressure;            /* particles, Pa */
    double *pressure_before;     /* particles, Pa: one step earlier */
    double *x_before, *v_before; /* particles x 3: the state one step earlier, m and m/s; NULL: the
                                    integrator needs none */
    double *constraint_acceleration; /* particles x 3, m/s^2: acceleration by constraints in the
                                        last step */
    double history; /* s, time from x_before to x; 0: the history must not be used */
    double last_h;  /* s, length of the last step; 0 before the first */
    double eps;     /* damping of the next global step, continued from step to step */
    bool solved;    /* the last step was solved to the tolerance */
    bool far_off;   /* the last step was far from solved: its end is no guess for the next one */

    /* What is minimised in a step. */
    struct objective objective; /* masses, prediction s, batches */
    int constraints; /* number of batches that are constraints of the scene; their dampers follow */
    const struct scene_constraint **constraint; /* constraints: in the scene */
    bool anchored; /* a constraint can change the momentum of the system */

    /* A step: from the base to the prediction, and from there to the last iterate. */
    double *x_base, *v_base; /* particles x 3: base of the step (step/integrator.h), m and m/s */
    double *x_next;          /* particles x 3: the iterate, m */
    double *gradient;        /* particles x 3: gradient of E at the iterate, N */
    double *max_step; /* particles, then samples, m: largest displacement of an iterate; NULL:
                         none */
    /* particles x 3: scratch of the minimisation; rhs: minus the gradient of the model, and scratch
     * of step/stop_paths.c. Between two minimisations they are free: impacts.c, velocities.c and
     * momentum.c of step/, forces.c, solid_load.c and probe_wall.c overwrite them. */
    double *trial, *trial_gradient, *direction, *rhs;
    struct solver_view model; /* the solver's view of the objective */
    struct solver_choice choice;
    const pdyn_global_solver *solver; /* the one in use */
    void *solver_state;

    /* Forces of the last step. */
    bool forces_known; /* its last local step belongs to the state: forces can be computed */
    double slowed;     /* part of the kinetic energy that the end of the step took away, as it was
                          far from solved and had gained energy */
    /* What step/impacts.c computes. */
    struct {
        int count;         /* constraints with an impact */
        double left_out;   /* 1 - (h_e / h)^2: the part of their forces that does not change
                              velocities */
        double *passed_on; /* bodies x 3, N: force of impacts that the body's pins take up */
        int *group;        /* particles: those that impacts of a step join (base/groups.h) */
    } impacts;
    int *momentum_group;       /* particles: of this step (step/momentum.h, base/groups.h) */
    struct solid_loads *loads; /* forces on solids; NULL in a scene without solids */

    /* Bodies and solids. */
    int bodies;
    pdyn_body *body;                 /* bodies as modules see them */
    struct topology *topology;       /* bodies; empty for bodies of particles */
    double *rest;                    /* particles x 3, m: rest positions */
    struct live_particles *live;     /* NULL: all particles are live */
    struct boundary_points boundary; /* boundary points on solids */
    double *face_x; /* boundary x 3, m: see neighbours_def; NULL: nothing hides boundary points */
    struct kinematic_solids kinematic; /* the solids that move, with the last boundary points */
    struct carried *carried;           /* beside moving solids; NULL: nothing is carried */
    struct border border;              /* of the surfaces with samples that hide particles */
    struct occlusion *occlusion;       /* surfaces, which hide fluid particles from each other */
    struct walls walls;                /* solids, which hide samples from the fluid */
    pdyn_services services;            /* functions that operators may call */

    /* The program, and what it is told. */
    struct control control; /* what it changes between steps */
    struct probes *probes;  /* NULL in a scene without probes */
    void (*observer)(void *user, const pdyn_iteration *iteration);
    void *observer_user;
    struct warning_list warnings;
    struct energy_budget energy;
    struct crossings *crossings; /* NULL: nothing can pass a surface */
    double floor; /* m: a particle below this height fell out of the scene (extent.h) */
};

/* Whether the solver in use solves for the pressures of a fluid without other constraints. */
static inline bool solves_fluid_alone(const struct pdyn_sim *sim) {
    const pdyn_model *model = &sim->model.model;
    return sim->solver->dual && !model->elements_count && !model->dynamic_count &&
           !model->solve_bodies;
}

/* Whether a constraint of body b works on neighbour lists. */
static inline bool has_neighbour_lists(const struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    for (int k = 0; k < body->constraints; k++)
        if (needs_neighbour_lists(body->constraint[k].type)) return true;
    return false;
}

/* Particle spacing of the bodies whose constraints work on neighbour lists, m; 0: there are none.
 */
static inline double sim_spacing(const struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++)
        if (has_neighbour_lists(sim, b)) return 2.0 * sim->body[b].radius;
    return 0.0;
}

/* Distance of boundary points behind the faces of their box, m. */
static inline double sim_behind_faces(const struct pdyn_sim *sim) {
    const struct scene_settings *settings = &sim->scene.settings;
    return boundary_outside(settings->boundary, settings->kernel) * sim_spacing(sim);
}

static inline bool sim_has_constraint(const struct pdyn_sim *sim, int constraint) {
    return sim && constraint >= 0 && constraint < sim->constraints;
}

/* The next step begins from the state alone: without history, with solvers that keep nothing of
 * earlier steps, and with eps = 1, the largest damping, if it is a newton step. */
static inline void sim_forget_steps(struct pdyn_sim *sim) {
    sim->history = 0.0;
    solver_choice_reject(sim);
    if (sim->scene.settings.newton) sim->eps = 1.0;
}

/* Counts a warning at the current time (warnings_count); returns it for warnings_say. */
static inline struct warning *sim_warning(struct pdyn_sim *sim, enum warning_code code,
                                          const char *subject, long count, double value) {
    return warnings_count(&sim->warnings, code, subject, sim->time, count, value);
}

/* Whether pins or holds act on body b. */
static inline bool sim_pins_body(const struct pdyn_sim *sim, int b) {
    for (int k = 0; k < sim->objective.batches; k++)
        if (batch_pins(sim->objective.batch[k], &sim->body[b])) return true;
    return false;
}

#endif
