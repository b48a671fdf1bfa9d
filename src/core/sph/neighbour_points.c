/* The points of the neighbour lists: centres, samples near these, and boundary points by parts. */
#include "neighbour_lists.h"

#include "projdyn/box.h"

static bool is_active_centre(const struct neighbours *n, int i) {
    return n->volume[i] > 0.0 && n->centre[i];
}

static bool is_surface_point(const struct neighbours *n, int i) {
    return n->volume[i] > 0.0 && !n->centre[i];
}

void neighbour_points_clear(struct neighbours *n, int i) {
    n->lists.start[i] = n->lists.surface_start[i] = 0;
    n->lists.boundary_start[i] = n->lists.patch_start[i] = n->lists.end[i] = 0;
}

/* Not for NaN, which the search reports. */
static bool is_outside(const struct box *box, const double *x) {
    bool outside = false;
    for (int a = 0; a < 3; a++) outside |= x[a] < box->min[a] || x[a] > box->max[a];
    return outside;
}

/* The sample has no list; when it comes near within a step it has its rest volume. */
static void set_far(struct neighbours *n, int i) {
    if (n->far_volume) n->volume[i] = n->far_volume[i - n->system];
    neighbour_points_clear(n, i);
}

void neighbour_points_list(struct neighbours *n, const double *x) {
    struct box near = box_empty;
    n->active = 0;
    for (int i = 0; i < n->system; i++)
        if (is_active_centre(n, i)) n->id[n->active++] = i, box_add(&near, x + 3 * (size_t)i);
    n->centres = n->active;
    box_grow(&near, n->surface_reach + n->skin);
    for (int i = 0; i < n->view.particles; i++) {
        if (!is_surface_point(n, i)) continue;
        if (is_outside(&near, x + 3 * (size_t)i)) set_far(n, i);
        else n->id[n->active++] = i;
    }
}

static int part_of(const struct neighbours_def *def, int b) {
    bool moves = b >= def->boundary - def->moving;
    return def->is_wall[b] ? WALLS + moves : PATCHES + moves;
}

/* Lists the boundary points by parts. */
static void list_boundary(struct neighbours *n, const struct neighbours_def *def) {
    int count = 0;
    for (int part = 0; part < BOUNDARY_PARTS; part++) {
        n->part[part] = count;
        for (int b = 0; b < def->boundary; b++)
            if (part_of(def, b) == part) n->boundary_id[count++] = b;
    }
    n->part[BOUNDARY_PARTS] = count;
}

void neighbour_points_count(struct neighbours *n, const struct neighbours_def *def) {
    for (int i = 0; i < n->view.particles; i++)
        n->max_centres += is_active_centre(n, i), n->surface_points += is_surface_point(n, i);
    list_boundary(n, def);
}
