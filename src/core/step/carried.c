#include "carried.h"

#include "sim/live_particles.h"
#include "sim/sim.h"

#include "projdyn/kernel.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { GRAIN = 512 }; /* particles per parallel block */

/* ---- memory ---------------------------------------------------------------------------------- */

static bool resize_arrays(struct pdyn_sim *sim, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(sim->carried->x, VECTOR_LENGTH(sim->objective.particles)),
        ARRAY(sim->carried->before, 3 * (size_t)sim->kinematic.points),
    };
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
}

pdyn_status carried_create(struct pdyn_sim *sim) {
    if (!sim->max_step || !sim->kinematic.points) return PDYN_OK;
    sim->carried = NEW_ARRAY(sim->context, 1, struct carried);
    return sim->carried && resize_arrays(sim, ARRAYS_ALLOCATE) ? PDYN_OK : PDYN_NO_MEMORY;
}

void carried_free(struct pdyn_sim *sim) {
    if (!sim->carried) return;
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(sim->context, sim->carried, 1);
}

/* ---- steps ----------------------------------------------------------------------------------- */

const double *carried_x(const struct pdyn_sim *sim) {
    return sim->carried ? sim->carried->x : sim->x;
}

struct call {
    struct pdyn_sim *sim;
    const pdyn_neighbours *lists; /* at the beginning of the step */
    struct surface_kernel kernel;
    int first; /* particle of the body */
};

/* Carries particle i as far as the solid advances along its normal there. Motion and normal are
 * means over its points, by the density that each adds at the particle and by its gradient. */
static void carry(const struct call *c, int i) {
    const pdyn_neighbours *l = c->lists;
    const struct pdyn_sim *sim = c->sim;
    double *x = sim->carried->x + 3 * (size_t)i, weights = 0.0, moved[3] = {0}, normal[3] = {0};
    for (int s = l->patch_start[i]; s < l->end[i]; s++) {
        int point = l->index[s] - l->particles, moving = point - kinematic_first_point(sim);
        if (moving < 0) continue;
        const double *begin = sim->carried->before + 3 * (size_t)moving;
        const double *end = sim->boundary.at.x + 3 * (size_t)point;
        double away[3], motion[3];
        vec3_subtract(away, x, begin);
        vec3_subtract(motion, end, begin);
        double squared = vec3_dot(away, away), weight = surface_kernel_value(&c->kernel, squared);
        weights += weight;
        vec3_add(moved, weight, motion);
        vec3_add(normal, -surface_kernel_slope(&c->kernel, squared), away);
    }
    double along = vec3_dot(moved, normal);
    if (along > 0.0) vec3_add(x, along / (weights * vec3_dot(normal, normal)), normal);
}

static void carry_block(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    (void)block;
    for (int i = c->first + first; i < c->first + last; i++)
        if (!particle_is_pushed(c->sim, i)) carry(c, i);
}

static void carry_all(struct pdyn_sim *sim) {
    const struct kernel_model *kernel = sim->scene.settings.kernel;
    struct call call = {.sim = sim,
                        .lists = neighbours_view(sim->objective.neighbours),
                        .kernel = surface_kernel_make(kernel, sim_spacing(sim))};
    for (int b = 0; b < sim->bodies; b++) {
        call.first = sim->body[b].first;
        if (has_neighbour_lists(sim, b))
            pool_for(sim->context->pool, sim->body[b].count, GRAIN, carry_block, &call);
    }
}

/* The lists are those of the solids where they were: made before these move. */
pdyn_status carried_move(struct pdyn_sim *sim) {
    struct carried *c = sim->carried;
    const double *extended;
    if (!c) return kinematic_move(sim, sim->objective.time), PDYN_OK;
    pdyn_status status = objective_ensure_lists(&sim->objective, sim->x, &extended);
    if (status != PDYN_OK) return status;
    const double *moving = sim->boundary.at.x + 3 * (size_t)kinematic_first_point(sim);
    memcpy(c->before, moving, 3 * (size_t)sim->kinematic.points * sizeof *moving);
    memcpy(c->x, sim->x, objective_bytes(&sim->objective));
    kinematic_move(sim, sim->objective.time);
    carry_all(sim);
    return PDYN_OK;
}
