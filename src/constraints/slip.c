/* Friction of a fluid on the surfaces in it, by Navier's law of slip (1823): on each wet side, the
 * stress beta v pulls a surface along, v the velocity of the fluid there, along the surface and
 * relative to it, beta the surface's `fluid_friction`, Pa s/m.
 *
 * A spring of stiffness beta A / h along the surface ties u = fluid less sample (pdyn_wet_side, of
 * the area A) to where it is when the step begins: after a step of length h, its force is the force
 * beta A v of implicit Euler. The fluid loses the momentum that the surface gets. */
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { WIDTH = sizeof((pdyn_wet_side){0}.particle) / sizeof(int) };

struct anchor {
    double u[3]; /* m: at the beginning of the step */
};

/* An element for every wet side, in the same order. */
static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    (void)par, (void)x, (void)v, (void)room;
    return b->wet_sides->count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const pdyn_wet_side *side = &b->wet_sides->side[e];
        memcpy(b->column + WIDTH * e, side->particle, sizeof side->particle);
        memcpy(b->coefficient + WIDTH * e, side->coefficient, sizeof side->coefficient);
    }
}

static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        memcpy((struct anchor *)b->data + e, b->u + 3 * e, sizeof(struct anchor));
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = b->wet_sides->side[e].rate / b->h;
}

/* p: the anchor, moved with u across the surface */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const double *anchor = ((const struct anchor *)b->data)[e].u;
        const double *normal = b->wet_sides->side[e].normal;
        double moved[3], *p = b->p + 3 * e;
        for (int a = 0; a < 3; a++) moved[a] = b->u[3 * e + a] - anchor[a];
        memcpy(p, anchor, sizeof moved);
        vec3_add(p, vec3_dot(moved, normal), normal);
    }
}

/* J = n n' */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *n = b->wet_sides->side[e].normal;
        for (int k = 0; k < 9; k++) J[k] = n[k / 3] * n[k % 3];
    }
}

const pdyn_constraint_type pdyn_constraint_slip = {
    .name = "slip",
    .summary = "friction between a fluid and surfaces in it",
    .flags = PDYN_LOSSY,
    .params = (const pdyn_param[]){{0}},
    .data_size = sizeof(struct anchor),
    .update = update,
    .rows = 1,
    .width = WIDTH,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .begin = begin,
};
