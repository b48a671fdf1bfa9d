/* Checks shared by the tests of meshes and of topology. */
#ifndef MESH_SUPPORT_H
#define MESH_SUPPORT_H

#include "geometry/mesh.h"

/* Checks the structure that every topology has; returns the sum of the vertex areas, m^2. */
double check_structure(const struct mesh *mesh, const struct topology *t);

#endif
