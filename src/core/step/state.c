/* Public functions that read the state of a simulation. */
#include "base/snapshot_file.h"
#include "live_particles.h"

double pdyn_time(const pdyn_sim *sim) { return sim ? sim->time : 0.0; }
double pdyn_duration(const pdyn_sim *sim) { return sim ? sim->scene.settings.duration : 0.0; }
double pdyn_frame_interval(const pdyn_sim *sim) {
    return sim ? sim->scene.settings.frame_interval : 0.0;
}
const char *pdyn_solver_type(const pdyn_sim *sim) {
    return sim ? sim->choice.slot[0].solver->name : "";
}
const char *pdyn_solver_reason(const pdyn_sim *sim) { return sim ? sim->choice.reason : ""; }
const char *pdyn_integrator(const pdyn_sim *sim) {
    return sim ? sim->scene.settings.integrator->name : "";
}
const char *pdyn_step_type(const pdyn_sim *sim) {
    return !sim ? "" : sim->scene.settings.newton ? "newton" : "projective";
}

void pdyn_observe(pdyn_sim *sim, void (*observer)(void *user, const pdyn_iteration *), void *user) {
    if (!sim) return;
    sim->observer = observer;
    sim->observer_user = user;
}

pdyn_state pdyn_get_state(const pdyn_sim *sim) {
    if (!sim) return (pdyn_state){0};
    return (pdyn_state){.particles = sim->objective.particles,
                        .x = sim->x,
                        .v = sim->v,
                        .mass = sim->objective.mass,
                        .density = sim->density,
                        .pressure = sim->pressure,
                        .live = sim->live ? sim->live->live : NULL,
                        .boundary = sim->boundary.at.count,
                        .moving = sim->motion.points,
                        .boundary_x = sim->boundary.at.x,
                        .bodies = sim->bodies,
                        .constraints = sim->constraints};
}

pdyn_body_info pdyn_get_body(const pdyn_sim *sim, int body) {
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
                            .residual = sim->objective.body[body].residual};
}

pdyn_constraint_info pdyn_get_constraint(const pdyn_sim *sim, int constraint) {
    if (!sim || constraint < 0 || constraint >= sim->constraints) return (pdyn_constraint_info){0};
    const struct batch *b = sim->objective.batch[constraint];
    return (pdyn_constraint_info){b->type->name, b->view.body->name, b->view.elements, b->energy};
}

/* A value outside of its bounds means: none (params_has_default). */
static bool has_value(const pdyn_param *p, const double *value) {
    return p->kind == PDYN_REAL && *value >= p->min && *value <= p->max;
}

pdyn_parameter_info pdyn_get_parameter(const pdyn_sim *sim, int constraint, int parameter) {
    if (!sim || constraint < 0 || constraint >= sim->constraints) return (pdyn_parameter_info){0};
    const struct batch *b = sim->objective.batch[constraint];
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        const double *value = (const double *)((const char *)b->params + p->offset);
        if (has_value(p, value) && parameter-- == 0)
            return (pdyn_parameter_info){p->name, p->unit, *value};
    }
    return (pdyn_parameter_info){0};
}

pdyn_warning pdyn_get_warning(const pdyn_sim *sim, int warning) {
    if (!sim || warning < 0 || warning >= sim->warnings.count) return (pdyn_warning){0};
    const struct warning *w = &sim->warnings.item[warning];
    return (pdyn_warning){.code = warning_name(w->code),
                          .subject = w->subject,
                          .text = w->text,
                          .count = w->count,
                          .first = w->first,
                          .last = w->last};
}

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
