/* Shared by the tests of rigid bodies: a box, its momenta, and its mean motion. */
#ifndef TEST_RIGID_SUPPORT_H
#define TEST_RIGID_SUPPORT_H

#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

/* rigid: keys of the rigid body; keys: others of the body; each with a comma before it, or "" */
#define BOX(rigid, keys)                                                                           \
    "{'name': 'box', 'rigid': {'box': {'minimum': [-0.1, -0.2, -0.3], 'maximum': [0.1, 0.2, "      \
    "0.3]}, 'density': 700" rigid "}" keys "}"

/* A scene with steps of h, s; more: other keys, each with a comma before it, or "" */
#define RIGID_SCENE(h, gravity, more, bodies) RIGID_HEAD(h, gravity, more) bodies "]}"
/* The same up to the list of its bodies. */
#define RIGID_HEAD(h, gravity, more)                                                               \
    "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': " h                         \
    "}, 'gravity': " gravity more ", 'bodies': ["

/* The box, a ball and a cloth hit each other. */
#define COLLISION(contact)                                                                         \
    RIGID_SCENE(                                                                                   \
        "0.002", "[0, 0, 0]",                                                                      \
        ", 'contact': {'thickness': 0.002, 'stiffness': 1e4" contact                               \
        "}, 'solver': {'tolerance': 1e-6, 'outer_iterations': 100}",                               \
        PAIR(PAIR(BOX(", 'rotate': [10, 20, 30], 'angular_velocity': [1, 2, 0]",                   \
                      ", 'velocity': [1, 0, 0]"),                                                  \
                  "{'name': 'ball', 'rigid': {'sphere': {'center': [0.45, 0.1, 0], 'radius': "     \
                  "0.1}, 'mass': 8}}"),                                                            \
             GRID_SHEET("'name': 'cloth', ", "0.4, 0.4", "7, 7",                                   \
                        "'rotate': [0, 0, 90], 'translate': [0.58, 0.1, 0], 'area_density': 1",    \
                        SPRINGS("1000"))))

static const double pi = 3.14159265358979323846;

struct momenta {
    double linear[3], angular[3]; /* kg m/s; kg m^2/s about the origin */
};

static inline struct momenta momenta_of(const pdyn_sim *sim) {
    struct momenta sum = {0};
    for (int i = 0; i < sim->objective.particles; i++) {
        double moment[3];
        vec3_cross(moment, sim->x + 3 * i, sim->v + 3 * i);
        vec3_add(sum.linear, sim->objective.mass[i], sim->v + 3 * i);
        vec3_add(sum.angular, sim->objective.mass[i], moment);
    }
    return sum;
}

/* Mean position or velocity of the vertices of a body. */
static inline void mean_of(const pdyn_sim *sim, int body, const double *value, double mean[3]) {
    memset(mean, 0, 3 * sizeof *mean);
    for (int i = 0; i < sim->body[body].count; i++)
        vec3_add(mean, 1.0 / sim->body[body].count, value + 3 * (sim->body[body].first + i));
}

static inline void steps(pdyn_sim *sim, int count) {
    for (int k = 0; k < count; k++) test_step(sim);
}

#endif
