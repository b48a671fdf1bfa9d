/* Triangles of cloth, soft bodies and solids at one frame, in a tree of bounding boxes. */
#ifndef MESH_OBSTACLES_H
#define MESH_OBSTACLES_H

#include "vtk_frame.h"

struct obstacle_triangle {
    float corner[3][3]; /* m */
};

struct obstacle_node { /* of triangles first to last - 1; the left child is the next node */
    float min[3], max[3];
    int first, last, right; /* right: index of the right child; 0: a leaf */
};

struct obstacles {
    int count, nodes, capacity;
    struct obstacle_triangle *triangle;
    struct obstacle_node *node; /* 2 x count at most */
};

/* Adds the triangles of a frame. Returns an exit code, after a message unless it is EXIT_GOOD. */
int obstacles_add(struct obstacles *obstacles, const struct vtk_frame *frame);
/* Builds the tree, after the last triangle. Returns an exit code. */
int obstacles_build(struct obstacles *obstacles);
void obstacles_free(struct obstacles *obstacles);

/* The smallest part t, 0 <= t <= 1, of the way from p to q at which a triangle is crossed; 2: none
 * is. triangle: the number of that one; may be NULL */
double obstacles_cross(const struct obstacles *obstacles, const double p[3], const double q[3],
                       int *triangle);
/* The unit normal of a triangle. */
void obstacles_normal(const struct obstacles *obstacles, int triangle, double normal[3]);

#endif
