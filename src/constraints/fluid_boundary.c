/* The forces of the fluid operator on boundary points. */
#include "fluid_chunk.h"

/* Adds the forces that the constraint of a particle at `at` puts on the listed boundary points
 * first to last - 1. flux: its multiplier, N m; force: (points - particles) x 3, N. */
INLINE void push_points(const struct fluid *f, const v4 *at, int first, int last, double reach,
                        evaluate_fn *evaluate, double flux, double *force) {
    const int *list = f->lists->index + first;
    struct chunk near;
    for (int s = 0; s < last - first; s += CHUNK) {
        int count = chunk_of(last - first, s);
        int inside = evaluate_near(f, at, list + s, count, reach, evaluate, &near);
        for (int k = 0; k < inside; k++) {
            double *to = force + 3 * (size_t)(near.index[k] - f->particles);
            to[0] += flux * near.x[k], to[1] += flux * near.y[k], to[2] += flux * near.z[k];
        }
    }
}

/* The force on boundary point b is multiplier_i V grad W(x_i - x_b): C_i depends on x_i - x_b, so
 * its gradients with respect to x_b and x_i are opposite, to the last bit of the local step. The
 * loop is serial: sums have the same bits for any number of threads. */
WIDE static void push_boundary(const struct fluid *f, double *force) {
    const pdyn_neighbours *l = f->lists;
    for (int i = f->first; i < f->first + f->count; i++) {
        v4 at;
        if (f->multiplier[i] == 0.0) continue;
        v4_set(&at, f->x + 4 * (size_t)i, 0.0);
        push_points(f, &at, l->boundary_start[i], l->patch_start[i], l->support, evaluate_particles,
                    f->multiplier[i], force);
        push_points(f, &at, l->patch_start[i], l->end[i], l->surface_support, evaluate_areas,
                    f->multiplier[i], force);
    }
}

void fluid_boundary_force(void *self, double *force) { push_boundary(self, force); }
