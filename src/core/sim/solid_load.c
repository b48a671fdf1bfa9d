/* Loads on solids: sums of the forces of operators and contact pairs. Loads on bodies. */
#include "solid_load.h"

#include "base/bad_call.h"
#include "contact/contact.h"
#include "forces.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <string.h>

void load_add(struct load *load, const double *x, const double *force) {
    double moment[3];
    vec3_cross(moment, x, force);
    vec3_add(load->force, 1.0, force);
    vec3_add(load->moment, 1.0, moment);
}

void load_copy(const struct load *load, double force[3], double moment[3]) {
    memcpy(force, load->force, sizeof load->force);
    memcpy(moment, load->moment, sizeof load->moment);
}

/* ---- fluid ----------------------------------------------------------------------------------- */

static void add_point_forces(const struct pdyn_sim *sim, const double *force) {
    const struct boundary_points *points = &sim->boundary;
    for (int k = 0; k < points->at.count; k++)
        load_add(&sim->loads->solid[PDYN_LOAD_ALL][points->point[k].solid],
                 points->at.x + 3 * (size_t)k, force + 3 * (size_t)k);
}

/* The operator takes its multipliers from the call of `force` before. */
static void add_operator(const struct pdyn_sim *sim, struct batch *b) {
    batch_force(b, b->one_sided.mean, sim->trial);
    b->type->matrix_free->boundary_force(b->op, sim->loads->force);
}

/* The vector from boundary point k of a box to the face before it, m. A moving point has its place
 * in the first layer, half a spacing before the face. */
static void find_face(const struct pdyn_sim *sim, int k, double offset[3]) {
    const struct kinematic_solids *moving = &sim->kinematic;
    double behind = sim_behind_faces(sim), layer = behind + 0.5 * sim_spacing(sim);
    int m = k - kinematic_first_point(sim);
    memset(offset, 0, 3 * sizeof *offset);
    if (m < 0) vec3_add(offset, behind, sim->boundary.point[k].normal);
    if (m < 0 || m >= moving->layer.count) return;
    vec3_subtract(offset, moving->layer.x + 3 * (size_t)m, sim->boundary.at.x + 3 * (size_t)k);
    for (int a = 0; a < 3; a++) offset[a] *= behind / layer;
}

/* The forces of rows are those of shear and act on the faces of a box: adds the moments that forces
 * at its points lack. */
static void add_moments_of_faces(const struct pdyn_sim *sim) {
    const struct boundary_point *point = sim->boundary.point;
    for (int k = 0; k < sim->boundary.at.count; k++) {
        double offset[3], moment[3];
        if (!point[k].of_box) continue;
        find_face(sim, k, offset);
        vec3_cross(moment, offset, sim->loads->force + 3 * (size_t)k);
        vec3_add(sim->loads->solid[PDYN_LOAD_ALL][point[k].solid].moment, 1.0, moment);
    }
}

static void add_fluid(const struct pdyn_sim *sim) {
    size_t count = 3 * (size_t)sim->boundary.at.count;
    if (!count) return;
    memset(sim->loads->force, 0, count * sizeof *sim->loads->force);
    for (int b = 0; b < sim->objective.batches; b++) {
        const struct batch *batch = sim->objective.batch[b];
        if (!batch->op && batch->type->boundary_force)
            batch->type->boundary_force(batch->params, &batch->view, sim->loads->force);
    }
    add_moments_of_faces(sim);
    for (int b = 0; b < sim->objective.batches; b++) {
        struct batch *batch = sim->objective.batch[b];
        if (batch->op && batch->type->matrix_free->boundary_force) add_operator(sim, batch);
    }
    add_point_forces(sim, sim->loads->force);
    memcpy(sim->loads->solid[PDYN_LOAD_FLUID], sim->loads->solid[PDYN_LOAD_ALL],
           (size_t)sim->scene.solids * sizeof **sim->loads->solid);
}

/* ---- contact --------------------------------------------------------------------------------- */

static void add_contact_force(const struct pdyn_sim *sim, int solid, const double *x,
                              const double *force) {
    load_add(&sim->loads->solid[PDYN_LOAD_ALL][solid], x, force);
    load_add(&sim->loads->solid[PDYN_LOAD_CONTACT][solid], x, force);
}

/* Adds the force of element e, one row, on the solids of its contact. */
static void add_element(const struct pdyn_sim *sim, const struct batch *batch, int e) {
    struct contact_vertex vertex[4];
    double g[3];
    int count = contact_list_vertices(sim->objective.contact, batch->view.contacts, e, vertex);
    forces_row_gradient(sim, batch, e, e, g);
    for (int k = 0; k < count; k++) {
        double force[3] = {0};
        vec3_add(force, -vertex[k].coefficient, g);
        add_contact_force(sim, vertex[k].solid, vertex[k].x, force);
    }
}

/* u of a dashpot between a body and a solid is its end on the body, on which acts -g. */
static void add_damping(const struct pdyn_sim *sim) {
    const struct batch *b = sim->objective.dashpots;
    for (int e = 0; b && e < b->view.elements; e++) {
        double g[3];
        int solid = contact_dashpot_solid(sim->objective.contact, e);
        if (solid < 0) continue;
        forces_row_gradient(sim, b, e, e, g);
        add_contact_force(sim, solid, b->view.u + 3 * (size_t)e, g);
    }
}

static void add_contact(const struct pdyn_sim *sim) {
    const struct objective *o = &sim->objective;
    if (!o->contact) return;
    for (int e = 0; e < o->barrier->view.elements; e++) add_element(sim, o->barrier, e);
    for (int e = 0; o->friction && e < o->friction->view.elements; e++)
        add_element(sim, o->friction, e);
    add_damping(sim);
}

/* ---- loads on all solids --------------------------------------------------------------------- */

static bool resize_arrays(struct pdyn_sim *sim, enum array_action action) {
    struct load **solid = sim->loads->solid;
    const struct array_entry table[] = {ARRAY(solid[PDYN_LOAD_ALL], sim->scene.solids),
                                        ARRAY(solid[PDYN_LOAD_FLUID], sim->scene.solids),
                                        ARRAY(solid[PDYN_LOAD_CONTACT], sim->scene.solids),
                                        ARRAY(sim->loads->force, 3 * sim->boundary.at.count)};
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
}

pdyn_status solid_load_create(struct pdyn_sim *sim) {
    if (!sim->scene.solids) return PDYN_OK;
    sim->loads = NEW_ARRAY(sim->context, 1, struct solid_loads);
    return sim->loads && resize_arrays(sim, ARRAYS_ALLOCATE) ? PDYN_OK : PDYN_NO_MEMORY;
}

void solid_load_free(struct pdyn_sim *sim) {
    if (!sim->loads) return;
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(sim->context, sim->loads, 1);
}

const struct load *solid_load_compute(const struct pdyn_sim *sim, pdyn_load_source source) {
    struct solid_loads *l = sim->loads;
    if (!l || !sim->forces_known) return NULL;
    if (l->summed) return l->solid[source];
    for (int k = 0; k < LOAD_SOURCES; k++)
        memset(l->solid[k], 0, (size_t)sim->scene.solids * sizeof *l->solid[k]);
    add_fluid(sim);
    add_contact(sim);
    l->summed = true;
    return l->solid[source];
}

/* ---- public functions ------------------------------------------------------------------------ */

static void copy_solid_load(const pdyn_sim *sim, int solid, pdyn_load_source source,
                            double force[3], double moment[3]) {
    static const struct load none;
    const struct load *loads = solid_load_compute(sim, source);
    load_copy(loads ? loads + solid : &none, force, moment);
}

pdyn_status pdyn_solid_load_by(const pdyn_sim *sim, int solid, pdyn_load_source source,
                               double force[3], double moment[3]) {
    if (HAS_NULL(sim, force, moment) || BAD_INDEX(solid, sim->scene.solids) ||
        BAD_INDEX(source, LOAD_SOURCES))
        return PDYN_BAD_CALL;
    copy_solid_load(sim, solid, source, force, moment);
    return PDYN_OK;
}

pdyn_status pdyn_solid_load(const pdyn_sim *sim, int solid, double force[3], double moment[3]) {
    if (HAS_NULL(sim, force, moment) || BAD_INDEX(solid, sim->scene.solids)) return PDYN_BAD_CALL;
    copy_solid_load(sim, solid, PDYN_LOAD_ALL, force, moment);
    return PDYN_OK;
}

pdyn_status pdyn_body_load_by(const pdyn_sim *sim, int body, pdyn_load_source source,
                              double force[3], double moment[3]) {
    if (HAS_NULL(sim, force, moment) || BAD_INDEX(body, sim->bodies) ||
        BAD_INDEX(source, LOAD_SOURCES))
        return PDYN_BAD_CALL;
    forces_sum(sim, source, sim->trial);
    struct load load = forces_load_on(sim, body, sim->trial);
    load_copy(&load, force, moment);
    return PDYN_OK;
}
