/* Public functions that read the state of a simulation. */
#include "base/param_kind.h"
#include "base/sized.h"
#include "base/snapshot_file.h"
#include "live_particles.h"

double pdyn_time(const pdyn_sim *sim) { return sim ? sim->time : 0.0; }
double pdyn_duration(const pdyn_sim *sim) { return sim ? sim->scene.settings.duration : 0.0; }
double pdyn_frame_interval(const pdyn_sim *sim) {
    return sim ? sim->scene.settings.frame_interval : 0.0;
}
bool pdyn_has_reached(const pdyn_sim *sim, double time) {
    return !sim || sim->time >= time * (1.0 - 1e-9);
}
bool pdyn_is_finished(const pdyn_sim *sim) { return pdyn_has_reached(sim, pdyn_duration(sim)); }
const char *pdyn_solver_type(const pdyn_sim *sim) {
    return sim && sim->choice.count ? sim->choice.slot[0].solver->name : "";
}
const char *pdyn_solver_reason(const pdyn_sim *sim) {
    return sim && sim->choice.reason ? sim->choice.reason : "";
}
double pdyn_contact_stiffness(const pdyn_sim *sim) {
    return sim && sim->scene.has_contact ? sim->scene.contact.stiffness : 0.0;
}
const char *pdyn_step_type(const pdyn_sim *sim) {
    return !sim ? "" : sim->scene.settings.newton ? "newton" : "projective";
}

const char *pdyn_solid_name(const pdyn_sim *sim, int solid) {
    return sim && solid >= 0 && solid < sim->scene.solids ? sim->scene.solid[solid].name : NULL;
}

void pdyn_observe(pdyn_sim *sim, void (*observer)(void *user, const pdyn_iteration *), void *user) {
    if (!sim) return;
    sim->observer = observer;
    sim->observer_user = user;
}

static pdyn_state get_state(const pdyn_sim *sim) {
    if (!sim) return (pdyn_state){0};
    return (pdyn_state){.particles = sim->objective.particles,
                        .x = sim->x,
                        .v = sim->v,
                        .mass = sim->objective.mass,
                        .density = sim->density,
                        .pressure = sim->pressure,
                        .live = sim->live ? sim->live->live : NULL,
                        .boundary = sim->boundary.at.count,
                        .moving = sim->kinematic.points,
                        .boundary_x = sim->boundary.at.x,
                        .bodies = sim->bodies,
                        .constraints = sim->constraints,
                        .samples = sim->objective.samples ? sim->objective.samples->count : 0};
}

static pdyn_body_info get_body(const pdyn_sim *sim, int body) {
    if (!sim || body < 0 || body >= sim->bodies) return (pdyn_body_info){0};
    const pdyn_body *b = &sim->body[body];
    return (pdyn_body_info){.name = b->name,
                            .first = b->first,
                            .count = b->count,
                            .live = live_particles_count(sim, body),
                            .radius = b->radius,
                            .rest_density = b->rest_density,
                            .triangles = b->triangles,
                            .triangle = b->triangle,
                            .residual = sim->objective.body[body].residual,
                            .rest = b->rest,
                            .edges = b->edges,
                            .edge = b->edge,
                            .tets = b->tets,
                            .tet = b->tet};
}

static pdyn_constraint_info get_constraint(const pdyn_sim *sim, int constraint) {
    if (!sim_has_constraint(sim, constraint)) return (pdyn_constraint_info){0};
    const struct batch *b = sim->objective.batch[constraint];
    return (pdyn_constraint_info){b->type->name, b->view.body->name, b->view.elements, b->energy};
}

/* Whether a parameter has a value that is a number, or 0 for false and 1 for true. A number outside
 * of its bounds means: none (param_has_default). */
static bool find_value(const pdyn_param *p, const void *field, double *value) {
    if (p->kind == PDYN_BOOL) *value = *(const bool *)field;
    else if (p->kind == PDYN_REAL) *value = *(const double *)field;
    return p->kind == PDYN_BOOL || (p->kind == PDYN_REAL && *value >= p->min && *value <= p->max);
}

static pdyn_parameter_info get_parameter(const pdyn_sim *sim, int constraint, int parameter) {
    if (!sim_has_constraint(sim, constraint)) return (pdyn_parameter_info){0};
    const struct batch *b = sim->objective.batch[constraint];
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        bool is_switch = p->kind == PDYN_BOOL;
        double value = 0.0;
        if (find_value(p, (const char *)b->params + p->offset, &value) && parameter-- == 0)
            return (pdyn_parameter_info){.name = p->name,
                                         .unit = is_switch ? "1" : p->unit,
                                         .value = value,
                                         .minimum = is_switch ? 0.0 : p->min,
                                         .maximum = is_switch ? 1.0 : p->max,
                                         .changeable = param_is_changeable(b->type, p),
                                         .doc = p->doc};
    }
    return (pdyn_parameter_info){0};
}

static bool is_vector(const pdyn_param *p) {
    return p->kind == PDYN_VECTOR || p->kind == PDYN_PATH || param_is_table(p);
}

static pdyn_vector_info get_vector(const pdyn_sim *sim, int constraint, int vector) {
    if (!sim_has_constraint(sim, constraint)) return (pdyn_vector_info){0};
    const struct batch *b = sim->objective.batch[constraint];
    const pdyn_param *p = b->type->params;
    while (p->name && (!is_vector(p) || vector-- != 0)) p++;
    if (!p->name) return (pdyn_vector_info){0};
    const void *field = (const char *)b->params + p->offset;
    pdyn_vector_info info = {.name = p->name,
                             .unit = p->unit,
                             .count = 3,
                             .value = field,
                             .changeable = param_is_changeable(b->type, p),
                             .doc = p->doc};
    const pdyn_path *path = p->kind == PDYN_PATH ? field : NULL;
    const pdyn_table *table = param_is_table(p) ? field : NULL;
    if (path) info.count = 4 * path->count, info.value = path->key;
    if (table) info.width = param_width(p);
    if (table) info.count = info.width * table->count, info.value = table->value;
    return info;
}

static pdyn_warning get_warning(const pdyn_sim *sim, int warning) {
    if (!sim || warning < 0 || warning >= sim->warnings.count) return (pdyn_warning){0};
    const struct warning *w = &sim->warnings.item[warning];
    return (pdyn_warning){.code = warning_name(w->code),
                          .subject = w->subject,
                          .text = w->text,
                          .count = w->count,
                          .first = w->first,
                          .last = w->last};
}

/* ---- the same, of the size that the caller knows (projdyn.h) --------------------------------- */

void pdyn_get_state_sized(const pdyn_sim *sim, pdyn_state *out, size_t size) {
    pdyn_state state = get_state(sim);
    sized_copy(out, size, &state, sizeof state);
}
void pdyn_get_body_sized(const pdyn_sim *sim, int body, pdyn_body_info *out, size_t size) {
    pdyn_body_info info = get_body(sim, body);
    sized_copy(out, size, &info, sizeof info);
}
void pdyn_get_constraint_sized(const pdyn_sim *sim, int constraint, pdyn_constraint_info *out,
                               size_t size) {
    pdyn_constraint_info info = get_constraint(sim, constraint);
    sized_copy(out, size, &info, sizeof info);
}
void pdyn_get_parameter_sized(const pdyn_sim *sim, int constraint, int parameter,
                              pdyn_parameter_info *out, size_t size) {
    pdyn_parameter_info info = get_parameter(sim, constraint, parameter);
    sized_copy(out, size, &info, sizeof info);
}
void pdyn_get_vector_sized(const pdyn_sim *sim, int constraint, int vector, pdyn_vector_info *out,
                           size_t size) {
    pdyn_vector_info info = get_vector(sim, constraint, vector);
    sized_copy(out, size, &info, sizeof info);
}
void pdyn_get_warning_sized(const pdyn_sim *sim, int warning, pdyn_warning *out, size_t size) {
    pdyn_warning found = get_warning(sim, warning);
    sized_copy(out, size, &found, sizeof found);
}

/* ---- hash ------------------------------------------------------------------------------------ */

/* Hashes a vector over the live particles. */
static uint64_t hash_vector(uint64_t hash, const pdyn_sim *sim, const double *vector) {
    size_t one = 3 * sizeof *vector;
    if (!sim->live) return hash_bytes(hash, vector, (size_t)sim->objective.particles * one);
    for (int i = 0; i < sim->objective.particles; i++)
        if (sim->live->live[i]) hash = hash_bytes(hash, vector + 3 * i, one);
    return hash;
}

uint64_t pdyn_state_hash(const pdyn_sim *sim) {
    if (!sim) return 0;
    return hash_vector(hash_vector(HASH_BEGIN, sim, sim->x), sim, sim->v);
}
