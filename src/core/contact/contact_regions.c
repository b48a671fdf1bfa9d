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
    return c->live && is_particle(c, point) && !c->live[c->column[point]];
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
    c->broad.all_changed = !c->pairs.complete || count > c->points / MANY;
    c->broad.moved += count;
    for (int i = 0; i < c->points; i++) {
        c->broad.changed[i] |= c->broad.all_changed;
        if (c->broad.changed[i]) set_region(c, i, x, step);
    }
    return c->broad.all_changed || count > 0;
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

static void update_tree(struct bvh *tree, const struct box *box, const bool *changed, int count,
                        bool build, bool refit) {
    if (build) bvh_build(tree, box, count);
    if (refit) bvh_refit(tree, box, changed);
}

/* Builds the trees again when all points have new regions, or when as many regions as there are
 * points are new since the last build. Otherwise, and after a build for the second reason, a refit
 * marks the nodes with changed boxes, and the search leaves out pairs of unmarked nodes. A tree
 * that is only built counts as changed everywhere. */
static void update_trees(struct contact *c) {
    struct broad_phase *b = &c->broad;
    const struct box *point = b->point_box, *face = b->face_box, *edge = b->edge_box;
    const bool *points = b->changed, *faces = b->face_changed, *edges = b->edge_changed;
    int v = c->vertices, f = c->free_faces, e = c->free_edges;
    bool some = !b->all_changed, build = !some || b->moved > c->points;
    if (build) b->moved = 0;
    update_tree(&b->vertex_tree, point, points, v, build, some);
    update_tree(&b->other_tree, point + v, points + v, c->points - v, build, some);
    update_tree(&b->face_tree[0], face, faces, f, build, some);
    update_tree(&b->face_tree[1], face + f, faces + f, c->faces - f, build, some);
    update_tree(&b->edge_tree[0], edge, edges, e, build, some);
    update_tree(&b->edge_tree[1], edge + e, edges + e, c->edges - e, build, some);
}

/* Points that no triangle has, and flat parts of solids and rigid bodies, have no pairs. */
void contact_update_trees(struct contact *c) {
    struct broad_phase *b = &c->broad;
    for (int i = 0; i < c->points; i++) {
        bool pairs = c->group[i] >= 0 && !c->flat.point[i] && !box_is_empty(&b->region[i]);
        if (b->changed[i]) contact_wrap_regions(c, &i, pairs ? 1 : 0, &b->point_box[i]);
    }
    for (int f = 0; f < c->faces; f++) {
        b->face_changed[f] = contact_has_changed(c, c->face + 3 * f, 3);
        if (b->face_changed[f]) contact_wrap_regions(c, c->face + 3 * f, 3, &b->face_box[f]);
    }
    for (int e = 0; e < c->edges; e++) {
        const int *edge = c->edge + 2 * e;
        b->edge_changed[e] = contact_has_changed(c, edge, 2);
        if (b->edge_changed[e])
            contact_wrap_regions(c, edge, c->flat.edge[e] ? 0 : 2, &b->edge_box[e]);
    }
    update_trees(c);
}
