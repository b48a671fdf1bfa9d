/* Rigid bodies in the vectors of the system. Four points of mass m/4 stand for a body of mass m:
 * they have its mass, centre and inertia tensor (an equimomental system). In the system they follow
 * the vertices, which they carry and which have no mass. A displacement u of a body is
 *
 *     u_i = t + w x r_i,     r_i = x_i - c,     c: centre,     i: vertices and points
 *
 * so vertices are no unknowns: rows and samples select them like other particles, u is extended to
 * them, and forces f on them act on the points with the same sum and the same moment. */
#ifndef PDYN_RIGID_MAP_H
#define PDYN_RIGID_MAP_H

#include "base/context.h"
#include "scene/scene.h"

enum { RIGID_GRAIN = 8 }; /* bodies of a parallel block */
enum { RIGID_SIZE = 6 };  /* numbers of a motion: t, w; of a force: its sum and moment */

struct rigid_body {
    int first, vertices;           /* particles of the system: the vertices, then the four points */
    double mass;                   /* kg */
    double centre[3];              /* m: of the rest shape */
    double inertia[9];             /* kg m^2: of the rest shape about its centre */
    const double *rest;            /* (vertices + 4) x 3, m */
    double frame[RIGID_POINTS][3]; /* 1/m: an affine map of the rest shape has the matrix
                                      sum over points of x_a frame_a' */
    double *arm;                   /* (vertices + 4) x 3, m: r at the last update */
    double inverse[9];  /* 1/m^2: of sum over points of |r|^2 I - r r', at the last update */
    double momentum[3]; /* kg m^2/s: angular momentum of the base of the step (rigid_bodies.h) */
    bool bent;          /* was not rigid at the last retraction */
};

/* Particles of the system that the body has: its vertices, then its points. */
static inline int rigid_body_particles(const struct rigid_body *body) {
    return body->vertices + RIGID_POINTS;
}
/* The index behind the last of these. */
static inline int rigid_body_end(const struct rigid_body *body) {
    return body->first + rigid_body_particles(body);
}

struct rigid_map {
    pdyn_context *context;
    int particles; /* of the system */
    int bodies;
    struct rigid_body *body; /* bodies */
    double *input;           /* particles x 3: an extended vector */
    double *effective_mass;  /* particles, kg: of a vertex, the mass that a force there accelerates,
                                in the mean over its directions; 0 of other particles */
    int *owner;              /* particles: the body; -1: none */
};

/* rest: particles x 3, m. Bodies have `first`, `vertices` and `mass`; the rest of them is computed.
 */
pdyn_status rigid_map_create(struct rigid_map *map, const double *rest);
void rigid_map_free(struct rigid_map *map); /* NULL: nothing */

/* Moves every body to the rigid pose with the same centre and the rotation closest to the affine
 * map of its points. Positions that are rigid already stay: returns whether some are not. x:
 * particles x 3, m. */
bool rigid_map_retract(const struct rigid_map *map, double *x);

/* The functions below refer to the positions x of the last update. */
void rigid_map_update(struct rigid_map *map, const double *x);

/* Makes u (particles x 3) rigid, as the points move in the mean. */
void rigid_map_extend(const struct rigid_map *map, double *u);
/* The same for a copy of u, which is returned: valid until the next call. It has the particles from
 * first to before last, which contain the bodies. */
const double *rigid_map_extended(struct rigid_map *map, int first, int last, const double *u);

/* Replaces the forces y (particles x 3) on a body by forces on its points. */
void rigid_map_pull(const struct rigid_map *map, double *y);

/* The vertices' blocks become I times inertia x mass. */
void rigid_map_close_blocks(const struct rigid_map *map, double inertia, double *blocks);

/* ---- one body -------------------------------------------------------------------------------- */

/* Sum and moment of f over the body's particles from number `begin` of the body on. */
void rigid_body_sum(const struct rigid_body *body, int begin, const double *f,
                    double sum[RIGID_SIZE]);
/* u_i = t + w x r_i for these particles. */
void rigid_body_move(const struct rigid_body *body, int begin, const double motion[RIGID_SIZE],
                     double *u);
/* n . (the acceleration of its particle i, by a unit force along n on its particle j) at the last
 * update, 1/kg; i, j: particles of the system. */
double rigid_body_mobility(const struct rigid_body *body, int i, int j, const double *n);
/* The centre of the points at x, m; x is that of the system. */
void rigid_body_centre(const struct rigid_body *body, const double *x, double c[3]);
/* The matrix of the affine map of the rest shape to the points at x, row by row: the rotation where
 * x is rigid. */
void rigid_body_matrix(const struct rigid_body *body, const double *x, double A[9]);
/* The weights w of the body's points for which sum of w_k x_k is its point at centre + arm. */
void rigid_body_weights(const struct rigid_body *body, const double *x, const double arm[3],
                        double w[RIGID_POINTS]);
/* R: the rotation closest to A, both row by row. */
void rigid_closest_rotation(const double A[9], double R[9]);
/* Sets x of the body to the pose with centre c and rotation R. */
void rigid_body_place(const struct rigid_body *body, const double c[3], const double R[9],
                      double *x);
/* v = velocity + w x (x - c) for the body's particles */
void rigid_body_set_motion(const struct rigid_body *body, const double *x, const double c[3],
                           const double velocity[3], const double w[3], double *v);
/* Sum and moment about c of the forces y on the body's particles from `begin` on, at x. */
void rigid_body_moment(const struct rigid_body *body, int begin, const double *x, const double c[3],
                       const double *y, double force[3], double moment[3]);
/* I += mass (|r|^2 I - r r'), kg m^2, r in m */
void rigid_add_inertia(double I[9], double mass, const double *r);
/* The inertia tensor of the points at x about their centre c, kg m^2. */
void rigid_body_inertia(const struct rigid_body *body, const double *x, const double c[3],
                        double I[9]);

#endif
