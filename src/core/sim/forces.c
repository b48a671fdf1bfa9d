/* Forces of constraints at the end of the last step: minus the gradient of their energy,
 *
 *     rows tier       -G' w (u - p)                       u, p of the last local step
 *     operator tier   - sum of k_i max(0, C_i) grad C_i   multipliers stored by batch_accept
 *
 * The force of an impact is reduced by the part that the integrator does not apply to velocities.
 * The rest is the mean force of the step: times h it is the change of momentum
 * (docs/theory/time-integration.md). */
#include "forces.h"

#include "base/bad_call.h"
#include "contact/contact.h"
#include "sim.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

/* ---- gradients ------------------------------------------------------------------------------- */

/* d = u - p of row r. Rows that are joined to one matrix have p = 0 and no u (linear_rows.h). */
static void row_distance(const struct pdyn_sim *sim, const struct batch *b, int r, double d[3]) {
    const pdyn_batch *v = &b->view;
    if (!b->linear) {
        vec3_subtract(d, v->u + 3 * (size_t)r, v->p + 3 * (size_t)r);
        return;
    }
    d[0] = d[1] = d[2] = 0.0;
    for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
        vec3_add(d, v->coefficient[k], sim->x_next + 3 * (size_t)v->column[k]);
}

void forces_row_gradient(const struct pdyn_sim *sim, const struct batch *b, int e, int r,
                         double g[3]) {
    row_distance(sim, b, r, g);
    double part = batch_has_impacts(b) ? 1.0 : 1.0 - b->left_out;
    for (int a = 0; a < 3; a++) g[a] *= part * b->view.weight[e];
    if (batch_has_impacts(b) && b->left_out > 0.0)
        vec3_add(g, -b->left_out, b->flux + 4 * (size_t)r);
}

static void add_rows(const struct pdyn_sim *sim, const struct batch *b, double *gradient) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < v->elements; e++)
        for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++) {
            double g[3];
            forces_row_gradient(sim, b, e, r, g);
            for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
                vec3_add(gradient + 3 * (size_t)v->column[k], v->coefficient[k], g);
        }
}

/* Adds the gradient of the energy of a batch. */
static void add_gradient(const struct pdyn_sim *sim, struct batch *b, double *gradient) {
    if (b->op) batch_force(b, b->one_sided.mean, gradient);
    else add_rows(sim, b, gradient);
}

/* ---- batches --------------------------------------------------------------------------------- */

/* Force of dashpot e along its normal, N. */
static double dashpot_force(const struct pdyn_sim *sim, int e) {
    const struct batch *b = sim->objective.dashpots;
    double g[3];
    forces_row_gradient(sim, b, e, e, g);
    return -vec3_dot(g, b->view.contacts->dashpot[e].normal);
}

void forces_store_normal(struct pdyn_sim *sim) {
    const struct objective *o = &sim->objective;
    if (!o->friction) return;
    double *force = contact_normal_forces(o->contact);
    for (int e = 0; e < o->barrier->view.elements; e++) {
        double g[3];
        forces_row_gradient(sim, o->barrier, e, e, g);
        force[e] = vec3_length(g);
    }
    for (int e = 0; o->dashpots && e < o->dashpots->view.elements; e++)
        contact_add_dashpot_force(o->contact, e, dashpot_force(sim, e));
    contact_store_forces(o->contact);
}

typedef bool choose_fn(const struct batch *batch);

static bool is_any(const struct batch *batch) {
    (void)batch;
    return true;
}

static bool is_of_contact(const struct batch *batch) { return batch->type->flags & PDYN_CONTACT; }

/* Whether a batch is of PDYN_LOAD_FLUID. */
static bool is_of_fluid(const struct batch *batch) {
    return needs_neighbour_lists(batch->type) || batch->type->flags & PDYN_FLUID;
}

/* Whether a batch is of PDYN_LOAD_CONTACT. */
static bool is_of_contact_alone(const struct batch *batch) {
    return is_of_contact(batch) && !is_of_fluid(batch);
}

/* force = the sum over the chosen batches, of one constraint if it is not NULL; 0 while forces are
 * unknown. */
static void sum_forces(const struct pdyn_sim *sim, choose_fn *choose,
                       const struct batch *constraint, double *force) {
    const struct objective *objective = &sim->objective;
    memset(force, 0, objective_bytes(objective));
    for (int b = 0; sim->forces_known && b < objective->batches; b++) {
        struct batch *batch = objective->batch[b];
        if (!choose(batch) || (constraint && !batch_belongs_to(batch, constraint))) continue;
        add_gradient(sim, batch, force);
    }
    for (int k = 0; k < 3 * objective->particles; k++) force[k] = 0.0 - force[k]; /* no -0 */
}

void forces_forget(struct pdyn_sim *sim) {
    sim->forces_known = false;
    if (sim->loads) sim->loads->summed = false;
}

/* Whether a load counts particle i: the body has it, NULL: always. */
static bool is_on(const pdyn_body *body, int i) {
    return !body || (i >= body->first && i < body->first + body->count);
}

/* The load by the rows of a batch on a body, NULL: on all particles. */
static void add_row_load(const struct pdyn_sim *sim, const struct batch *b, const pdyn_body *on,
                         struct load *load) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < v->elements; e++)
        for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++) {
            double g[3];
            forces_row_gradient(sim, b, e, r, g);
            for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++) {
                double force[3] = {0};
                if (!is_on(on, v->column[k])) continue;
                vec3_add(force, -v->coefficient[k], g);
                load_add(load, sim->x_next + 3 * (size_t)v->column[k], force);
            }
        }
}

/* The same of an operator. */
static void add_operator_load(const struct pdyn_sim *sim, const struct batch *b,
                              const pdyn_body *on, struct load *load) {
    double *force = sim->trial;
    sum_forces(sim, is_any, b, force);
    for (int i = 0; i < sim->objective.particles; i++)
        if (is_on(on, i)) load_add(load, sim->x_next + 3 * (size_t)i, force + 3 * (size_t)i);
}

void forces_add_load(const struct pdyn_sim *sim, int k, const pdyn_body *on, struct load *load) {
    const struct objective *objective = &sim->objective;
    for (int b = 0; sim->forces_known && b < objective->batches; b++)
        if (batch_belongs_to(objective->batch[b], objective->batch[k]))
            (objective->batch[b]->op ? add_operator_load : add_row_load)(sim, objective->batch[b],
                                                                         on, load);
}

void forces_sum(const struct pdyn_sim *sim, pdyn_load_source source, double *force) {
    static choose_fn *const choose[LOAD_SOURCES] = {is_any, is_of_fluid, is_of_contact_alone};
    sum_forces(sim, choose[source], NULL, force);
}

struct load forces_load_on(const struct pdyn_sim *sim, int b, const double *force) {
    const struct objective_body *body = &sim->objective.body[b];
    struct load load = {{0}, {0}};
    for (int i = body->first; i < body->first + body->count; i++)
        load_add(&load, sim->x + 3 * (size_t)i, force + 3 * (size_t)i);
    return load;
}

double forces_virial(const struct pdyn_sim *sim, int k) {
    const struct batch *b = sim->objective.batch[k];
    double sum = 0.0;
    for (int r = 0; sim->forces_known && r < b->rows; r++) {
        int entry = b->view.row_entry[r];
        double d[3];
        if (entry == b->view.row_entry[r + 1]) continue; /* a row without entries */
        row_distance(sim, b, r, d);
        sum -= b->view.weight[b->entry_element[entry]] * vec3_dot(d, b->view.u + 3 * (size_t)r);
    }
    return sum;
}

/* Pins of a body that pass on a force T of impacts: the part of theirs along T is left out of them
 * as it is of the impacts. */
static void pass_on(struct pdyn_sim *sim, const pdyn_body *body, const double passed[3]) {
    struct objective *objective = &sim->objective;
    struct load load = {{0}, {0}};
    for (int b = 0; b < objective->batches; b++)
        if (batch_pins(objective->batch[b], body))
            add_row_load(sim, objective->batch[b], NULL, &load);
    double size = vec3_dot(load.force, load.force);
    double part = size > 0.0 ? -vec3_dot(load.force, passed) / size : 0.0;
    for (int b = 0; b < objective->batches; b++)
        if (batch_pins(objective->batch[b], body))
            objective->batch[b]->left_out = sim->impacts.left_out * fmin(1.0, fmax(0.0, part));
}

void forces_pass_on(struct pdyn_sim *sim) {
    for (int b = 0; sim->impacts.left_out > 0.0 && b < sim->bodies; b++)
        if (vec3_length(sim->impacts.passed_on + 3 * (size_t)b) > 0.0)
            pass_on(sim, &sim->body[b], sim->impacts.passed_on + 3 * (size_t)b);
}

/* ---- public functions ------------------------------------------------------------------------ */

pdyn_status pdyn_constraint_forces(const pdyn_sim *sim, int constraint, double *force) {
    if (HAS_NULL(sim, force) || BAD_INDEX(constraint, sim->constraints)) return PDYN_BAD_CALL;
    sum_forces(sim, is_any, sim->objective.batch[constraint], force);
    return PDYN_OK;
}

pdyn_status pdyn_constraint_load(const pdyn_sim *sim, int constraint, double force[3],
                                 double moment[3]) {
    struct load load = {{0}, {0}};
    if (HAS_NULL(sim, force, moment) || BAD_INDEX(constraint, sim->constraints))
        return PDYN_BAD_CALL;
    forces_add_load(sim, constraint, NULL, &load);
    load_copy(&load, force, moment);
    return PDYN_OK;
}

pdyn_status pdyn_contact_forces(const pdyn_sim *sim, double *force) {
    if (HAS_NULL(sim, force)) return PDYN_BAD_CALL;
    sum_forces(sim, is_of_contact, NULL, force);
    return PDYN_OK;
}

/* ---- elements -------------------------------------------------------------------------------- */

struct element {
    double energy, distance; /* J; see probe.h */
};

static struct element row_element(const pdyn_sim *sim, const struct batch *b, int e) {
    const pdyn_batch *v = &b->view;
    double squares = 0.0, d[3];
    for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++) {
        row_distance(sim, b, r, d);
        squares += vec3_dot(d, d);
    }
    bool given = b->type->energy && !b->linear && !b->off;
    return (struct element){given ? b->type->energy(b->params, v, e, e + 1)
                                  : 0.5 * v->weight[e] * squares,
                            sqrt(squares)};
}

static struct element operator_element(const struct batch *b, int e) {
    const struct one_sided *s = &b->one_sided;
    return (struct element){e < s->at.count ? one_sided_energy(s, e) : 0.0, 0.0};
}

pdyn_status pdyn_element_values(const pdyn_sim *sim, int constraint, double *energy,
                                double *distance) {
    if (HAS_NULL(sim) || BAD_INDEX(constraint, sim->constraints)) return PDYN_BAD_CALL;
    const struct batch *b = sim->objective.batch[constraint];
    for (int e = 0; e < b->view.elements; e++) {
        struct element value = {0};
        if (sim->forces_known) value = b->op ? operator_element(b, e) : row_element(sim, b, e);
        if (energy) energy[e] = value.energy;
        if (distance) distance[e] = value.distance;
    }
    return PDYN_OK;
}
