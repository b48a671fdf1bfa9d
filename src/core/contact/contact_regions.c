/* Regions of the broad phase: each point has one, a box around it and its displacement. A point
 * that leaves its region gets a new one. Faces and edges have boxes around the regions of their
 * points, and trees of these boxes. */
#include "contact_parts.h"

#include "projdyn/vec3.h"

#include <string.h>

/* All points get new regions where more than one of so many has left its own. */
enum { MANY = 4 };

/* Margin of a region around a point and its displacement, in thicknesses. */
static const double margin_size = 0.5;

/* ---- regions --------------------------------------------------------------------------------- */

/* Whether the point is a particle that does not exist: not yet emitted, or removed. */
static bool is_absent(const struct contact *c, int point) {
    return c->live && point >= c->vertices && point < c->free && !c->live[c->column[point]];
}

/* Whether the region of point i contains it and its displacement; that of an absent one is empty.
 */
static bool region_contains(const struct contact *c, int i, const double *x, const double *step) {
    const struct box *box = &c->broad.region[i];
    if (is_absent(c, i)) return box_is_empty(box);
    for (int a = 3 * i; a < 3 * i + 3; a++) {
        double y = x[a] + (step ? step[a] : 0.0);
        if (x[a] < box->min[a - 3 * i] || x[a] > box->max[a - 3 * i]) return false;
        if (y < box->min[a - 3 * i] || y > box->max[a - 3 * i]) return false;
    }
    return true;
}

static void set_region(struct contact *c, int i, const double *x, const double *step) {
    double end[3] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]}, far = 0.0;
    if (step) vec3_add(end, 1.0, step + 3 * i);
    double moved = vec3_distance(end, x + 3 * i);
    double margin = i < c->free || moved > 0.0 ? margin_size * c->settings->thickness : 0.0;
    c->broad.region[i] = box_empty;
    memcpy(c->broad.built + 3 * i, x + 3 * i, 3 * sizeof *x);
    c->broad.reach[i] = 0.0;
    if (is_absent(c, i)) return;
    box_add(&c->broad.region[i], x + 3 * i);
    box_add(&c->broad.region[i], end);
    box_grow(&c->broad.region[i], margin);
    for (int a = 0; a < 3; a++) {
        double side = margin + fabs(end[a] - x[3 * i + a]);
        far += side * side;
    }
    c->broad.reach[i] = sqrt(far);
}

bool contact_update_regions(struct contact *c, const double *x, const double *step) {
    int count = 0;
    for (int i = 0; i < c->points; i++)
        count += c->broad.changed[i] = !region_contains(c, i, x, step);
    c->broad.all_changed = count > c->points / MANY;
    for (int i = 0; i < c->points; i++) {
        c->broad.changed[i] |= c->broad.all_changed;
        if (c->broad.changed[i]) set_region(c, i, x, step);
    }
    return count > 0;
}

/* ---- trees ----------------------------------------------------------------------------------- */

bool contact_has_changed(const struct contact *c, const int *point, int points) {
    bool changed = false;
    for (int k = 0; k < points; k++) changed |= c->broad.changed[point[k]];
    return changed;
}

void contact_wrap_regions(const struct contact *c, const int *point, int points, struct box *box) {
    *box = box_empty;
    for (int k = 0; k < points; k++) {
        box_add(box, c->broad.region[point[k]].min);
        box_add(box, c->broad.region[point[k]].max);
    }
    box_grow(box, 0.5 * c->settings->thickness);
}

/* Builds the trees of surfaces (kind 0) or solids (kind 1): of all faces, of all edges, and of the
 * faces and edges that have changed. A point or edge that has not changed has new pairs only with
 * something that has: its search takes the trees of changed ones. */
static void build_trees(struct contact *c, int kind) {
    int f = kind ? c->free_faces : 0, faces = kind ? c->faces - f : c->free_faces;
    int e = kind ? c->free_edges : 0, edges = kind ? c->edges - e : c->free_edges;
    bvh_build(&c->broad.face_tree[kind], c->broad.face_box + f, faces, NULL);
    bvh_build(&c->broad.edge_tree[kind], c->broad.edge_box + e, edges, NULL);
    if (c->broad.all_changed) return;
    bvh_build(&c->broad.changed_faces[kind], c->broad.face_box + f, faces,
              c->broad.face_changed + f);
    bvh_build(&c->broad.changed_edges[kind], c->broad.edge_box + e, edges,
              c->broad.edge_changed + e);
}

void contact_update_trees(struct contact *c) {
    for (int f = 0; f < c->faces; f++) {
        c->broad.face_changed[f] = contact_has_changed(c, c->face + 3 * f, 3);
        if (c->broad.face_changed[f])
            contact_wrap_regions(c, c->face + 3 * f, 3, &c->broad.face_box[f]);
    }
    for (int e = 0; e < c->edges; e++) {
        c->broad.edge_changed[e] = contact_has_changed(c, c->edge + 2 * e, 2);
        if (c->broad.edge_changed[e])
            contact_wrap_regions(c, c->edge + 2 * e, 2, &c->broad.edge_box[e]);
    }
    for (int kind = 0; kind < 2; kind++) build_trees(c, kind);
}
