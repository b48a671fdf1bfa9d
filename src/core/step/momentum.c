#include "momentum.h"

#include "contact/contact.h"
#include "sim/live_particles.h"

#include "base/groups.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* Groups of bodies that may pass momentum to each other in this step, by rows or by pairs of
 * contact that come close, even if they do not touch at its end. An operator, as of a fluid, has no
 * rows: it joins all bodies. Returns whether there are several groups. */
static bool find_groups(const struct pdyn_sim *sim, int *group) {
    const struct objective *objective = &sim->objective;
    bool all = false, several = false;
    for (int b = 0; b < objective->batches; b++) all |= objective->batch[b]->op != NULL;
    for (int b = 0; b < objective->bodies; b++)
        for (int k = 0, first = objective->body[b].first; k < objective->body[b].count; k++)
            group[first + k] = all ? 0 : first;
    for (int b = 0; b < objective->batches && !all; b++)
        batch_join_bodies(objective->batch[b], group);
    if (objective->contact && !all) contact_join(objective->contact, group);
    for (int b = 0; b < objective->bodies; b++)
        several |= groups_first(group, objective->body[b].first) != 0;
    return several;
}

/* Subtracts from a vector the sum of `excess` in each group over its mass, at most `longest`. */
static void subtract_means(struct pdyn_sim *sim, const double *excess, double longest,
                           double *vector) {
    const struct objective *objective = &sim->objective;
    double *mean = sim->direction, *mass = sim->rhs; /* at the first particle of each group */
    int *group = sim->momentum_group;
    memset(mean, 0, objective_bytes(objective));
    memset(mass, 0, (size_t)objective->particles * sizeof *mass);
    for (int i = 0; i < objective->particles; i++) {
        if (!particle_is_live(sim, i)) continue;
        int first = groups_first(group, i);
        vec3_add(mean + 3 * (size_t)first, 1.0, excess + 3 * (size_t)i);
        mass[first] += objective->mass[i];
    }
    for (int i = 0; i < objective->particles; i++) {
        double *of = mean + 3 * (size_t)i;
        for (int a = 0; a < 3 && mass[i] > 0.0; a++) of[a] /= mass[i];
        double length = vec3_length(of);
        for (int a = 0; a < 3 && length > longest; a++) of[a] *= longest / length;
    }
    for (int i = 0; i < objective->particles; i++)
        if (particle_is_live(sim, i))
            vec3_add(vector + 3 * (size_t)i, -1.0, mean + 3 * (size_t)groups_first(group, i));
}

void momentum_subtract(struct pdyn_sim *sim, const double *excess, double *v) {
    if (!sim->anchored) subtract_means(sim, excess, INFINITY, v);
}

pdyn_status momentum_restore(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    double *moved = sim->trial, energy;
    if (sim->anchored) return PDYN_OK;
    for (int k = 0; k < 3 * objective->particles; k++)
        moved[k] = objective->mass[k / 3] * (sim->x_next[k] - objective->s[k]);
    bool checked = find_groups(sim, sim->momentum_group) && objective->contact;
    double free = 0.25 * sim->scene.contact.thickness;
    subtract_means(sim, moved, checked ? free : INFINITY, sim->x_next);
    return objective_local(objective, sim->x_next, &energy, sim->gradient);
}
