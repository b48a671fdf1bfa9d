/* Tetrahedral meshes: blocks, volumes, and the surface. */
#include "tets.h"

#include "projdyn/vec3.h"

#include <stdlib.h>
#include <string.h>

/* ---- block ----------------------------------------------------------------------------------- */

/* The six tetrahedra of a cell: each is a path from the lowest to the highest corner along the axes
 * in one order. Bit a of a corner: it is at the upper end of axis a. Every second cell along an
 * axis is mirrored there, so that the block has no direction that its diagonals prefer. */
static const int kuhn[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                               {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

static void fill_grid(const double size[3], const int cells[3], struct mesh *mesh,
                      struct tets *tets) {
    int n[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1}, *corner = tets->corner;
    for (int i = 0; i < mesh->vertices; i++) {
        int at[3] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
        for (int a = 0; a < 3; a++)
            mesh->vertex[3 * i + a] = size[a] * (1.0 * at[a] / cells[a] - 0.5);
        int mirrored = (at[0] & 1) + 2 * (at[1] & 1) + 4 * (at[2] & 1);
        for (int k = 0; k < 24 && at[0] < cells[0] && at[1] < cells[1] && at[2] < cells[2]; k++) {
            int c = kuhn[k / 4][k % 4] ^ mirrored;
            *corner++ = i + (c & 1) + n[0] * (c >> 1 & 1) + n[0] * n[1] * (c >> 2);
        }
    }
}

pdyn_status tets_grid(pdyn_context *context, const double size[3], const int cells[3],
                      struct mesh *mesh, struct tets *tets) {
    *tets = (struct tets){.count = 6 * cells[0] * cells[1] * cells[2]};
    pdyn_status status =
        mesh_allocate(context, (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1), 0, mesh);
    if (status != PDYN_OK) return status;
    tets->corner = NEW_ARRAY(context, 4 * (size_t)tets->count, int);
    if (!tets->corner) return PDYN_NO_MEMORY;
    fill_grid(size, cells, mesh, tets);
    return PDYN_OK;
}

/* ---- checks and volumes ---------------------------------------------------------------------- */

/* Computes the volumes; swaps two vertices of a tetrahedron that is inverted. */
static pdyn_status compute_volumes(pdyn_context *context, const char *name, const struct mesh *mesh,
                                   struct tets *tets) {
    tets->volume = NEW_ARRAY(context, tets->count, double);
    if (!tets->volume) return PDYN_NO_MEMORY;
    for (int t = 0; t < tets->count; t++) {
        int *c = tets->corner + 4 * (size_t)t;
        double side[3][3], normal[3], longest = 0.0;
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++)
                side[k][a] = mesh->vertex[3 * c[k + 1] + a] - mesh->vertex[3 * c[0] + a];
            longest = fmax(longest, vec3_length(side[k]));
        }
        vec3_cross(normal, side[0], side[1]);
        double volume = vec3_dot(normal, side[2]) / 6.0;
        if (!(fabs(volume) > 1e-9 * longest * longest * longest))
            return set_error(PDYN_BAD_INPUT,
                             "%.1024s: tetrahedron %d (vertices %d, %d, %d, %d) has no volume",
                             name, t, c[0], c[1], c[2], c[3]);
        if (volume < 0.0) {
            int last = c[3];
            c[3] = c[2], c[2] = last;
        }
        tets->volume[t] = fabs(volume);
    }
    return PDYN_OK;
}

/* ---- the surface ----------------------------------------------------------------------------- */

struct face {
    int key[3];    /* vertices, ascending */
    int corner[3]; /* vertices, counter-clockwise as seen from outside */
};

static int compare_faces(const void *a, const void *b) {
    return memcmp(((const struct face *)a)->key, ((const struct face *)b)->key, sizeof(int[3]));
}

static int compare_ints(const void *a, const void *b) { return *(const int *)a - *(const int *)b; }

static struct face *sorted_faces(pdyn_context *context, const struct tets *tets) {
    static const int outward[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    size_t count = 4 * (size_t)tets->count;
    struct face *face = NEW_ARRAY(context, count, struct face);
    if (!face) return NULL;
    for (size_t f = 0; f < count; f++) {
        for (int k = 0; k < 3; k++)
            face[f].key[k] = face[f].corner[k] = tets->corner[f / 4 * 4 + outward[f % 4][k]];
        qsort(face[f].key, 3, sizeof(int), compare_ints);
    }
    qsort(face, count, sizeof *face, compare_faces);
    return face;
}

/* Moves the faces that belong to a single tetrahedron to the front; returns their number, -1 with
 * an error set. */
static int keep_outer(const char *name, struct face *face, size_t count) {
    int kept = 0;
    for (size_t f = 0, next; f < count; f = next) {
        for (next = f + 1; next < count && !compare_faces(&face[f], &face[next]);) next++;
        if (next - f > 2) {
            set_error(PDYN_BAD_INPUT, "%.1024s: the face of vertices %d, %d, %d has %zu tetrahedra",
                      name, face[f].key[0], face[f].key[1], face[f].key[2], next - f);
            return -1;
        }
        if (next - f == 1) face[kept++] = face[f];
    }
    return kept;
}

pdyn_status tets_find_surface(pdyn_context *context, const char *name, struct mesh *mesh,
                              const struct tets *tets) {
    size_t count = 4 * (size_t)tets->count;
    struct face *face = sorted_faces(context, tets);
    if (!face) return PDYN_NO_MEMORY;
    int kept = keep_outer(name, face, count);
    if (kept > 0) mesh->triangle = NEW_ARRAY(context, 3 * (size_t)kept, int);
    if (mesh->triangle) mesh->triangles = kept;
    for (int t = 0; t < mesh->triangles; t++)
        memcpy(mesh->triangle + 3 * t, face[t].corner, sizeof face->corner);
    FREE_ARRAY(context, face, count);
    if (kept < 0) return PDYN_BAD_INPUT;
    return mesh->triangle ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status tets_finish(pdyn_context *context, const char *name, struct mesh *mesh,
                        struct tets *tets) {
    pdyn_status status = mesh_check_used(context, name, mesh->vertices, tets->corner,
                                         4 * tets->count, "tetrahedron");
    if (status == PDYN_OK) status = compute_volumes(context, name, mesh, tets);
    if (status == PDYN_OK) status = tets_find_surface(context, name, mesh, tets);
    return status == PDYN_OK ? mesh_check_edges(context, mesh, name) : status;
}

/* ---- pieces ---------------------------------------------------------------------------------- */

/* Labels each vertex with the smallest index of its piece. */
static void label_pieces(const struct mesh *mesh, const struct tets *tets, int *label) {
    for (int i = 0; i < mesh->vertices; i++) label[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (int t = 0; t < tets->count; t++) {
            const int *c = tets->corner + 4 * (size_t)t;
            int lowest = label[c[0]];
            for (int k = 1; k < 4; k++)
                if (label[c[k]] < lowest) lowest = label[c[k]];
            for (int k = 0; k < 4; k++) {
                changed |= label[c[k]] != lowest;
                label[c[k]] = lowest;
            }
        }
    }
}

pdyn_status tets_count_small(pdyn_context *context, const struct mesh *mesh,
                             const struct tets *tets, double volume, int *count) {
    int *label = NEW_ARRAY(context, mesh->vertices, int);
    double *sum = NEW_ARRAY(context, mesh->vertices, double), largest = 0.0;
    *count = 0;
    if (label && sum) {
        label_pieces(mesh, tets, label);
        for (int t = 0; t < tets->count; t++) sum[label[tets->corner[4 * t]]] += tets->volume[t];
        for (int i = 0; i < mesh->vertices; i++) {
            largest = fmax(largest, sum[i]);
            *count += sum[i] > 0.0 && sum[i] < volume;
        }
        *count -= largest < volume;
    }
    pdyn_status status = label && sum ? PDYN_OK : PDYN_NO_MEMORY;
    FREE_ARRAY(context, label, mesh->vertices);
    FREE_ARRAY(context, sum, mesh->vertices);
    return status;
}

void tets_free(pdyn_context *context, struct tets *tets) {
    FREE_ARRAY(context, tets->corner, 4 * (size_t)tets->count);
    FREE_ARRAY(context, tets->volume, tets->count);
    *tets = (struct tets){0};
}
