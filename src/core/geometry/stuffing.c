/* Isosurface stuffing (Labelle and Shewchuk 2007): tetrahedra of a body-centred cubic lattice,
 * fitted to a closed mesh. Lattice points are addressed by half cells; nodes are the points whose
 * indices are all even (corners of cells) or all odd (centres).
 *
 *     sign of each node (1 inside, -1 outside)
 *     --> nodes close to the mesh are moved onto it (sign 0)
 *     --> each tetrahedron of the lattice is cut where its edges cross the mesh
 *     --> nodes return to their place where parts of the result touch along an edge
 */
#include "mesh_query.h"
#include "tets.h"

#include <stdlib.h>
#include <string.h>

enum { STEPS = 12 }; /* of a bisection: the place of a cut is known to 2^-12 of its edge */

/* A node is moved onto the mesh if one of its edges is cut closer than this share of the edge: the
 * values with which Labelle and Shewchuk bound dihedral angles by 10.7 and 164.8 degrees on smooth
 * surfaces, with diagonals chosen in another way than here. */
static const double move_along_axis = 0.24999, move_diagonally = 0.41189;

/* Cuts are no closer to nodes, so that every tetrahedron has a volume. It matters for nodes that
 * returned to their place: others have no closer cuts along an axis. */
static const double min_share = 0.25;

/* The edges of a node, in half cells: the first seven lead to nodes with a higher index. */
enum { EDGES = 14, UPWARD = 7 };
static const signed char edge[EDGES][3] = {
    {2, 0, 0},  {0, 2, 0},  {0, 0, 2},  {1, 1, 1},    {-1, 1, 1},  {1, -1, 1},  {-1, -1, 1},
    {-2, 0, 0}, {0, -2, 0}, {0, 0, -2}, {-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}};

struct stuffing {
    const struct mesh_query *inside;
    double origin[3], half; /* m */
    long n[3], points;      /* of the lattice of half cells */
    signed char *sign;      /* points; of no meaning where no node is */
    signed char *moved;     /* points: the edge along which a node is moved; -1: it is not */
    int restored;           /* nodes that have moved back */
    size_t count, capacity; /* of tetrahedra */
    int64_t *corner;        /* count x 4: see key_of_cut */
    int64_t *key;           /* of the vertices, ascending */
};

/* ---- the lattice ----------------------------------------------------------------------------- */

static void indices(const struct stuffing *s, long node, long at[3]) {
    at[0] = node % s->n[0], at[1] = node / s->n[0] % s->n[1], at[2] = node / (s->n[0] * s->n[1]);
}

static long neighbour(const struct stuffing *s, long node, const signed char by[3]) {
    return node + by[0] + s->n[0] * (by[1] + s->n[1] * by[2]);
}

static void lattice_point(const struct stuffing *s, long node, double x[3]) {
    long at[3];
    indices(s, node, at);
    for (int a = 0; a < 3; a++) x[a] = s->origin[a] + s->half * (double)at[a];
}

/* Covers the mesh, with a cell of air on every side. */
static pdyn_status create_lattice(pdyn_context *context, double cell, struct stuffing *s) {
    const struct box *bounds = &s->inside->bounds;
    double points = 1.0;
    s->half = 0.5 * cell;
    for (int a = 0; a < 3; a++) {
        double cuts = ceil((bounds->max[a] - bounds->min[a]) / cell * (1.0 - 1e-9)) + 2.0;
        points *= 2.0 * cuts + 1.0;
        s->origin[a] = 0.5 * (bounds->min[a] + bounds->max[a] - cuts * cell);
        if (points < TETS_MAX_POINTS) s->n[a] = 2 * (long)cuts + 1;
    }
    if (!(points < TETS_MAX_POINTS))
        return set_error(PDYN_BAD_INPUT,
                         "cells of %.10g m are too small: expected at most %d lattice points, "
                         "found %.10g",
                         cell, TETS_MAX_POINTS, points);
    s->points = s->n[0] * s->n[1] * s->n[2];
    s->sign = NEW_ARRAY(context, s->points, signed char);
    s->moved = NEW_ARRAY(context, s->points, signed char);
    return s->sign && s->moved ? PDYN_OK : PDYN_NO_MEMORY;
}

/* Whether the point is a node with all its edges within the lattice. */
static bool is_inner_node(const struct stuffing *s, long point) {
    long at[3];
    bool inner = true;
    indices(s, point, at);
    for (int a = 0; a < 3; a++)
        inner &= at[a] >= 2 && at[a] < s->n[a] - 2 && (at[a] ^ at[0]) % 2 == 0;
    return inner;
}

static void find_signs(struct stuffing *s) {
    for (long i = 0; i < s->points; i++) {
        double x[3];
        lattice_point(s, i, x);
        s->sign[i] = is_inner_node(s, i) && mesh_query_contains(s->inside, x) ? 1 : -1;
        s->moved[i] = -1;
    }
}

/* ---- cuts ------------------------------------------------------------------------------------ */

static void point_on_edge(const struct stuffing *s, long node, int e, double share, double x[3]) {
    lattice_point(s, node, x);
    for (int k = 0; k < 3; k++) x[k] += share * s->half * edge[e][k];
}

/* Where the edge e of a node, whose ends lie on different sides, crosses the mesh: the share of the
 * edge before it, by bisection. */
static double find_cut(const struct stuffing *s, long node, int e) {
    double x[3], low = 0.0, high = 1.0;
    lattice_point(s, node, x);
    bool inside = mesh_query_contains(s->inside, x);
    for (int k = 0; k < STEPS; k++) {
        double middle = 0.5 * (low + high);
        point_on_edge(s, node, e, middle, x);
        if (mesh_query_contains(s->inside, x) == inside) low = middle;
        else high = middle;
    }
    return 0.5 * (low + high);
}

/* Moves nodes onto the mesh, in the order of their indices: a node that is on it ends the cuts of
 * its edges. */
static void move_nodes(struct stuffing *s) {
    for (long i = 0; i < s->points; i++) {
        double nearest = HUGE_VAL;
        if (!is_inner_node(s, i)) continue;
        for (int e = 0; e < EDGES; e++) {
            bool axis = e % UPWARD < 3;
            if (s->sign[i] * s->sign[neighbour(s, i, edge[e])] >= 0) continue;
            double share = find_cut(s, i, e), length = axis ? 2.0 : sqrt(3.0);
            if (share > (axis ? move_along_axis : move_diagonally)) continue;
            if (share * length < nearest) nearest = share * length, s->moved[i] = (signed char)e;
        }
        if (s->moved[i] >= 0) s->sign[i] = 0;
    }
}

/* Vertices are named by keys: a node by its index; the cut of its edge e < UPWARD by index + points
 * (1 + e). */
static int64_t key_of_cut(const struct stuffing *s, long from, long to) {
    long low = from < to ? from : to, high = from < to ? to : from;
    int e = 0;
    while (neighbour(s, low, edge[e]) != high) e++;
    return low + s->points * (1 + (int64_t)e);
}

static void position_of(const struct stuffing *s, int64_t key, double x[3]) {
    long node = (long)(key % s->points);
    bool is_node = key < s->points;
    int e = is_node ? s->moved[node] : (int)(key / s->points) - 1;
    if (e < 0) {
        lattice_point(s, node, x);
        return;
    }
    double share = find_cut(s, node, e);
    if (!is_node) share = fmin(fmax(share, min_share), 1.0 - min_share);
    point_on_edge(s, node, e, share, x);
}

/* ---- tetrahedra ------------------------------------------------------------------------------ */

static void add_tet(struct stuffing *s, int64_t a, int64_t b, int64_t c, int64_t d) {
    const int64_t corner[4] = {a, b, c, d};
    if (s->count < s->capacity) memcpy(s->corner + 4 * s->count, corner, sizeof corner);
    s->count++;
}

/* The diagonal of a quadrilateral starts at its smallest key, so that the tetrahedra on both sides
 * of it agree. */
static void add_pyramid(struct stuffing *s, int64_t tip, const int64_t q[4]) {
    int first = 0;
    for (int k = 1; k < 4; k++)
        if (q[k] < q[first]) first = k;
    for (int k = 1; k < 3; k++)
        add_tet(s, tip, q[first], q[(first + k) % 4], q[(first + k + 1) % 4]);
}

/* v: two triangles; v[k] and v[k + 3] are joined. The smallest key becomes the first (Dompierre et
 * al. 1999). */
static void add_prism(struct stuffing *s, const int64_t v[6]) {
    int64_t p[6];
    int first = 0;
    for (int k = 1; k < 6; k++)
        if (v[k] < v[first]) first = k;
    for (int k = 0; k < 3; k++) {
        int turned = (first + k) % 3, near = first < 3 ? 0 : 3;
        p[k] = v[turned + near], p[k + 3] = v[turned + 3 - near];
    }
    add_tet(s, p[0], p[3], p[4], p[5]);
    add_pyramid(s, p[0], (int64_t[]){p[1], p[2], p[5], p[4]});
}

/* Adds the part of a tetrahedron that is inside. */
static void add_inside(struct stuffing *s, const long node[4]) {
    int64_t k[4], cut[4][4];
    long v[4];
    int count = 0, inside = 0, outside = 0;
    for (int sign = 1; sign >= -1; sign--)
        for (int c = 0; c < 4; c++)
            if (s->sign[node[c]] == sign) v[count++] = node[c];
    for (int c = 0; c < 4; c++) {
        k[c] = v[c];
        inside += s->sign[v[c]] > 0, outside += s->sign[v[c]] < 0;
        for (int d = 0; d < 4; d++)
            cut[c][d] = s->sign[v[c]] * s->sign[v[d]] < 0 ? key_of_cut(s, v[c], v[d]) : v[d];
    }
    if (!inside) return;
    if (!outside) add_tet(s, k[0], k[1], k[2], k[3]);
    else if (inside == 1) add_tet(s, k[0], cut[0][1], cut[0][2], cut[0][3]);
    else if (inside + outside == 3)
        add_pyramid(s, k[2], (int64_t[]){k[0], k[1], cut[1][3], cut[0][3]});
    else if (inside == 2)
        add_prism(s, (int64_t[]){k[0], cut[0][2], cut[0][3], k[1], cut[1][2], cut[1][3]});
    else add_prism(s, (int64_t[]){k[0], k[1], k[2], cut[0][3], cut[1][3], cut[2][3]});
}

/* The tetrahedra of the lattice: the edge between the centres of two cells and each of the four
 * edges of the face between these cells. */
static void add_all(struct stuffing *s) {
    static const signed char ring[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (long i = 0; i < s->points; i++) {
        long at[3];
        indices(s, i, at);
        if (at[0] % 2 == 0 || at[1] % 2 == 0 || at[2] % 2 == 0) continue;
        for (int a = 0; a < 3; a++) {
            long round[4];
            if (at[a] + 2 >= s->n[a]) continue;
            for (int r = 0; r < 4; r++) {
                signed char by[3];
                by[a] = 1, by[(a + 1) % 3] = ring[r][0], by[(a + 2) % 3] = ring[r][1];
                round[r] = neighbour(s, i, by);
            }
            for (int r = 0; r < 4; r++)
                add_inside(s, (long[]){i, neighbour(s, i, edge[a]), round[r], round[(r + 1) % 4]});
        }
    }
}

/* ---- numbering ------------------------------------------------------------------------------- */

static int compare_keys(const void *a, const void *b) {
    int64_t p = *(const int64_t *)a, q = *(const int64_t *)b;
    return (p > q) - (p < q);
}

/* Numbers the vertices in the order of their keys, which it leaves in s->key. Positions are left to
 * place_vertices. */
static pdyn_status number_vertices(pdyn_context *context, struct stuffing *s, struct mesh *mesh,
                                   struct tets *tets) {
    size_t corners = 4 * s->count, vertices = 0;
    tets->count = (int)s->count;
    tets->corner = NEW_ARRAY(context, corners, int);
    if (!tets->corner) return PDYN_NO_MEMORY;
    memcpy(s->key, s->corner, corners * sizeof *s->key);
    qsort(s->key, corners, sizeof *s->key, compare_keys);
    for (size_t k = 0; k < corners; k++)
        if (!vertices || s->key[k] != s->key[vertices - 1]) s->key[vertices++] = s->key[k];
    for (size_t k = 0; k < corners; k++) {
        const int64_t *found =
            bsearch(&s->corner[k], s->key, vertices, sizeof *s->key, compare_keys);
        tets->corner[k] = (int)(found - s->key);
    }
    return mesh_allocate(context, (int)vertices, 0, mesh);
}

static void place_vertices(const struct stuffing *s, struct mesh *mesh) {
    for (int i = 0; i < mesh->vertices; i++)
        position_of(s, s->key[i], mesh->vertex + 3 * (size_t)i);
}

/* ---- edges where parts touch ----------------------------------------------------------------- */

/* Moves the node of a vertex back to its place, if it was moved. */
static void restore_node(void *user, int vertex) {
    struct stuffing *s = user;
    int64_t key = s->key[vertex];
    double x[3];
    if (key >= s->points || s->moved[key] < 0) return;
    lattice_point(s, (long)key, x);
    s->sign[key] = mesh_query_contains(s->inside, x) ? 1 : -1;
    s->moved[key] = -1;
    s->restored++;
}

/* Restores the nodes on outer edges of more than two faces. */
static pdyn_status separate_parts(pdyn_context *context, struct stuffing *s, struct mesh *mesh,
                                  const struct tets *tets) {
    pdyn_status status = tets_find_surface(context, "filled", mesh, tets);
    if (status == PDYN_OK) status = mesh_visit_crowded_edges(context, mesh, restore_node, s);
    FREE_ARRAY(context, mesh->triangle, 3 * (size_t)mesh->triangles);
    mesh->triangles = 0;
    return status;
}

static void free_list(pdyn_context *context, struct stuffing *s) {
    FREE_ARRAY(context, s->corner, 4 * s->capacity);
    FREE_ARRAY(context, s->key, 4 * s->capacity);
    s->count = s->capacity = 0;
}

/* Lists the tetrahedra. */
static pdyn_status list_tets(pdyn_context *context, struct stuffing *s, double cell) {
    free_list(context, s);
    add_all(s); /* counts */
    if (!s->count)
        return set_error(PDYN_BAD_INPUT,
                         "cells of %.10g m are too large: none of their corners is inside", cell);
    s->capacity = s->count, s->count = 0;
    s->corner = NEW_ARRAY(context, 4 * s->capacity, int64_t);
    s->key = NEW_ARRAY(context, 4 * s->capacity, int64_t);
    if (!s->corner || !s->key) return PDYN_NO_MEMORY;
    add_all(s);
    return PDYN_OK;
}

static pdyn_status stuff(pdyn_context *context, struct stuffing *s, double cell, struct mesh *mesh,
                         struct tets *tets) {
    pdyn_status status = create_lattice(context, cell, s);
    if (status != PDYN_OK) return status;
    find_signs(s);
    move_nodes(s);
    do { /* without nodes on the mesh, no outer edge has more than two faces */
        mesh_free(context, mesh);
        tets_free(context, tets);
        s->restored = 0;
        status = list_tets(context, s, cell);
        if (status == PDYN_OK) status = number_vertices(context, s, mesh, tets);
        if (status == PDYN_OK) status = separate_parts(context, s, mesh, tets);
    } while (status == PDYN_OK && s->restored);
    if (status == PDYN_OK) place_vertices(s, mesh);
    return status;
}

pdyn_status tets_fill(pdyn_context *context, const struct mesh *surface, double cell,
                      struct mesh *mesh, struct tets *tets) {
    struct mesh_query inside;
    struct stuffing s = {.inside = &inside};
    *mesh = (struct mesh){0}, *tets = (struct tets){0};
    pdyn_status status = mesh_query_create(context, surface, &inside);
    if (status != PDYN_OK) return status;
    status = stuff(context, &s, cell, mesh, tets);
    free_list(context, &s);
    FREE_ARRAY(context, s.sign, s.points);
    FREE_ARRAY(context, s.moved, s.points);
    mesh_query_free(context, &inside);
    return status;
}
