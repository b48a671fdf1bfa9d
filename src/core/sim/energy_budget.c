#include "energy_budget.h"

#include "base/body.h"
#include "base/param_kind.h"
#include "extent.h"
#include "inlets.h"
#include "live_particles.h"
#include "measure.h"
#include "schedule.h"

#include "projdyn/vec3.h"

#include <stdio.h>

/* Mean density error of a fluid at rest on a lattice, at most. */
static const double normal_density_error = 0.02;
/* Water in front of a moving solid reaches several times its speed. */
static const double jet_speed = 10.0;
static const double slow_speed = 1e-3; /* m/s */
/* Stands for infinity: saved states refuse numbers that are not finite. */
static const double far = 1e300;
/* Steps of a window. Where a body turns fast for a few steps, as the end of a whip, displacements
 * are shorter than its path: the total energy falls for these steps and comes back. */
enum { WINDOW = 20 };
/* Rises of the total energy that are worth a warning: a share of the energies in motion, and of the
 * weight times the height of the scene. */
static const double max_gain = 0.05, min_gain = 1e-3;

struct energy_block { /* of a block of particles */
    double kinetic, highest, lowest;
};

static double total_mass(const struct pdyn_sim *sim) {
    double mass = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) mass += sim->objective.mass[i];
    return mass;
}

/* ---- sources of energy ----------------------------------------------------------------------- */

static bool has_path(const struct scene_constraint *c) {
    for (const pdyn_param *p = c->type->params; p->name; p++) {
        const pdyn_path *path = param_path(p, c->params);
        if (path && path->count) return true;
    }
    return false;
}

static bool is_source(const struct scene_constraint *c) {
    return type_gives_energy(c->type) || has_path(c);
}

/* Whether a constraint that has not ended gives energy. */
static bool has_sources(const struct pdyn_sim *sim) {
    for (int k = 0; k < sim->constraints; k++)
        if (is_source(sim->constraint[k]) && !schedule_has_ended(sim, sim->constraint[k]))
            return true;
    return false;
}

/* Kinetic energy that inlets and moving solids can give. */
static double drive(const struct pdyn_sim *sim) {
    double speed = fmax(jet_speed * kinematic_top_speed(sim),
                        inlets_top_speed(sim, 0.0, sim->scene.settings.duration));
    return 0.5 * sim->energy.mass * speed * speed;
}

/* ---- the start ------------------------------------------------------------------------------- */

static int blocks(const struct pdyn_sim *sim) {
    return pool_blocks(sim->objective.particles, PARTICLE_GRAIN);
}

pdyn_status energy_budget_create(struct pdyn_sim *sim) {
    struct energy_budget *e = &sim->energy;
    e->closed = !sim->live && kinematic_top_speed(sim) == 0.0;
    e->mass = total_mass(sim);
    e->constraints = far;
    e->block = NEW_ARRAY(sim->context, blocks(sim), struct energy_block);
    return e->block || !blocks(sim) ? PDYN_OK : PDYN_NO_MEMORY;
}

void energy_budget_free(struct pdyn_sim *sim) {
    FREE_ARRAY(sim->context, sim->energy.block, blocks(sim));
}

/* Energy of the constraints on cloth and solids, and of contact, which the scene may have on
 * purpose. */
static double elastic_energy(const struct pdyn_sim *sim) {
    const struct batch *barrier = sim->objective.barrier;
    double sum = barrier ? barrier->energy : 0.0;
    for (int b = 0; b < sim->constraints; b++)
        if (!sim->objective.batch[b]->op) sum += sim->objective.batch[b]->energy;
    return sum;
}

static double fluid_energy(const struct pdyn_sim *sim) {
    double sum = 0.0;
    for (int b = 0; b < sim->constraints; b++)
        if (sim->objective.batch[b]->op) sum += sim->objective.batch[b]->energy;
    return sum;
}

/* The energies at the start. Of that of fluids at the start of a run, only the part of a normal
 * density error counts. After a pin has let go, velocities of bdf2 follow for some steps: a window
 * passes before the total energy is compared. */
static void measure_start(struct pdyn_sim *sim) {
    struct energy_budget *e = &sim->energy;
    pdyn_step_info start = {0};
    for (int b = 0; b < sim->constraints; b++) {
        const struct batch *batch = sim->objective.batch[b];
        if (batch->op && batch->type->matrix_free->density)
            batch->type->matrix_free->density(batch->op, sim->density);
    }
    measure_step(sim, &start);
    double fluid = fluid_energy(sim), elastic = elastic_energy(sim);
    double part = fmin(1.0, normal_density_error / fmax(start.density_error_mean, 1e-300));
    if (sim->steps) part = 1.0;
    e->start = start.kinetic_energy + drive(sim) + part * part * fluid;
    e->potential = start.potential_energy;
    e->density_error = start.density_error_mean;
    e->stored = elastic;
    if (!sim->steps) e->constraints = elastic + fluid;
    e->scale = start.kinetic_energy + elastic + fluid;
    e->total = sim->steps ? far : -far;
    e->lowest = far, e->window = -far, e->highest = e->top = -far;
    for (int i = 0; i < sim->objective.particles; i++)
        if (particle_is_live(sim, i))
            e->highest = fmax(e->highest, extent_height(sim, sim->x + 3 * (size_t)i));
    e->opened = true;
}

pdyn_status energy_budget_open(struct pdyn_sim *sim) {
    double energy;
    sim->energy.bounded = !has_sources(sim);
    if (sim->energy.opened || !sim->energy.bounded || sim->control.driven) return PDYN_OK;
    pdyn_status status = objective_local(&sim->objective, sim->x, &energy, sim->gradient);
    if (status == PDYN_OK) measure_start(sim);
    return status;
}

double energy_budget_constraints(const struct pdyn_sim *sim) {
    return sim->energy.constraints == far ? NAN : sim->energy.constraints;
}

/* ---- steps ----------------------------------------------------------------------------------- */

struct step_job {
    const struct pdyn_sim *sim;
    double h;
};

static void measure_block(void *arg, int first, int last, int block) {
    const struct step_job *job = arg;
    const struct pdyn_sim *sim = job->sim;
    struct energy_block sum = {0.0, -far, far};
    for (int i = first; i < last; i++) {
        const double *x = sim->x_next + 3 * (size_t)i;
        if (!particle_is_live(sim, i)) continue;
        double speed = vec3_distance(x, sim->x + 3 * (size_t)i) / job->h;
        double height = extent_height(sim, x);
        sum.kinetic += 0.5 * sim->objective.mass[i] * speed * speed;
        sum.highest = fmax(sum.highest, height), sum.lowest = fmin(sum.lowest, height);
    }
    sim->energy.block[block] = sum;
}

/* Kinetic energy of the displacement of the attempt. Updates the heights of the attempt. */
static double kinetic_energy(struct pdyn_sim *sim, double h) {
    struct energy_budget *e = &sim->energy;
    struct step_job job = {sim, h};
    double sum = 0.0;
    pool_for(sim->context->pool, sim->objective.particles, PARTICLE_GRAIN, measure_block, &job);
    e->top = -far, e->lowest = far;
    for (int k = 0; k < blocks(sim); k++) {
        sum += e->block[k].kinetic;
        e->top = fmax(e->top, e->block[k].highest);
        e->lowest = fmin(e->lowest, e->block[k].lowest);
    }
    return sum;
}

/* J; 0 while no particle is live. */
static double weight_times_height(const struct pdyn_sim *sim) {
    const struct energy_budget *e = &sim->energy;
    double highest = fmax(e->highest, e->top), height = fmax(0.0, highest - e->lowest);
    return e->mass * vec3_length(sim->scene.settings.gravity) * height;
}

/* Kinetic energy, J, of a motion that is too slow to be an error or worth a warning. */
static double rest_energy(const struct pdyn_sim *sim) {
    return 0.5 * sim->energy.mass * slow_speed * slow_speed;
}

/* Name of the body with the largest kinetic energy in the displacement of the step. */
static const char *fastest_body(const struct pdyn_sim *sim) {
    double largest = -1.0;
    const char *name = "";
    for (int b = 0; b < sim->bodies; b++) {
        double sum = 0.0;
        const struct objective_body *body = &sim->objective.body[b];
        for (int i = body->first; i < body->first + body->count; i++) {
            double moved = vec3_distance(sim->x_next + 3 * (size_t)i, sim->x + 3 * (size_t)i);
            sum += sim->objective.mass[i] * moved * moved;
        }
        if (sum > largest) largest = sum, name = sim->body[b].name;
    }
    return name;
}

static bool has_surface(const struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++)
        if (!body_is_particles(&sim->body[b])) return true;
    return false;
}

/* The causes of a rise that the run has shown, for the message; "": none. Contact keeps surfaces
 * from passing, not particles of a fluid alone through solids. */
static void list_causes(char *text, size_t size, const struct pdyn_sim *sim) {
    bool passed = warnings_has(&sim->warnings, WARNING_LEAK);
    bool overlap = sim->energy.density_error > normal_density_error;
    bool compressed = warnings_has(&sim->warnings, WARNING_COMPRESSED);
    bool unsolved = warnings_has(&sim->warnings, WARNING_UNSOLVED);
    bool open = passed && !sim->scene.has_contact && has_surface(sim);
    snprintf(text, size, "%s%s%s%s%s",
             overlap ? "; particles overlap at the start, or are too close to each other" : "",
             compressed ? "; the fluid has been compressed by more than 10 %" : "",
             passed ? "; bodies have passed through each other or through solids" : "",
             open ? ", and the scene has no \"contact\"" : "",
             unsolved ? "; steps are unsolved" : "");
}

pdyn_status energy_budget_check(struct pdyn_sim *sim, double h) {
    struct energy_budget *e = &sim->energy;
    if (!e->bounded || sim->control.driven) return PDYN_OK;
    double kinetic = kinetic_energy(sim, h);
    e->elastic = elastic_energy(sim);
    /* Rounding makes the bending energy of a stiff plate at rest negative. */
    double stored = fmax(0.0, fmax(e->stored, e->elastic));
    double budget = 2.0 * (e->start + stored + weight_times_height(sim)) + rest_energy(sim);
    if (kinetic <= budget) return PDYN_OK;
    char causes[256];
    list_causes(causes, sizeof causes, sim);
    return set_error(PDYN_DIVERGED,
                     "the kinetic energy rises to %.3g J, most of it in body \"%s\", but "
                     "gravity and everything else in the scene can give at most %.3g J%s",
                     kinetic, fastest_body(sim), budget, causes);
}

/* A fall of the total energy counts once it has lasted for a whole window. */
static void update_window(struct energy_budget *e, double total) {
    if (e->total == -far) e->total = total;
    e->window = fmax(e->window, total);
    if (++e->window_steps < WINDOW) return;
    e->total = fmin(e->total, e->window);
    e->window = -far, e->window_steps = 0.0;
}

void energy_budget_step(struct pdyn_sim *sim, const pdyn_step_info *info) {
    struct energy_budget *e = &sim->energy;
    if (!e->bounded || sim->control.driven) return;
    e->highest = fmax(e->highest, e->top), e->stored = fmax(e->stored, e->elastic);
    if (!e->closed) return;
    double total = info->kinetic_energy + info->potential_energy + info->constraint_energy;
    double fallen = fabs(info->potential_energy - e->potential);
    e->scale = fmax(e->scale, fmax(fallen, fmax(info->kinetic_energy, info->constraint_energy)));
    update_window(e, total);
    double gain = total - e->total;
    double limit = max_gain * e->scale + min_gain * weight_times_height(sim) + rest_energy(sim);
    if (!(gain > limit)) return;
    struct warning *w = sim_warning(sim, WARNING_ENERGY, "", 1, gain);
    warnings_say(sim->context, w,
                 "the total energy rises by up to %.3g J, which is %.2g of the energy in motion; "
                 "nothing in the scene gives energy",
                 w->worst, w->worst / fmax(e->scale, 1e-300));
}

void energy_budget_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    struct energy_budget *e = &sim->energy;
    double *numbers[] = {&e->start,  &e->stored,      &e->potential,     &e->highest,
                         &e->total,  &e->scale,       &e->density_error, &e->constraints,
                         &e->window, &e->window_steps};
    snapshot_file_flags(file, &e->opened, 1, "the flag of its energy is neither 0 nor 1");
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        snapshot_file_numbers(file, numbers[k], 1, "an energy or a height is not finite");
}
