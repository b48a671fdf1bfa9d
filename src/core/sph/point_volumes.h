/* Volumes of points on a surface. */
#ifndef PDYN_POINT_VOLUMES_H
#define PDYN_POINT_VOLUMES_H

#include "base/context.h"

struct kernel_model;

/* Rest volumes of points on a surface, 1 / sum_k W (Akinci et al. 2012), m^3. x: points x 3, m;
 * support: of W, m. */
pdyn_status point_volumes(pdyn_context *context, int points, const double *x,
                          const struct kernel_model *model, double support, double *volume);

#endif
