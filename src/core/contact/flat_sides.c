/* Flat parts of solids and rigid bodies: triangles in one plane, with their common sides, and the
 * points that have such sides all around. Against a plane, the pairs of its faces with the vertices
 * of the other body suffice, so these sides and points take no part in contact; and of the
 * triangles that meet at such a side, or around a point, only the nearest one pairs with a vertex.
 * Otherwise a floor of triangles would have bumps: two pairs push where one does elsewhere. */
#include "contact_parts.h"

#include "projdyn/vec3.h"

#include <stdlib.h>
#include <string.h>

/* Sine of the largest angle between the normals of two triangles in one plane. */
static const double flat_angle = 1e-5;

struct side {      /* of a triangle: opposite its corner */
    int low, high; /* its points */
    int face, corner;
};

static int compare_sides(const void *a, const void *b) { return memcmp(a, b, 2 * sizeof(int)); }

/* Whether a group keeps its shape. */
static bool is_stiff(const struct contact *c, int group) {
    bool rigid = group >= c->bodies;
    for (int k = 0; k < c->rigids; k++) rigid |= c->rigid[k].group == group;
    return rigid;
}

/* Lists the sides of all triangles that keep their shape; their points may be flat. */
static int list_sides(struct contact *c, struct side *side) {
    int count = 0, group = -1;
    bool stiff = false;
    for (int k = 0; k < 3 * c->faces; k++) {
        int corner = k % 3, *face = c->face + (k - corner);
        int a = face[(corner + 1) % 3], b = face[(corner + 2) % 3];
        if (c->group[a] != group) stiff = is_stiff(c, group = c->group[a]);
        c->flat.across[k] = -1;
        if (!stiff) continue;
        side[count++] = (struct side){a < b ? a : b, a < b ? b : a, k / 3, corner};
        c->flat.point[a] = true;
    }
    return count;
}

static int opposite(const struct contact *c, const struct side *s) {
    return c->face[3 * s->face + s->corner];
}

/* From the side to its opposite corner, normal to the side. */
static void height_of(const struct contact *c, const struct side *s, double h[3]) {
    const double *a = c->rest + 3 * (size_t)s->low, *b = c->rest + 3 * (size_t)s->high;
    double along[3];
    vec3_subtract(along, b, a);
    vec3_subtract(h, c->rest + 3 * (size_t)opposite(c, s), a);
    vec3_add(h, -vec3_dot(h, along) / vec3_dot(along, along), along);
}

/* Whether two triangles lie in one plane, on two sides of their common side. */
static bool are_flat(const struct contact *c, const struct side *s) {
    double h[2][3], turned[3];
    for (int k = 0; k < 2; k++) height_of(c, &s[k], h[k]);
    vec3_cross(turned, h[0], h[1]);
    return vec3_dot(h[0], h[1]) < 0.0 &&
           vec3_length(turned) <= flat_angle * vec3_length(h[0]) * vec3_length(h[1]);
}

/* Finds the flat ones in a sorted list, moves them to its front, and returns their number. */
static int keep_flat(struct contact *c, struct side *side, int count) {
    int kept = 0;
    for (int first = 0, last; first < count; first = last) {
        for (last = first + 1; last < count && !compare_sides(&side[first], &side[last]);) last++;
        const struct side s[2] = {side[first], side[first + (last - first == 2)]};
        if (last - first == 2 && are_flat(c, s)) {
            c->flat.across[3 * s[0].face + s[0].corner] = s[1].face;
            c->flat.across[3 * s[1].face + s[1].corner] = s[0].face;
            side[kept++] = s[0];
        } else c->flat.point[s[0].low] = c->flat.point[s[0].high] = false;
    }
    return kept;
}

/* Marks the edges that are flat sides. */
static void mark_edges(struct contact *c, const struct side *side, int count) {
    for (int e = 0; e < c->edges; e++) {
        int a = c->edge[2 * e], b = c->edge[2 * e + 1];
        const struct side key = {a < b ? a : b, a < b ? b : a, 0, 0};
        c->flat.edge[e] = count && bsearch(&key, side, (size_t)count, sizeof *side, compare_sides);
    }
}

/* The first face of the part that a face belongs to so far; halves the way for the next time. */
static int first_face(struct contact *c, int face) {
    int *next = c->flat.part;
    while (next[face] != face) face = next[face] = next[next[face]];
    return face;
}

/* Joins the faces on both sides of each flat side. */
static void join_faces(struct contact *c) {
    for (int f = 0; f < c->faces; f++) c->flat.part[f] = f;
    for (int k = 0; k < 3 * c->faces; k++) {
        if (c->flat.across[k] < 0) continue;
        int a = first_face(c, k / 3), b = first_face(c, c->flat.across[k]);
        c->flat.part[a > b ? a : b] = a < b ? a : b;
    }
    for (int f = 0; f < c->faces; f++) c->flat.part[f] = first_face(c, f);
}

pdyn_status contact_find_flat_sides(struct contact *c) {
    struct side *side = NEW_ARRAY(c->context, 3 * (size_t)c->faces, struct side);
    if (!side && c->faces) return PDYN_NO_MEMORY;
    int count = list_sides(c, side);
    if (count) qsort(side, (size_t)count, sizeof *side, compare_sides);
    mark_edges(c, side, keep_flat(c, side, count));
    join_faces(c);
    FREE_ARRAY(c->context, side, 3 * (size_t)c->faces);
    return PDYN_OK;
}

uint64_t contact_key(const struct contact *c, const struct pair *p) {
    if (pair_kind_of(p->key) != &pair_vertex_face) return p->key;
    int face = pair_second(p);
    return p->key - (uint64_t)face + (uint64_t)c->flat.part[face];
}

void contact_side(const struct contact *c, const struct pair *p, double side[3]) {
    const int *end = p->point;
    int count = 2; /* of two edges */
    if (pair_kind_of(p->key) == &pair_vertex_face)
        end = c->face + 3 * (size_t)c->flat.part[pair_second(p)], count = 1;
    memset(side, 0, 3 * sizeof *side);
    for (int k = 0; k < count; k++, end += 2) {
        double along[3];
        vec3_subtract(along, c->at + 3 * (size_t)end[1], c->at + 3 * (size_t)end[0]);
        vec3_normalise(along);
        vec3_add(side, 1.0, along);
    }
}

/* Relative difference of distances that are the same; weight of a corner that is 0. Where both are
 * below, a vertex is above a common side or corner, and the face of the lowest number touches it.
 */
static const double same = 1e-9;

/* The sum of the weights of the corners of a face that `other` does not have. */
static double weight_beyond(const struct contact *c, int face, int other, const double w[4]) {
    const int *own = c->face + 3 * face, *shared = c->face + 3 * other;
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        if (own[k] != shared[0] && own[k] != shared[1] && own[k] != shared[2])
            sum += fabs(w[1 + k]);
    return sum;
}

/* Whether another face of the flat part touches the vertex in place of the face of the pair. */
static bool yields_to(const struct contact *c, const struct pair *p, const struct hit *hit,
                      int other) {
    const int *corner = c->face + 3 * other, face = pair_second(p),
              point[4] = {p->point[0], corner[0], corner[1], corner[2]};
    const double *x[4];
    double w[4];
    pair_load(point, c->at, x);
    double distance = sqrt(pair_vertex_face.closest(x, w));
    if (distance > (1.0 + same) * hit->distance) return false;
    return distance < (1.0 - same) * hit->distance || other < face ||
           weight_beyond(c, other, face, w) > same;
}

/* The face that follows around a point: across the flat side of `face` at this point that does not
 * lead back. -1: there is none. */
static int next_around(const struct contact *c, int point, int face, int back) {
    for (int k = 0; k < 3; k++) {
        int across = c->flat.across[3 * face + k];
        if (c->face[3 * face + k] != point && across >= 0 && across != back) return across;
    }
    return -1;
}

/* The corner of the face that is the closest point of a hit; -1: none. */
static int closest_corner(const struct pair *p, const struct hit *hit) {
    for (int k = 1; k < 4; k++)
        if (fabs(hit->c[k]) > 1.0 - same) return p->point[k];
    return -1;
}

bool contact_is_beyond_flat_side(const struct contact *c, const struct pair *p,
                                 const struct hit *hit) {
    int face = pair_second(p);
    if (pair_kind_of(p->key) != &pair_vertex_face) return false;
    int corner = closest_corner(p, hit);
    for (int k = 0; k < 3; k++) {
        if (fabs(hit->c[1 + k]) > same) continue;
        for (int back = face, other = c->flat.across[3 * face + k]; other >= 0 && other != face;) {
            if (yields_to(c, p, hit, other)) return true;
            int next = corner < 0 ? -1 : next_around(c, corner, other, back);
            back = other, other = next;
        }
    }
    return false;
}
