/* Friction of surfaces and solids by Coulomb's law. Each pair that is in contact when a step begins
 * is tied along the surfaces by a spring, which gives way where its force exceeds the friction
 * coefficient times the normal force. Weight and normal are those of the beginning of the step, the
 * normal force is the mean one of the step before, so that the step minimises one function (lagged
 * friction, Li et al. 2020). The stretch of a spring stays with its pair to the next step, so that
 * a pair that sticks does not creep (Cundall & Strack 1979). */
#include "contact_pair.h"
#include "projdyn/vec3.h"

#include <string.h>

struct spring {
    double normal[3];  /* of the contact, length 1 */
    double axis[2][3]; /* along the surfaces, length 1, and turning with them */
    double anchor[3];  /* m: the shortest vector at which the spring has no force */
    double limit;      /* N: friction coefficient times normal force */
};

static const struct spring *spring_of(const pdyn_batch *b, int e) {
    return (const struct spring *)b->data + e;
}

/* An element for every contact, in the same order. */
static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    (void)par, (void)x, (void)v;
    for (int e = 0; e < b->contacts->count && e < room; e++)
        b->key[e] = b->contacts->contact[e].key;
    return b->contacts->count;
}

/* The anchor is behind the shortest vector by the stretch of the step before, which has turned with
 * the surfaces since. */
static void attach(const pdyn_contact *contact, const double stretch[2], struct spring *spring) {
    for (int a = 0; a < 3; a++) spring->normal[a] = contact->separation[a] / contact->distance;
    memcpy(spring->axis[0], contact->side, sizeof contact->side);
    vec3_add(spring->axis[0], -vec3_dot(contact->side, spring->normal), spring->normal);
    vec3_normalise(spring->axis[0]);
    vec3_cross(spring->axis[1], spring->normal, spring->axis[0]);
    memcpy(spring->anchor, contact->separation, sizeof contact->separation);
    for (int k = 0; k < 2; k++) vec3_add(spring->anchor, -stretch[k], spring->axis[k]);
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        contact_select(b, e);
        attach(&b->contacts->contact[e], (const double *)b->memory + 2 * e,
               (struct spring *)b->data + e);
    }
}

static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        ((struct spring *)b->data)[e].limit = b->contacts->friction * b->contacts->contact[e].force;
}

/* y: the stretch of the spring, along the surface. Returns its length. */
static double stretch_of(const pdyn_batch *b, int e, double y[3]) {
    const struct spring *spring = spring_of(b, e);
    const double *offset = b->contacts->contact[e].offset;
    for (int a = 0; a < 3; a++) y[a] = b->u[3 * e + a] + offset[a] - spring->anchor[a];
    vec3_add(y, -vec3_dot(y, spring->normal), spring->normal);
    return vec3_length(y);
}

/* The part of the force w y that Coulomb's law permits; 1: the pair sticks. */
static double permitted(const pdyn_batch *b, int e, double length) {
    double force = b->weight[e] * length, limit = spring_of(b, e)->limit;
    return force > limit ? limit / force : 1.0;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        double y[3], length = stretch_of(b, e, y);
        memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *y);
        vec3_add(b->p + 3 * e, -permitted(b, e, length), y);
    }
}

/* I - J is the projection onto the surface where the pair sticks; where it slides, that onto the
 * direction across the sliding, times the permitted part. */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *n = spring_of(b, e)->normal;
        double y[3], length = stretch_of(b, e, y), part = permitted(b, e, length);
        double along = part < 1.0 ? part / (length * length) : 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                J[3 * i + j] = (i == j) - part * ((i == j) - n[i] * n[j]) + along * y[i] * y[j];
    }
}

/* w/2 y^2 where the pair sticks, linear in the length of y where it slides (Huber's function) */
static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    double sum = 0.0;
    for (int e = first; e < last; e++) {
        double y[3], length = stretch_of(b, e, y), part = permitted(b, e, length);
        sum += b->weight[e] * length * length * part * (1.0 - 0.5 * part);
    }
    return sum;
}

/* u - p along the axes: the stretch that the spring holds */
static void end(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        double y[3], *stretch = (double *)b->memory + 2 * e;
        vec3_subtract(y, b->u + 3 * e, b->p + 3 * e);
        for (int k = 0; k < 2; k++) stretch[k] = vec3_dot(y, spring_of(b, e)->axis[k]);
    }
}

const pdyn_constraint_type pdyn_constraint_friction = {
    .name = "friction",
    .summary = "keeps surfaces that touch from sliding, up to Coulomb's limit",
    .flags = PDYN_CONTACT | PDYN_ANCHORED,
    .params = (const pdyn_param[]){{0}},
    .data_size = sizeof(struct spring),
    .update = update,
    .rows = 1,
    .width = 4,
    .select = select,
    .begin = begin,
    .weight = contact_weight, /* as stiff across the contact as along it */
    .project = project,
    .tangent = tangent,
    .energy = energy,
    .memory_size = 2 * sizeof(double),
    .end = end,
};
