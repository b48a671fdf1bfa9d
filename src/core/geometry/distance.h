/* Closest points of a vertex and a face, and of two edges; and how far these may move along
 * straight lines before they meet. A pair is four points: the vertex and the three corners, or the
 * two ends of each edge. */
#ifndef PDYN_DISTANCE_H
#define PDYN_DISTANCE_H

typedef const double *const pair_points[4];

/* Weights c so that sum c_k x_k is the shortest vector from the second primitive to the first (the
 * first one's weights sum to 1, the second one's to -1). Returns its squared length. Triangles and
 * edges of no extent are points and lines. */
typedef double closest_fn(pair_points x, double c[4]);
closest_fn closest_vertex_face, closest_edge_edge;

struct pair_kind {
    closest_fn *closest;
    int first; /* points of the first primitive: 1 or 2 */
};
extern const struct pair_kind pair_vertex_face, pair_edge_edge;

/* A fraction t of the displacements d of the points, at most 1: on the way there, all points at
 * once and straight, the distance never vanishes, and at the end it is at least `keep`, which is
 * below the distance at the start. Additive continuous collision detection (Li, Kaufman, Jiang
 * 2021, algorithm 1): steps that no motion of this speed can exceed, so it is never too long. */
double pair_free_path(const struct pair_kind *kind, pair_points x, pair_points d, double keep);

/* How much closer the two may come when the points move by d. */
double pair_approach(const struct pair_kind *kind, pair_points d);

#endif
