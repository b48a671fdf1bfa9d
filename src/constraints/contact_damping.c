/* Damping of rigid bodies on their contacts (docs/theory/contact.md#damping): a dashpot between two
 * points of bodies resists the change of u, one point minus the other, along a normal n,
 *
 *     E = c / (2 h) y^2,    y = n . (a - u) > -l,
 *     E = c / (2 h) (-2 l y - l^2),  y <= -l,    l = h F / c,
 *
 * y: the approach in the step; a: u at the base of the step. A dashpot that pulls does so with at
 * most the force F, which is its share of the contacts' force: it never holds bodies together. */
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { WIDTH = sizeof((pdyn_dashpot){0}.particle) / sizeof(int) };

struct base {
    double at; /* m: n . a, less the motion of a solid in the step */
};

static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    (void)par, (void)x, (void)v, (void)room;
    return b->contacts->dashpots;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const pdyn_dashpot *d = &b->contacts->dashpot[e];
        memcpy(b->column + WIDTH * e, d->particle, sizeof d->particle);
        memcpy(b->coefficient + WIDTH * e, d->coefficient, sizeof d->coefficient);
    }
}

static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const pdyn_dashpot *d = &b->contacts->dashpot[e];
        ((struct base *)b->data)[e].at =
            vec3_dot(d->normal, b->u + 3 * e) - b->h / b->length * d->shift;
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = b->contacts->dashpot[e].damping / b->h;
}

/* y, m; *least: -l */
static double approach(const pdyn_batch *b, int e, double *least) {
    const pdyn_dashpot *d = &b->contacts->dashpot[e];
    *least = d->damping > 0.0 ? -b->h * d->limit / d->damping : 0.0;
    return ((const struct base *)b->data)[e].at - vec3_dot(d->normal, b->u + 3 * e);
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        double least, y = approach(b, e, &least);
        memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *b->u);
        vec3_add(b->p + 3 * e, y > least ? y : least, b->contacts->dashpot[e].normal);
    }
}

/* I - J = n n'; 0 where the force is at its limit */
static void tangent_rank1(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4) {
        double least;
        bool limited = approach(b, e, &least) <= least;
        for (int a = 0; a < 3; a++) axis[a] = limited ? 0.0 : b->contacts->dashpot[e].normal[a];
        axis[3] = 1.0;
    }
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    double sum = 0.0;
    for (int e = first; e < last; e++) {
        double least, y = approach(b, e, &least), l = y > least ? y : least;
        sum += b->weight[e] * l * (y - 0.5 * l);
    }
    return sum;
}

const pdyn_constraint_type pdyn_constraint_contact_damping = {
    .name = "contact_damping",
    .summary = "damps the oscillation of rigid bodies on their contacts",
    .flags = PDYN_CONTACT | PDYN_ANCHORED | PDYN_LOSSY,
    .params = (const pdyn_param[]){{0}},
    .data_size = sizeof(struct base),
    .update = update,
    .rows = 1,
    .width = WIDTH,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent_rank1 = tangent_rank1,
    .energy = energy,
    .begin = begin,
};
