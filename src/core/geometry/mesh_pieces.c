/* The pieces of a closed mesh: sets of triangles that share edges. Inside is what an odd number of
 * pieces surrounds, as for `fill` (inside.c), so pieces at an even depth face outwards and pieces
 * at an odd depth, the hollows, face inwards:
 *
 *     [ depth 0: outwards  ( depth 1, a hollow: inwards  { depth 2: outwards } ) ]
 *
 * Before, the triangles of a piece that face another way than most of it are turned. */
#include "mesh.h"
#include "mesh_query.h"

#include "projdyn/vec3.h"

/* A piece of less volume than this part of its area^(3/2) is flat and has no inside. */
static const double flat = 1e-9;
/* Distance of a sample from the centre of its triangle, over the root of the triangle's area. */
static const double sample_depth = 1e-4;

struct pieces {
    struct mesh *mesh;
    int count;
    int *of;                   /* triangles: the piece of each */
    bool *other;               /* triangles: faces another way than the first one of its piece */
    int *stack;                /* triangles: scratch of the search */
    double *volume, *area;     /* count: m^3, negative where a piece faces inwards; m^2 */
    int *samples, *surrounded; /* count: of samples inside a piece, those inside an odd number of
                                  other pieces */
};

static bool resize_pieces(pdyn_context *context, struct pieces *p, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(p->volume, p->count),
        ARRAY(p->area, p->count),
        ARRAY(p->samples, p->count),
        ARRAY(p->surrounded, p->count),
    };
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

static void free_pieces(pdyn_context *context, struct pieces *p) {
    if (p->volume) resize_pieces(context, p, ARRAYS_FREE);
    FREE_ARRAY(context, p->of, p->mesh->triangles);
    FREE_ARRAY(context, p->other, p->mesh->triangles);
    FREE_ARRAY(context, p->stack, p->mesh->triangles);
}

/* Where the side opposite of a corner begins. */
static int side_start(const struct mesh *mesh, int corner) {
    return mesh->triangle[corner / 3 * 3 + (corner + 1) % 3];
}

/* Numbers the triangles of the piece of triangle `first`. Returns how many there are; *others: how
 * many of them face another way than `first`. */
static int number_piece(struct pieces *p, const struct topology *topology, int first, int *others) {
    int waiting = 0, count = 0;
    p->stack[waiting++] = first, p->of[first] = p->count;
    *others = 0;
    while (waiting) {
        int t = p->stack[--waiting];
        count++, *others += p->other[t];
        for (int corner = 3 * t; corner < 3 * t + 3; corner++) {
            int across = topology->across[corner];
            if (across < 0 || p->of[across / 3] >= 0) continue;
            p->of[across / 3] = p->count;
            bool opposed = side_start(p->mesh, corner) == side_start(p->mesh, across);
            p->other[across / 3] = p->other[t] != opposed;
            p->stack[waiting++] = across / 3;
        }
    }
    return count;
}

static void turn(struct mesh *mesh, int t) {
    int *corner = mesh->triangle + 3 * (size_t)t, second = corner[1];
    corner[1] = corner[2], corner[2] = second;
}

void mesh_turn(struct mesh *mesh) {
    for (int t = 0; t < mesh->triangles; t++) turn(mesh, t);
}

/* Numbers a piece and turns the smaller part of its triangles, so that all face the same way. */
static void orient_piece(struct pieces *p, const struct topology *topology, int first,
                         struct mesh_turned *turned) {
    int others, count = number_piece(p, topology, first, &others);
    bool most = 2 * others > count; /* face another way than `first` */
    turned->triangles += most ? count - others : others;
    for (int t = first; others && t < p->mesh->triangles; t++)
        if (p->of[t] == p->count && p->other[t] != most) turn(p->mesh, t);
}

static pdyn_status number_pieces(pdyn_context *context, struct pieces *p,
                                 struct mesh_turned *turned) {
    int triangles = p->mesh->triangles;
    struct topology topology;
    p->of = NEW_ARRAY(context, triangles, int);
    p->stack = NEW_ARRAY(context, triangles, int);
    p->other = NEW_ARRAY(context, triangles, bool);
    if (!p->of || !p->stack || !p->other) return PDYN_NO_MEMORY;
    pdyn_status status = topology_build(context, p->mesh, &topology);
    if (status != PDYN_OK) return status;
    for (int t = 0; t < triangles; t++) p->of[t] = -1;
    for (int t = 0; t < triangles; t++)
        if (p->of[t] < 0) orient_piece(p, &topology, t, turned), p->count++;
    topology_free(context, &topology);
    return PDYN_OK;
}

static void sum_volumes(struct pieces *p) {
    for (int t = 0; t < p->mesh->triangles; t++) {
        double n[3], from[3];
        const double *corner[3];
        mesh_corners(p->mesh, t, corner);
        vec3_normal(n, corner[0], corner[1], corner[2]);
        vec3_subtract(from, corner[0], p->mesh->vertex);
        p->volume[p->of[t]] += vec3_dot(from, n) / 6.0;
        p->area[p->of[t]] += 0.5 * vec3_length(n);
    }
    for (int k = 0; k < p->count; k++)
        if (fabs(p->volume[k]) <= flat * p->area[k] * sqrt(p->area[k])) p->volume[k] = 0.0;
}

/* Tests, for a point just inside of each triangle, which other pieces surround it. */
static void find_surrounded(struct pieces *p, const struct mesh_query *query) {
    for (int t = 0; t < p->mesh->triangles; t++) {
        double n[3], x[3] = {0};
        const double *corner[3];
        int own = p->of[t];
        mesh_corners(p->mesh, t, corner);
        vec3_normal(n, corner[0], corner[1], corner[2]);
        double inwards = p->volume[own] < 0.0 ? 1.0 : -1.0, size = vec3_length(n);
        if (size == 0.0) continue; /* no area, no inner side */
        for (int k = 0; k < 3; k++) vec3_add(x, 1.0 / 3.0, corner[k]);
        vec3_add(x, inwards * sample_depth / sqrt(2.0 * size), n);
        p->samples[own]++;
        p->surrounded[own] += mesh_query_contains_others(query, x, p->of, own);
    }
}

/* Does a piece face the wrong way? */
static bool faces_wrong(const struct pieces *p, int k) {
    bool hollow = p->surrounded[k] == p->samples[k];
    return hollow ? p->volume[k] > 0.0 : p->volume[k] < 0.0;
}

/* Turns the pieces that face the wrong way, unless all of them do. */
static void turn_pieces(const struct pieces *p, struct mesh_turned *turned) {
    int solid = 0, wrong = 0;
    for (int k = 0; k < p->count; k++) {
        solid += p->volume[k] != 0.0, wrong += faces_wrong(p, k);
        turned->crossing +=
            p->volume[k] != 0.0 && p->surrounded[k] > 0 && p->surrounded[k] < p->samples[k];
    }
    if (wrong == solid) return;
    turned->pieces = wrong;
    for (int t = 0; t < p->mesh->triangles; t++)
        if (faces_wrong(p, p->of[t])) turn(p->mesh, t);
}

pdyn_status mesh_orient_pieces(pdyn_context *context, struct mesh *mesh,
                               struct mesh_turned *turned) {
    struct pieces pieces = {.mesh = mesh};
    struct mesh_query query = {0};
    *turned = (struct mesh_turned){0};
    pdyn_status status = number_pieces(context, &pieces, turned);
    if (status == PDYN_OK && pieces.count > 1) {
        bool ready = resize_pieces(context, &pieces, ARRAYS_ALLOCATE);
        status = ready ? mesh_query_create(context, mesh, &query) : PDYN_NO_MEMORY;
    }
    if (status == PDYN_OK && pieces.count > 1) {
        sum_volumes(&pieces);
        find_surrounded(&pieces, &query);
        turn_pieces(&pieces, turned);
        mesh_query_free(context, &query);
    }
    free_pieces(context, &pieces);
    return status;
}
