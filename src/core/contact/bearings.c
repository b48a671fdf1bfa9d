#include "bearings.h"

#include "projdyn/barrier.h"
#include "projdyn/svd3.h"

#include <math.h>
#include <string.h>

/* k of the barrier of a contact, N/m */
static double barrier_of(const struct contact *c, const pdyn_contact *contact) {
    return contact->share * c->settings->stiffness;
}

/* ---- bearings -------------------------------------------------------------------------------- */

/* The bearing of two groups, a < b; NULL: there is none. */
static struct bearing *find(const struct bearings *t, int a, int b) {
    for (int k = t->first[a]; k >= 0; k = t->bearing[k].next)
        if (t->bearing[k].group[1] == b) return &t->bearing[k];
    return NULL;
}

/* The same, a new one if there is none. NULL without memory. */
static struct bearing *find_or_add(const struct contact *c, int a, int b) {
    struct bearings *t = c->bearings;
    struct bearing *found = find(t, a, b);
    if (found) return found;
    struct bearing *all =
        context_grow(c->context, t->bearing, &t->room, (size_t)t->count + 1, sizeof *all);
    if (!all) return NULL;
    t->bearing = all;
    all[t->count] = (struct bearing){.group = {a, b}, .next = t->first[a]};
    t->first[a] = t->count;
    return &all[t->count++];
}

/* The points of a contact on the groups of its bearing, m: weighted means of the corners. */
static void points_of(const struct contact *c, const struct bearing *bearing,
                      const struct stencil *s, double point[2][3]) {
    memset(point, 0, 6 * sizeof **point);
    for (int k = 0; k < 4; k++)
        vec3_add(point[c->group[s->point[k]] == bearing->group[1]], fabs(s->c[k]),
                 c->at + 3 * (size_t)s->point[k]);
}

static void add_contact(const struct contact *c, struct bearing *bearing, int e) {
    const pdyn_contact *contact = &c->start.contact[e];
    const struct stencil *s = &c->start.stencil[e];
    double point[2][3], weight = c->bearings->contact[e].stiffness;
    double force = barrier_force(barrier_of(c, contact), contact->thickness, contact->distance);
    double sign = c->group[s->point[0]] == bearing->group[0] ? 1.0 : -1.0;
    points_of(c, bearing, s, point);
    bearing->force += force, bearing->stiffness += weight;
    vec3_add(bearing->normal, sign * force / contact->distance, contact->separation);
    bearing->shift += weight * vec3_dot(contact->separation, contact->shift) / contact->distance;
    for (int side = 0; side < 2; side++) vec3_add(bearing->centre[side], weight, point[side]);
}

static bool is_soft(const struct contact *c, int group) {
    return group < c->bodies && c->bearings->body[group] < 0;
}

/* Gathers the contacts of rigid bodies into bearings. */
static pdyn_status gather(struct contact *c) {
    struct bearings *t = c->bearings;
    t->count = 0;
    for (int k = 0; k < c->groups; k++) t->first[k] = -1;
    for (int e = 0; e < c->start.view.count; e++) {
        const struct stencil *s = &c->start.stencil[e];
        const pdyn_contact *contact = &c->start.contact[e];
        int a = c->group[s->point[0]], b = c->group[s->point[3]];
        struct bearing_contact *own = &t->contact[e];
        *own = (struct bearing_contact){
            -1, barrier_stiffness(barrier_of(c, contact), contact->thickness, contact->distance)};
        if (is_soft(c, a) || is_soft(c, b) || !(own->stiffness > 0.0)) continue;
        struct bearing *bearing = a < b ? find_or_add(c, a, b) : find_or_add(c, b, a);
        if (!bearing) return PDYN_NO_MEMORY;
        own->bearing = (int)(bearing - t->bearing);
        add_contact(c, bearing, e);
    }
    return PDYN_OK;
}

/* r is that of the mean of the contact's two points: neither group is the first. */
static void add_tilt(const struct contact *c, struct bearing *bearing, int e) {
    double point[2][3], r[3], weight = c->bearings->contact[e].stiffness;
    points_of(c, bearing, &c->start.stencil[e], point);
    for (int a = 0; a < 3; a++)
        r[a] = 0.5 * (point[0][a] + point[1][a] - bearing->centre[0][a] - bearing->centre[1][a]);
    vec3_add(r, -vec3_dot(r, bearing->normal), bearing->normal);
    for (int k = 0; k < 9; k++) bearing->tilt[k] += weight * r[k / 3] * r[k % 3];
}

/* Turns sums into means, then adds up the second moments. */
static void complete(struct contact *c) {
    struct bearings *t = c->bearings;
    for (int k = 0; k < t->count; k++) {
        struct bearing *bearing = &t->bearing[k];
        bearing->net = vec3_normalise(bearing->normal);
        bearing->shift /= bearing->stiffness;
        for (int a = 0; a < 6; a++) bearing->centre[a / 3][a % 3] /= bearing->stiffness;
    }
    for (int e = 0; e < c->start.view.count; e++)
        if (t->contact[e].bearing >= 0) add_tilt(c, &t->bearing[t->contact[e].bearing], e);
}

/* ---- dashpots -------------------------------------------------------------------------------- */

struct end {                       /* of a bearing on a rigid body */
    const struct rigid_body *body; /* NULL: a solid */
    double arm[3];                 /* m: from the body's centre to that of the bearing */
};

static struct end end_of(const struct bearings *t, const struct bearing *bearing, int side,
                         const double *x) {
    struct end end = {NULL, {0}};
    int number = t->body[bearing->group[side]];
    if (number < 0) return end;
    double centre[3];
    end.body = &t->map->body[number];
    rigid_body_centre(end.body, x, centre);
    vec3_subtract(end.arm, bearing->centre[side], centre);
    return end;
}

/* The end of a dashpot at centre + point of a body. */
static void set_end(pdyn_dashpot *d, const struct end *end, const double *x, const double point[3],
                    int side) {
    double w[RIGID_POINTS];
    rigid_body_weights(end->body, x, point, w);
    for (int k = 0; k < RIGID_POINTS; k++) {
        d->particle[RIGID_POINTS * side + k] = end->body->first + end->body->vertices + k;
        d->coefficient[RIGID_POINTS * side + k] = side ? -w[k] : w[k];
    }
}

/* A dashpot of a bearing at an offset from its centre, across the normal. Its ends are on the
 * planes through the centres of the bodies: there a turn of a body does not move them along the
 * normal in second order, and the line of the force is the same. */
static pdyn_dashpot dashpot_at(const struct bearing *bearing, const struct end end[2],
                               const double *x, const double offset[3]) {
    pdyn_dashpot d = {.damping = bearing->damping / BEARING_DASHPOTS,
                      .limit = bearing->net / BEARING_DASHPOTS,
                      .shift = bearing->shift};
    memcpy(d.normal, bearing->normal, sizeof d.normal);
    for (int side = 0; side < 2; side++) {
        double point[3];
        for (int k = 0; k < RIGID_POINTS; k++) /* of a solid: a particle with the coefficient 0 */
            d.particle[RIGID_POINTS * side + k] = d.particle[k];
        if (!end[side].body) continue;
        for (int a = 0; a < 3; a++) point[a] = end[side].arm[a] + offset[a];
        vec3_add(point, -vec3_dot(point, d.normal), d.normal);
        set_end(&d, &end[side], x, point, side);
    }
    return d;
}

/* 1/m of a push at the ends of a dashpot, 1/kg, as if the four points that carry a body were free.
 */
static double inverse_mass(const pdyn_dashpot *d, const struct end end[2]) {
    double sum = 0.0;
    for (int k = 0; k < 2 * RIGID_POINTS; k++) {
        const struct rigid_body *body = end[k / RIGID_POINTS].body;
        if (body) sum += RIGID_POINTS * d->coefficient[k] * d->coefficient[k] / body->mass;
    }
    return sum;
}

/* F R, 1/R = sum of 1/R_i over the bodies, R_i: the height of its centre above the bearing. The
 * second moment of a body that rolls contains F R, although rolling changes no force: it is taken
 * off before the tilt is damped. */
static double rolling(const struct bearing *bearing, const struct end end[2]) {
    double curvature = 0.0;
    for (int side = 0; side < 2; side++) {
        double height = (side ? 1.0 : -1.0) * vec3_dot(end[side].arm, bearing->normal);
        if (end[side].body) curvature += height > 0.0 ? 1.0 / height : INFINITY;
    }
    return bearing->force / curvature;
}

/* Four dashpots at the ends of a cross have the stiffness of the bearing against a push along the
 * normal and against two tilts, less what rolling has. Contacts on opposite sides, as in a slot,
 * have little net force, and nothing is damped along their mean normal. */
static void set_dashpots(const struct contact *c, struct bearing *bearing, const double *x,
                         pdyn_dashpot *dashpot) {
    static const double none[3] = {0};
    const struct bearings *t = c->bearings;
    const struct end end[2] = {end_of(t, bearing, 0, x), end_of(t, bearing, 1, x)};
    const svd3 tilt = svd3_of(bearing->tilt);
    const pdyn_dashpot central = dashpot_at(bearing, end, x, none);
    double roll = rolling(bearing, end), part = bearing->net / bearing->force;
    bearing->damping = part * part * 2.0 * c->settings->damping *
                       sqrt(bearing->stiffness / inverse_mass(&central, end));
    for (int k = 0; k < BEARING_DASHPOTS; k++) {
        double rest = fmax(0.0, tilt.s[k / 2] - roll), offset[3] = {0};
        vec3_add(offset, (k % 2 ? -1.0 : 1.0) * sqrt(2.0 * rest / bearing->stiffness),
                 tilt.left[k / 2]);
        dashpot[k] = dashpot_at(bearing, end, x, offset);
    }
}

static pdyn_status reserve_contacts(struct contact *c) {
    struct bearings *t = c->bearings;
    size_t need = (size_t)c->start.view.count;
    struct bearing_contact *all =
        context_grow(c->context, t->contact, &t->contact_room, need, sizeof *all);
    if (!all && need) return PDYN_NO_MEMORY;
    t->contact = all;
    return PDYN_OK;
}

static pdyn_status reserve_dashpots(struct contact *c) {
    struct bearings *t = c->bearings;
    size_t need = BEARING_DASHPOTS * (size_t)t->count;
    pdyn_dashpot *all = context_grow(c->context, t->dashpot, &t->dashpot_room, need, sizeof *all);
    if (!all && need) return PDYN_NO_MEMORY;
    c->start.view.dashpot = t->dashpot = all, c->start.view.dashpots = (int)need;
    return PDYN_OK;
}

pdyn_status bearings_update(struct contact *c, const double *x) {
    struct bearings *t = c->bearings;
    pdyn_status status = reserve_contacts(c);
    if (status == PDYN_OK) status = gather(c);
    if (status == PDYN_OK) status = reserve_dashpots(c);
    if (status != PDYN_OK) return status;
    complete(c);
    for (int k = 0; k < t->count; k++)
        set_dashpots(c, &t->bearing[k], x, t->dashpot + (size_t)BEARING_DASHPOTS * (size_t)k);
    return PDYN_OK;
}

/* The bearing of contact e of the end of the step; NULL: none. */
static struct bearing *bearing_at_end(const struct contact *c, int e) {
    const int *point = c->current.stencil[e].point;
    int a = c->group[point[0]], b = c->group[point[3]];
    return a < b ? find(c->bearings, a, b) : find(c->bearings, b, a);
}

void bearings_add_forces(struct contact *c) {
    struct bearing *bearing;
    for (int e = 0; e < c->current.view.count; e++)
        if ((bearing = bearing_at_end(c, e))) bearing->pressed += c->current.force[e];
    for (int e = 0; e < c->current.view.count; e++)
        if ((bearing = bearing_at_end(c, e)) && bearing->pressed > 0.0)
            c->current.force[e] *= fmax(0.0, 1.0 + bearing->dashpot_force / bearing->pressed);
}

bool contact_has_dashpots(const struct contact *c) { return c->bearings; }

int contact_dashpot_solid(const struct contact *c, int dashpot) {
    int group = c->bearings->bearing[dashpot / BEARING_DASHPOTS].group[1];
    return group < c->bodies ? -1 : group - c->bodies;
}

void contact_add_dashpot_force(struct contact *c, int dashpot, double force) {
    c->bearings->bearing[dashpot / BEARING_DASHPOTS].dashpot_force += force;
}

/* ---- memory ---------------------------------------------------------------------------------- */

pdyn_status bearings_create(struct contact *c, const struct rigid_map *map) {
    if (!map || !(c->settings->damping > 0.0)) return PDYN_OK;
    struct bearings *t = c->bearings = NEW_ARRAY(c->context, 1, struct bearings);
    if (!t) return PDYN_NO_MEMORY;
    t->map = map;
    t->body = NEW_ARRAY(c->context, c->groups, int);
    t->first = NEW_ARRAY(c->context, c->groups, int);
    if (!t->body || !t->first) return PDYN_NO_MEMORY;
    for (int g = 0; g < c->groups; g++) t->body[g] = -1;
    for (int k = 0; k < c->rigids; k++) t->body[c->rigid[k].group] = k;
    return PDYN_OK;
}

void bearings_free(struct contact *c) {
    struct bearings *t = c->bearings;
    if (!t) return;
    FREE_ARRAY(c->context, t->body, c->groups);
    FREE_ARRAY(c->context, t->first, c->groups);
    FREE_ARRAY(c->context, t->bearing, t->room);
    FREE_ARRAY(c->context, t->dashpot, t->dashpot_room);
    FREE_ARRAY(c->context, t->contact, t->contact_room);
    FREE_ARRAY(c->context, c->bearings, 1);
}
