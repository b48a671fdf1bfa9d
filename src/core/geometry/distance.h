/* Distance between a vertex and a face, and between two edges; and how far these may move along
 * straight lines before they touch. A pair is four points: the vertex and the three corners of the
 * face, or the two ends of each edge. */
#ifndef PDYN_DISTANCE_H
#define PDYN_DISTANCE_H

typedef const double *const pair_points[4];

/* Computes weights c such that sum c_k x_k is the shortest vector from the second primitive to the
 * first; the weights of the first primitive sum to 1, those of the second to -1. Returns the
 * squared length of that vector, m^2. Degenerate triangles and edges are treated as points and line
 * segments. */
typedef double closest_fn(pair_points x, double c[4]);
closest_fn closest_vertex_face, closest_edge_edge;

struct pair_kind {
    closest_fn *closest;
    int first; /* number of points of the first primitive: 1 or 2 */
};
extern const struct pair_kind pair_vertex_face, pair_edge_edge;

/* A fraction t <= 1 of the displacements d that the points may move, all at the same time and
 * straight, without contact: on the way the distance never vanishes, and at the end it is at least
 * `min_distance`, m, which must be below the distance at the start. Additive continuous collision
 * detection (Li, Kaufman, Jiang 2021, algorithm 1): the fraction is never too large. */
double pair_free_path(const struct pair_kind *kind, pair_points x, pair_points d,
                      double min_distance);

/* An upper bound, m, of the decrease of the distance when the points move by d. */
double pair_closing_bound(const struct pair_kind *kind, pair_points d);

#endif
