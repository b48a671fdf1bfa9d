/* The check that nothing intersects where contact begins: at the start of a scene, and where a
 * program places a body. Paths without collision need a state without intersections. */
#include "contact_parts.h"

#include "projdyn/vec3.h"

#include <string.h>

/* The side of the plane through a, b, c on which d is: -1 or 1, or 0 within rounding errors. */
static int side(const double *a, const double *b, const double *c, const double *d) {
    double ab[3], ac[3], ad[3], normal[3];
    vec3_subtract(ab, b, a), vec3_subtract(ac, c, a), vec3_subtract(ad, d, a);
    vec3_cross(normal, ab, ac);
    double volume = vec3_dot(normal, ad);
    double rounding = 1e-12 * vec3_length(ab) * vec3_length(ac) * vec3_length(ad);
    return volume > rounding ? 1 : volume < -rounding ? -1 : 0;
}

/* Whether the edge p q passes through the face a b c or its border: p and q lie on opposite sides
 * of its plane, and the line p q has no opposite orientations to two sides of the face. The border
 * belongs to the face, because an edge may cross a diagonal of a flat side, which is in no pair. */
static bool passes(const double *p, const double *q, const double *a, const double *b,
                   const double *c) {
    if (side(a, b, c, p) * side(a, b, c, q) >= 0) return false;
    int one = side(p, q, a, b), two = side(p, q, b, c), three = side(p, q, c, a);
    return (one >= 0 && two >= 0 && three >= 0) || (one <= 0 && two <= 0 && three <= 0);
}

struct crossing { /* an edge and the face that it passes through */
    const struct contact *contact;
    int edge, base, face; /* face: -1 for none */
};

static void try_face(void *user, int id) {
    struct crossing *s = user;
    const struct contact *c = s->contact;
    const int *e = c->edge + 2 * s->edge, *f = c->face + 3 * (s->base + id);
    for (int k = 0; k < 6; k++)
        if (e[k / 3] == f[k % 3]) return;
    if (s->face >= 0) return;
    const double *x = c->at;
    if (passes(x + 3 * e[0], x + 3 * e[1], x + 3 * f[0], x + 3 * f[1], x + 3 * f[2]))
        s->face = s->base + id;
}

/* The number of a triangle that has these corners, counted from the first one of its group. */
static int triangle_number(const struct contact *c, const int *corner, int corners) {
    int number = 0;
    for (int f = 0; f < c->faces; f++) {
        const int *face = c->face + 3 * f;
        int common = 0;
        if (c->group[face[0]] != c->group[corner[0]]) continue;
        for (int k = 0; k < 3; k++)
            for (int m = 0; m < corners; m++) common += face[k] == corner[m];
        if (common == corners) return number;
        number++;
    }
    return -1;
}

/* The point where the line p q meets the plane of the face a b c. */
static void find_crossing(const double *p, const double *q, const double *a, const double *b,
                          const double *c, double x[3]) {
    double ap[3], pq[3], normal[3];
    vec3_normal(normal, a, b, c);
    vec3_subtract(ap, p, a), vec3_subtract(pq, q, p);
    memcpy(x, p, 3 * sizeof *x);
    vec3_add(x, -vec3_dot(normal, ap) / vec3_dot(normal, pq), pq);
}

/* Length of the longest side of the box around a group, m. */
static double extent_of_group(const struct contact *c, int group) {
    struct box box = box_empty;
    for (int i = 0; i < c->points; i++)
        if (c->group[i] == group) box_add(&box, c->at + 3 * (size_t)i);
    return box_extent(&box);
}

/* The message has the sizes because a mesh in millimetres intersects everything. */
static pdyn_status fail_intersecting(const struct contact *c, int e, int f) {
    const int *edge = c->edge + 2 * e, *face = c->face + 3 * f;
    const double *at = c->at;
    int one = c->group[edge[0]], other = c->group[face[0]];
    double x[3];
    find_crossing(at + 3 * edge[0], at + 3 * edge[1], at + 3 * face[0], at + 3 * face[1],
                  at + 3 * face[2], x);
    return set_error(
        PDYN_BAD_INPUT,
        "triangle %d of \"%s\" and triangle %d of \"%s\" intersect, near "
        "(%.3g, %.3g, %.3g) m; the meshes are %.3g m and %.3g m long: leave a gap between them",
        triangle_number(c, edge, 2), c->name[one], triangle_number(c, face, 3), c->name[other],
        x[0], x[1], x[2], extent_of_group(c, one), extent_of_group(c, other));
}

static pdyn_status check_intersections(const struct contact *c) {
    for (int e = 0; e < c->edges; e++) {
        struct crossing s = {.contact = c, .edge = e, .face = -1};
        struct box box;
        contact_wrap_regions(c, c->edge + 2 * e, 2, &box);
        bvh_visit_others(&c->broad.face_tree[0], &box, c->group[c->edge[2 * e]], try_face, &s);
        s.base = c->free_faces;
        if (e < c->free_edges) bvh_visit(&c->broad.face_tree[1], &box, try_face, &s);
        if (s.face >= 0) return fail_intersecting(c, e, s.face);
    }
    return PDYN_OK;
}

static bool has_particle(const pdyn_contact *contact, int first, int count) {
    for (int k = 0; k < 4; k++) {
        int i = contact->particle[k];
        if (contact->coefficient[k] != 0.0 && i >= first && i - first < count) return true;
    }
    return false;
}

static pdyn_status check_distances(const struct contact *c, int first, int count) {
    for (int e = 0; e < c->current.view.count; e++) {
        const int *point = c->current.stencil[e].point;
        const pdyn_contact *contact = &c->current.contact[e];
        const double *at = c->at + 3 * (size_t)point[0];
        double distance = contact->distance, least = CONTACT_GAP * contact->thickness;
        if (distance >= least || !has_particle(contact, first, count)) continue;
        return set_error(
            PDYN_BAD_INPUT,
            "\"%s\" and \"%s\" are %.3g m apart at (%g, %g, %g), "
            "expected at least a sixteenth of the thickness, %.3g m: leave a gap between them",
            c->name[c->group[point[0]]], c->name[c->group[point[3]]], distance, at[0], at[1], at[2],
            least);
    }
    return PDYN_OK;
}

pdyn_status contact_check(struct contact *c, int first, int count) {
    pdyn_status status = check_intersections(c);
    return status == PDYN_OK ? check_distances(c, first, count) : status;
}

struct contact_gap contact_smallest_gap(const struct contact *c,
                                        bool (*counts)(const void *user, const pdyn_contact *),
                                        const void *user) {
    struct contact_gap least = {.distance = 1.0, .thickness = 1.0};
    for (int e = 0; e < c->current.view.count; e++) {
        const int *point = c->current.stencil[e].point;
        const pdyn_contact *contact = &c->current.contact[e];
        int one = c->group[point[0]], other = c->group[point[3]];
        if (one == other || is_particle(c, point[0])) continue;
        if (contact->distance * least.thickness >= least.distance * contact->thickness) continue;
        if (!counts(user, contact)) continue;
        least = (struct contact_gap){.name = {c->name[one], c->name[other]},
                                     .distance = contact->distance,
                                     .thickness = contact->thickness};
        memcpy(least.x, c->at + 3 * (size_t)point[0], sizeof least.x);
    }
    return least;
}
