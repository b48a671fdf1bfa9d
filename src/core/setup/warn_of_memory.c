/* Warnings about memory: more particles than the machine has room for, and boundary points without
 * use. */
#include "base/machine_memory.h"
#include "sim/sim.h"
#include "warn.h"

#include "projdyn/kernel.h"

void warn_of_memory(struct pdyn_sim *sim) {
    double particles = 0.0, machine = machine_memory();
    double particle = sim->scene.settings.kernel->memory;
    for (int b = 0; b < sim->bodies; b++)
        if (body_is_particles(&sim->body[b])) particles += sim->body[b].count;
    if (particles * particle > machine)
        WARN(sim, MEMORY, "",
             "%.0f particles take about %.2g GB, and there are %.2g GB; expected a larger radius",
             particles, particles * particle * 1e-9, machine * 1e-9);
}

/* Solids with so many boundary points, and more than the scene has particles, cost without use. */
static const int max_points = 500000;
/* Bytes of a boundary point with its place in the neighbour lists. */
static const double point_memory = 290.0;

static void check_points(struct pdyn_sim *sim, int solid) {
    int count = 0;
    if (sim->boundary.at.count <= max_points) return;
    for (int k = 0; k < sim->boundary.at.count; k++) count += sim->boundary.point[k].solid == solid;
    if (count <= max_points || count <= sim->objective.particles) return;
    WARN(sim, LARGE, sim->scene.solid[solid].name,
         "its surface has %d boundary points, which take about %.2g GB; expected a solid no larger "
         "than fluid reaches, or larger particles",
         count, count * point_memory * 1e-9);
}

void warn_of_points(struct pdyn_sim *sim) {
    for (int s = 0; s < sim->scene.solids; s++) check_points(sim, s);
}
