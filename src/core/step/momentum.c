#include "momentum.h"

#include "sim/live_particles.h"

void momentum_subtract(const struct pdyn_sim *sim, const double sum[3], double *vector) {
    if (sim->anchored) return;
    double mass = live_mass(sim);
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        if (particle_is_live(sim, k / 3)) vector[k] -= sum[k % 3] / mass;
}

pdyn_status momentum_restore(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    double moved[3] = {0}, energy;
    if (sim->anchored) return PDYN_OK;
    for (int i = 0; i < objective->particles; i++) {
        if (!particle_is_live(sim, i)) continue;
        for (int a = 0; a < 3; a++)
            moved[a] += objective->mass[i] * (sim->x_next[3 * i + a] - objective->s[3 * i + a]);
    }
    momentum_subtract(sim, moved, sim->x_next);
    return objective_local(objective, sim->x_next, &energy, sim->gradient);
}
