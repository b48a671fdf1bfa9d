/* Loads on solids: sums of the forces of operators and contact pairs. */
#include "solid_load.h"

#include "sim.h"

#include "projdyn/vec3.h"

#include <string.h>

static void add_force(struct solid_load *load, const double *x, const double *force) {
    double moment[3];
    vec3_cross(moment, x, force);
    vec3_add(load->force, 1.0, force);
    vec3_add(load->moment, 1.0, moment);
}

/* ---- fluid ----------------------------------------------------------------------------------- */

static void add_point_forces(const struct pdyn_sim *sim, const double *force) {
    const struct boundary_points *points = &sim->boundary;
    for (int k = 0; k < points->at.count; k++)
        add_force(&sim->loads->solid[points->point[k].solid], points->at.x + 3 * (size_t)k,
                  force + 3 * (size_t)k);
}

static pdyn_status add_fluid(const struct pdyn_sim *sim) {
    size_t count = 3 * (size_t)sim->boundary.at.count;
    if (!count) return PDYN_OK;
    double *force = NEW_ARRAY(sim->context, count, double);
    if (!force) return PDYN_NO_MEMORY;
    for (int b = 0; b < sim->objective.batches; b++) {
        const struct batch *batch = sim->objective.batch[b];
        if (batch->op && batch->type->matrix_free->boundary_force)
            batch->type->matrix_free->boundary_force(batch->op, force);
    }
    add_point_forces(sim, force);
    FREE_ARRAY(sim->context, force, count);
    return PDYN_OK;
}

/* ---- contact --------------------------------------------------------------------------------- */

/* Adds the force of a contact. Its energy is a function of u = sum c_k x_k over the points of the
 * contact, with gradient w (u - p). The stored flux cannot be used, because impacts modify it. */
static void add_element(const struct pdyn_sim *sim, const struct contact_list *list, int e) {
    const struct contact *c = sim->objective.contact;
    const struct stencil *stencil = &list->stencil[e];
    const pdyn_batch *v = &list->batch->view;
    for (int k = 0; k < 4; k++) {
        double force[3];
        int point = stencil->point[k];
        if (point < c->free) continue;
        for (int a = 0; a < 3; a++)
            force[a] = -stencil->c[k] * v->weight[e] * (v->u[3 * e + a] - v->p[3 * e + a]);
        add_force(&sim->loads->solid[c->group[point] - c->bodies], c->at + 3 * (size_t)point,
                  force);
    }
}

static void add_contact(const struct pdyn_sim *sim) {
    const struct contact *c = sim->objective.contact;
    const struct contact_list *list[] = {c ? &c->current : NULL, c ? &c->start : NULL};
    for (int k = 0; k < 2 && c; k++)
        for (int e = 0; list[k]->batch && e < list[k]->batch->view.elements; e++)
            add_element(sim, list[k], e);
}

/* ---- public functions ------------------------------------------------------------------------ */

pdyn_status solid_load_create(struct pdyn_sim *sim) {
    int solids = sim->scene.solids;
    if (!solids) return PDYN_OK;
    sim->loads = NEW_ARRAY(sim->context, 1, struct solid_loads);
    if (!sim->loads) return PDYN_NO_MEMORY;
    sim->loads->solid = NEW_ARRAY(sim->context, solids, struct solid_load);
    return sim->loads->solid ? PDYN_OK : PDYN_NO_MEMORY;
}

void solid_load_free(struct pdyn_sim *sim) {
    if (!sim->loads) return;
    FREE_ARRAY(sim->context, sim->loads->solid, sim->scene.solids);
    FREE_ARRAY(sim->context, sim->loads, 1);
}

void solid_load_begin_step(struct pdyn_sim *sim) {
    if (sim->loads) sim->loads->known = sim->loads->summed = false;
}

void solid_load_end_step(struct pdyn_sim *sim) {
    if (sim->loads) sim->loads->known = true;
}

pdyn_status solid_load_compute(const struct pdyn_sim *sim, const struct solid_load **loads) {
    struct solid_loads *l = sim->loads;
    *loads = l && l->known ? l->solid : NULL;
    if (!*loads || l->summed) return PDYN_OK;
    memset(l->solid, 0, (size_t)sim->scene.solids * sizeof *l->solid);
    pdyn_status status = add_fluid(sim);
    if (status != PDYN_OK) return status;
    add_contact(sim);
    l->summed = true;
    return PDYN_OK;
}

const char *pdyn_solid_name(const pdyn_sim *sim, int solid) {
    return sim && solid >= 0 && solid < sim->scene.solids ? sim->scene.solid[solid].name : NULL;
}

pdyn_status pdyn_solid_load(const pdyn_sim *sim, int solid, double force[3], double moment[3]) {
    static const struct solid_load none;
    const struct solid_load *loads;
    if (!sim || !force || !moment || !pdyn_solid_name(sim, solid)) return PDYN_BAD_CALL;
    pdyn_status status = solid_load_compute(sim, &loads);
    if (status != PDYN_OK) return status;
    const struct solid_load *load = loads ? loads + solid : &none;
    memcpy(force, load->force, sizeof load->force);
    memcpy(moment, load->moment, sizeof load->moment);
    return PDYN_OK;
}
