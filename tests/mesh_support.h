/* What the tests of meshes and of topology share. */
#ifndef MESH_SUPPORT_H
#define MESH_SUPPORT_H

#include "geometry/mesh.h"

/* Structure that every topology has, whatever the mesh; returns the sum of the vertex areas. */
double check_structure(const struct mesh *mesh, const struct topology *t);

#endif
