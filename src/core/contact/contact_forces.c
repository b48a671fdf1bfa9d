/* The constraints of contact: what keeps surfaces apart, and what keeps them from sliding. Their
 * elements are made in contact.c and friction.c. */
#include "contact.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- apart ----------------------------------------------------------------------------------- */

static double apart(const pdyn_batch *b, int e, double n[3]) {
    const struct touching *data = (const struct touching *)b->data + e;
    for (int a = 0; a < 3; a++) n[a] = b->u[3 * e + a] + data->offset[a];
    double d = vec3_length(n);
    for (int a = 0; a < 3; a++) n[a] /= d;
    return d;
}

/* With the weight b'', w (u - p) is the force: u - p has the length -b'/b''. */
static void project_touching(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const struct touching *data = (const struct touching *)b->data + e;
        double n[3], d = apart(b, e, n), T = data->thickness;
        double length = 0.5 * d * (T - d) * (T + 2.0 * d) / (T * T + T * d + d * d);
        memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *n);
        vec3_add(b->p + 3 * e, length, n);
    }
}

/* I - J = n n' */
static void axial_touching(const void *par, const pdyn_batch *b, int first, int last,
                           double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4) apart(b, e, axis), axis[3] = 1.0;
}

static double energy_touching(const void *par, const pdyn_batch *b, int first, int last) {
    const struct scene_contact *set = par;
    double sum = 0.0;
    for (int e = first; e < last; e++) {
        double n[3], d = apart(b, e, n), T = ((const struct touching *)b->data + e)->thickness;
        sum += 0.5 * set->stiffness * (T - d) * (T - d) * (T - d) / d;
    }
    return sum;
}

const pdyn_constraint_type contact_touching = {
    .name = "contact",
    .summary = "keeps surfaces and solids apart",
    .flags = PDYN_ANCHORED | PDYN_ONE_SIDED,
    .data_size = sizeof(struct touching),
    .rows = 1,
    .width = 4,
    .project = project_touching,
    .tangent_rank1 = axial_touching,
    .energy = energy_touching,
};

/* ---- sticking -------------------------------------------------------------------------------- */

/* What is stretched along the surfaces since the start of the step, and before: y. */
static double stretch(const pdyn_batch *b, int e, double y[3]) {
    const struct sticking *data = (const struct sticking *)b->data + e;
    for (int a = 0; a < 3; a++) y[a] = b->u[3 * e + a] + data->pair.offset[a] - data->anchor[a];
    vec3_add(y, -vec3_dot(y, data->normal), data->normal);
    return vec3_length(y);
}

/* The part of w y that Coulomb's law lets through. */
static double slipping(const pdyn_batch *b, int e, double length) {
    double force = b->weight[e] * length, limit = ((const struct sticking *)b->data + e)->limit;
    return force > limit ? limit / force : 1.0;
}

static void project_sticking(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        double y[3], length = stretch(b, e, y);
        memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *y);
        vec3_add(b->p + 3 * e, -slipping(b, e, length), y);
    }
}

/* I - J: all along the surface where it sticks; across the direction of sliding where it slides. */
static void tangent_sticking(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *n = ((const struct sticking *)b->data + e)->normal;
        double y[3], length = stretch(b, e, y), part = slipping(b, e, length);
        double along = part < 1.0 ? part / (length * length) : 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                J[3 * i + j] = (i == j) - part * ((i == j) - n[i] * n[j]) + along * y[i] * y[j];
    }
}

/* w/2 y^2 where it sticks, then linear (Huber's function). */
static double energy_sticking(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    double sum = 0.0;
    for (int e = first; e < last; e++) {
        double y[3], length = stretch(b, e, y), part = slipping(b, e, length);
        sum += b->weight[e] * length * length * part * (1.0 - 0.5 * part);
    }
    return sum;
}

const pdyn_constraint_type contact_sticking = {
    .name = "friction",
    .summary = "keeps surfaces that touch from sliding, up to Coulomb's limit",
    .flags = PDYN_ANCHORED,
    .data_size = sizeof(struct sticking),
    .rows = 1,
    .width = 4,
    .project = project_sticking,
    .tangent = tangent_sticking,
    .energy = energy_sticking,
};
