/* Filling a closed mesh with particles. Lattice points are grouped in rows along x; a row is inside
 * after an odd number of crossings with the mesh.
 *
 *     triangle  --> toggles PASSED at the first point after each crossing of a row
 *               --> sets CLOSE at points nearer than the particle radius
 *
 * Whether an edge crosses a row depends on the two ends of the edge alone. Triangles that share the
 * edge therefore agree, and no row slips through between them. */
#include "sampling.h"

#include "projdyn/closest3.h"
#include "projdyn/vec3.h"

enum { PASSED = 1, CLOSE = 2 };

struct lattice {
    double origin[3], spacing;
    long n[3];
    unsigned char *mark; /* n[0] x n[1] x n[2] bits PASSED and CLOSE, x fastest */
};

/* Places the lattice in the middle of the bounding box of the mesh, all cells inside it. n = 0: the
 * box is too small for a cell. */
static pdyn_status create_lattice(pdyn_context *context, const struct mesh *mesh, double spacing,
                                  struct lattice *out) {
    double cuts[3];
    *out = (struct lattice){.spacing = spacing};
    for (int a = 0; a < 3; a++) {
        double min = HUGE_VAL, max = -HUGE_VAL;
        for (int i = 0; i < 3 * mesh->triangles; i++) {
            double x = mesh->vertex[3 * (size_t)mesh->triangle[i] + a];
            min = fmin(min, x), max = fmax(max, x);
        }
        cuts[a] = sample_cells(max - min, spacing);
        out->origin[a] = 0.5 * (min + max) - 0.5 * spacing * (cuts[a] - 1.0);
    }
    if (!(cuts[0] * cuts[1] * cuts[2] < POINT_LIST_MAX)) return point_list_too_many();
    if (!(cuts[0] * cuts[1] * cuts[2] > 0.0)) return PDYN_OK;
    for (int a = 0; a < 3; a++) out->n[a] = (long)cuts[a];
    out->mark = NEW_ARRAY(context, out->n[0] * out->n[1] * out->n[2], unsigned char);
    return out->mark ? PDYN_OK : PDYN_NO_MEMORY;
}

static double place(const struct lattice *l, int axis, long index) {
    return l->origin[axis] + l->spacing * (double)index;
}

/* The first index with a coordinate of at least x, from 0 to n. */
static long index_from(const struct lattice *l, int axis, double x) {
    double index = ceil((x - l->origin[axis]) / l->spacing);
    return (long)fmin(fmax(index, 0.0), (double)l->n[axis]);
}

static unsigned char *marks(const struct lattice *l, long j, long k) {
    return l->mark + (size_t)(l->n[0] * (j + l->n[1] * k));
}

/* ---- crossings of rows ----------------------------------------------------------------------- */

static void mark_layer(const struct lattice *l, const double *p, const double *q, long k) {
    const double *low = p[1] < q[1] ? p : q, *high = p[1] < q[1] ? q : p;
    long last = index_from(l, 1, high[1]);
    for (long j = index_from(l, 1, low[1]); j < last; j++) {
        double t = (place(l, 1, j) - low[1]) / (high[1] - low[1]);
        long i = index_from(l, 0, low[0] + t * (high[0] - low[0]));
        if (i < l->n[0]) marks(l, j, k)[i] ^= PASSED;
    }
}

static void mark_passed(const struct lattice *l, const double *const corner[3]) {
    long from[3];
    for (int c = 0; c < 3; c++) from[c] = index_from(l, 2, corner[c][2]);
    long first = l->n[2], last = 0;
    for (int c = 0; c < 3; c++) {
        if (from[c] < first) first = from[c];
        if (from[c] > last) last = from[c];
    }
    for (long k = first; k < last; k++) {
        double end[3][2];
        int ends = 0;
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3;
            if ((from[c] <= k) != (from[d] <= k))
                mesh_cut_edge(corner[c], corner[d], place(l, 2, k), end[ends++]);
        }
        mark_layer(l, end[0], end[1], k);
    }
}

/* ---- distance to the mesh -------------------------------------------------------------------- */

struct close { /* the points of a lattice closer to a triangle than a distance, m */
    const struct lattice *lattice;
    const double *const *corner;
    double distance, normal[3];
};

/* Shrinks [low, high], a part of row (j, k), to where the plane of the triangle is within the
 * distance. */
static void clip_row(const struct close *c, long j, long k, double *low, double *high) {
    const double *corner = c->corner[0], *normal = c->normal;
    double rest = normal[1] * (place(c->lattice, 1, j) - corner[1]) +
                  normal[2] * (place(c->lattice, 2, k) - corner[2]);
    double room = c->distance * vec3_length(normal);
    if (normal[0] != 0.0) {
        double middle = corner[0] - rest / normal[0], half = room / fabs(normal[0]);
        *low = fmax(*low, middle - half), *high = fmin(*high, middle + half);
    } else if (fabs(rest) > room) *high = -HUGE_VAL;
}

static void mark_row(const struct close *c, long j, long k, double low, double high) {
    const struct lattice *l = c->lattice;
    clip_row(c, j, k, &low, &high);
    long end = index_from(l, 0, high);
    for (long i = index_from(l, 0, low); i < end; i++) {
        const double x[3] = {place(l, 0, i), place(l, 1, j), place(l, 2, k)};
        double unused[3], squared = closest3_triangle(x, c->corner, unused);
        if (squared < c->distance * c->distance) marks(l, j, k)[i] |= CLOSE;
    }
}

static void mark_close(const struct lattice *l, const double *const corner[3], double distance) {
    struct close c = {.lattice = l, .corner = corner, .distance = distance};
    double u[3], v[3], low[3], high[3];
    long first[3], last[3];
    for (int a = 0; a < 3; a++) {
        u[a] = corner[1][a] - corner[0][a], v[a] = corner[2][a] - corner[0][a];
        low[a] = fmin(corner[0][a], fmin(corner[1][a], corner[2][a])) - distance;
        high[a] = fmax(corner[0][a], fmax(corner[1][a], corner[2][a])) + distance;
        first[a] = index_from(l, a, low[a]), last[a] = index_from(l, a, high[a]);
    }
    vec3_cross(c.normal, u, v);
    /* rounding makes the plane of a needle triangle meaningless */
    if (vec3_length(c.normal) < 1e-9 * vec3_length(u) * vec3_length(v))
        for (int a = 0; a < 3; a++) c.normal[a] = 0.0;
    for (long k = first[2]; k < last[2]; k++)
        for (long j = first[1]; j < last[1]; j++) mark_row(&c, j, k, low[0], high[0]);
}

/* ---- the volume ------------------------------------------------------------------------------ */

static pdyn_status add_inside(pdyn_context *context, const struct lattice *l,
                              struct point_list *out) {
    for (long k = 0; k < l->n[2]; k++)
        for (long j = 0; j < l->n[1]; j++) {
            const unsigned char *mark = marks(l, j, k);
            bool inside = false;
            for (long i = 0; i < l->n[0]; i++) {
                inside ^= mark[i] & PASSED;
                if (!inside || mark[i] & CLOSE) continue;
                double x[3] = {place(l, 0, i), place(l, 1, j), place(l, 2, k)};
                pdyn_status status = point_list_add(context, out, x);
                if (status != PDYN_OK) return status;
            }
        }
    return PDYN_OK;
}

pdyn_status sample_mesh_volume(pdyn_context *context, const struct mesh *mesh, double radius,
                               struct point_list *out) {
    struct lattice lattice;
    pdyn_status status = create_lattice(context, mesh, 2.0 * radius, &lattice);
    if (status != PDYN_OK) return status;
    for (int t = 0; lattice.mark && t < mesh->triangles; t++) {
        const double *corner[3];
        mesh_corners(mesh, t, corner);
        mark_passed(&lattice, corner);
        mark_close(&lattice, corner,
                   radius * (1.0 - 1e-6)); /* the tolerance keeps particles that touch the mesh */
    }
    status = add_inside(context, &lattice, out);
    FREE_ARRAY(context, lattice.mark, lattice.n[0] * lattice.n[1] * lattice.n[2]);
    return status;
}
