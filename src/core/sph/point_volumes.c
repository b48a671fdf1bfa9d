#include "point_volumes.h"

#include "geometry/grid.h"

#include "projdyn/kernel.h"
#include "projdyn/vec3.h"

struct sum { /* of W over the points around `at` */
    struct kernel kernel;
    const double *x, *at;
    double value;
};

static void add(void *user, int k) {
    struct sum *sum = user;
    sum->value += kernel_value(&sum->kernel, vec3_distance(sum->at, sum->x + 3 * (size_t)k));
}

pdyn_status point_volumes(pdyn_context *context, int points, const double *x,
                          const struct kernel_model *model, double support, double *volume) {
    struct grid grid;
    pdyn_status status = grid_create(context, points, support, &grid);
    if (status != PDYN_OK) return status;
    status = grid_sort(&grid, points, NULL, x);
    for (int i = 0; status == PDYN_OK && i < points; i++) {
        struct sum sum = {.kernel = kernel_make(model, support), .x = x, .at = x + 3 * (size_t)i};
        grid_visit(&grid, sum.at, support, add, &sum);
        volume[i] = 1.0 / sum.value;
    }
    grid_free(context, &grid);
    return status;
}
