/* Distance of vertex-face and edge-edge pairs, and collision-free paths. */
#include "distance.h"

#include "projdyn/closest3.h"

static double squared_length(pair_points x, const double c[4]) {
    double u[3] = {0};
    for (int k = 0; k < 4; k++) vec3_add(u, c[k], x[k]);
    return vec3_dot(u, u);
}

/* ---- vertex and face ------------------------------------------------------------------------- */

double closest_vertex_face(pair_points x, double c[4]) {
    double w[3], d = closest3_triangle(x[0], x + 1, w);
    c[0] = 1.0, c[1] = -w[0], c[2] = -w[1], c[3] = -w[2];
    return d;
}

/* ---- edges ----------------------------------------------------------------------------------- */

static double set_edges(pair_points x, double s, double t, double c[4]) {
    c[0] = 1.0 - s, c[1] = s, c[2] = t - 1.0, c[3] = -t;
    return squared_length(x, c);
}

/* Nearly parallel edges: one of the closest points is an end of an edge, so the four ends are
 * compared. */
static double closest_parallel(pair_points x, const double *p, const double *q, const double *r,
                               double c[4]) {
    double pp = vec3_dot(p, p), qq = vec3_dot(q, q), pq = vec3_dot(p, q), best = INFINITY;
    double pr = vec3_dot(p, r), qr = vec3_dot(q, r), w[4];
    const double ends[4][2] = {{0.0, closest3_clamped(qr, qq)},
                               {1.0, closest3_clamped(qr + pq, qq)},
                               {closest3_clamped(-pr, pp), 0.0},
                               {closest3_clamped(pq - pr, pp), 1.0}};
    for (int k = 0; k < 4; k++) {
        double d = set_edges(x, ends[k][0], ends[k][1], w);
        if (d >= best) continue;
        best = d;
        for (int m = 0; m < 4; m++) c[m] = w[m];
    }
    return best;
}

/* The closest points are x0 + s p and x2 + t q. If one of s and t is clamped to [0, 1], the other
 * is computed from it (Ericson 2005, section 5.1.9). */
double closest_edge_edge(pair_points x, double c[4]) {
    double p[3], q[3], r[3];
    vec3_subtract(p, x[1], x[0]);
    vec3_subtract(q, x[3], x[2]);
    vec3_subtract(r, x[0], x[2]);
    double pp = vec3_dot(p, p), qq = vec3_dot(q, q), pq = vec3_dot(p, q);
    double pr = vec3_dot(p, r), qr = vec3_dot(q, r), area = pp * qq - pq * pq;
    if (!(area > 1e-8 * pp * qq)) return closest_parallel(x, p, q, r, c);
    double s = closest3_clamped(pq * qr - pr * qq, area), t = pq * s + qr;
    if (t <= 0.0) s = closest3_clamped(-pr, pp), t = 0.0;
    else if (t >= qq) s = closest3_clamped(pq - pr, pp), t = 1.0;
    else t /= qq;
    return set_edges(x, s, t, c);
}

const struct pair_kind pair_vertex_face = {closest_vertex_face, 1};
const struct pair_kind pair_edge_edge = {closest_edge_edge, 2};

/* ---- collision-free paths -------------------------------------------------------------------- */

double pair_closing_bound(const struct pair_kind *kind, pair_points d) {
    double mean[3] = {0}, fastest[2] = {0};
    for (int k = 0; k < 4; k++) vec3_add(mean, 0.25, d[k]);
    for (int k = 0; k < 4; k++)
        fastest[k >= kind->first] = fmax(fastest[k >= kind->first], vec3_distance(d[k], mean));
    return fastest[0] + fastest[1];
}

static double distance_at(const struct pair_kind *kind, pair_points x, pair_points d, double t) {
    double at[4][3], c[4];
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++) at[k][a] = x[k][a] + t * d[k][a];
    return sqrt(kind->closest((pair_points){at[0], at[1], at[2], at[3]}, c));
}

/* After so many steps the path found so far is returned, which is shorter than possible. */
enum { STEPS = 1000 };

double pair_free_path(const struct pair_kind *kind, pair_points x, pair_points d,
                      double min_distance) {
    double closing = pair_closing_bound(kind, d), t = 0.0;
    double step = 0.999 * (distance_at(kind, x, d, 0.0) - min_distance) / closing;
    for (int k = 0; k < STEPS && t < 1.0; k++) {
        double next = t + step < 1.0 ? t + step : 1.0;
        double distance = distance_at(kind, x, d, next);
        if (distance < min_distance) break;
        t = next;
        step = 0.9 * distance / closing;
    }
    return t;
}
