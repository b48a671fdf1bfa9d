#include "layer_neighbours.h"

#include "live_particles.h"

#include "projdyn/vec3.h"

#include <math.h>

static void find_cell(const struct layer_neighbours *near, const double *x, int64_t cell[3]) {
    for (int a = 0; a < 3; a++) cell[a] = (int64_t)floor(x[a] / near->cell);
}

static int *bucket_of(const struct pdyn_sim *sim, const int64_t cell[3]) {
    uint64_t hash = (uint64_t)cell[0] * 73856093u ^ (uint64_t)cell[1] * 19349663u ^
                    (uint64_t)cell[2] * 83492791u;
    return &sim->live->near.bucket[hash % (uint64_t)sim->objective.particles];
}

static void put_into_bucket(struct pdyn_sim *sim, int i) {
    int64_t cell[3];
    find_cell(&sim->live->near, sim->x + 3 * (size_t)i, cell);
    int *bucket = bucket_of(sim, cell);
    sim->live->near.next[i] = *bucket, *bucket = i;
}

void layer_neighbours_sort(struct pdyn_sim *sim, const double origin[3], const double normal[3],
                           double reach, double cell) {
    double plane = vec3_dot(origin, normal);
    sim->live->near.cell = cell;
    for (int k = 0; k < sim->objective.particles; k++) sim->live->near.bucket[k] = -1;
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (!body_is_particles(body)) continue;
        for (int i = body->first; i < body->first + body->count; i++)
            if (sim->live->live[i] &&
                fabs(vec3_dot(sim->x + 3 * (size_t)i, normal) - plane) < reach)
                put_into_bucket(sim, i);
    }
}

/* Other cells may have the same bucket. */
static bool is_in_cell(const struct pdyn_sim *sim, int i, const int64_t cell[3]) {
    int64_t own[3];
    find_cell(&sim->live->near, sim->x + 3 * (size_t)i, own);
    return own[0] == cell[0] && own[1] == cell[1] && own[2] == cell[2];
}

int layer_neighbours_find(struct pdyn_sim *sim, const double x[3], double radius) {
    int64_t at[3];
    int count = 0;
    find_cell(&sim->live->near, x, at);
    for (int n = 0; n < 27; n++) {
        const int64_t cell[3] = {at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1};
        for (int i = *bucket_of(sim, cell); i >= 0; i = sim->live->near.next[i])
            if (vec3_distance(x, sim->x + 3 * (size_t)i) < radius && is_in_cell(sim, i, cell))
                sim->live->scratch[count++] = i;
    }
    return count;
}
