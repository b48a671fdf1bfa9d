#include "point_volumes.h"

#include "geometry/grid.h"

#include "projdyn/kernel.h"
#include "projdyn/vec3.h"

/* Lists the points within the support of point i, itself included. *list grows as needed. */
static pdyn_status list_near(pdyn_context *context, const struct grid *grid,
                             struct grid_cells *cells, const double *x, int i, int **list,
                             size_t *capacity, int *found) {
    const double *at = x + 3 * (size_t)i;
    grid_update_cells(grid, at, cells);
    *found = grid_query(grid, cells, at, grid->cell, -1, *list, (int)*capacity - 1);
    if ((size_t)*found < *capacity) return PDYN_OK;
    int *grown = context_grow(context, *list, capacity, (size_t)*found + 1, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    *list = grown;
    grid_query(grid, cells, at, grid->cell, -1, *list, (int)*capacity - 1);
    return PDYN_OK;
}

pdyn_status point_volumes(pdyn_context *context, int points, const double *x,
                          const struct kernel_model *model, double support, double *volume) {
    struct kernel kernel = kernel_make(model, support);
    struct grid grid;
    struct grid_cells cells = {0};
    pdyn_status status = grid_create(context, points, support, &grid);
    if (status != PDYN_OK) return status;
    size_t capacity = 0;
    int found = 0, *list = context_grow(context, NULL, &capacity, 1, sizeof *list);
    status = list ? grid_sort(&grid, points, NULL, x) : PDYN_NO_MEMORY;
    for (int i = 0; status == PDYN_OK && i < points; i++) {
        status = list_near(context, &grid, &cells, x, i, &list, &capacity, &found);
        double sum = 0.0;
        for (int k = 0; status == PDYN_OK && k < found; k++)
            sum += kernel_value(&kernel, vec3_distance(x + 3 * (size_t)i, x + 3 * (size_t)list[k]));
        volume[i] = 1.0 / sum;
    }
    FREE_ARRAY(context, list, capacity);
    grid_free(context, &grid);
    return status;
}
